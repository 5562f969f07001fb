"""Whether a stack is known to stand still where the engine takes that for granted, and if not, why.

The engine skins by itself where one Armature alone poses a body that is the same on every frame. Whatever is not known
to be so is read as Blender evaluates it, which is exact for any stack: this file errs on that side.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import bpy

from ..messages import Message, message
from . import modifier_inputs, node_group, stack

# Of modifiers that make the same of the same mesh as long as their settings stay.
STEADY_TYPES = stack.STILL_TYPES | frozenset(
    "ARRAY BEVEL CAST DECIMATE DISPLACE EDGE_SPLIT LAPLACIANSMOOTH MASK MIRROR MULTIRES NODES REMESH SCREW"
    " SIMPLE_DEFORM SKIN SMOOTH SOLIDIFY SUBSURF TRIANGULATE WELD WIREFRAME".split()
)
# Of an object that one of these names only its place counts.
_PLACES = frozenset(
    {
        ("ARRAY", "offset_object"),
        ("CAST", "object"),
        ("DISPLACE", "texture_coords_object"),
        ("MIRROR", "mirror_object"),
        ("SCREW", "object"),
        ("SIMPLE_DEFORM", "origin"),
        ("VERTEX_WEIGHT_EDIT", "mask_tex_map_object"),
        ("VERTEX_WEIGHT_MIX", "mask_tex_map_object"),
    }
)
# Nodes that see more than the mesh, by parts of their types.
_MOVING_NODES = ("SceneTime", "Simulation", "XPBD", "Bake", "Sound", "ViewportTransform", "MousePosition", "SelfObject")
_MOVING_SOCKETS = frozenset({"OBJECT", "COLLECTION", "IMAGE"})
_KEY_PATHS = (".value", ".mute", ".slider_min", ".slider_max", "eval_time")
_FRAME_EVENTS = ("frame_change_pre", "frame_change_post", "depsgraph_update_pre")
_PACKAGE = __package__.rpartition(".")[0]


class Lane(NamedTuple):
    """Why the stack is read as Blender evaluates it; nothing in either: the engine skins by itself."""

    poses: tuple[Message, ...]  # the body is posed by more than one Armature right before ours
    moves: tuple[Message, ...]  # the body itself is not known to be the same on every frame

    @property
    def is_evaluated(self) -> bool:
        return bool(self.poses or self.moves)

    @property
    def reasons(self) -> tuple[Message, ...]:
        """All of them."""
        return (*self.poses, *self.moves)


def lane_of(ob: bpy.types.Object) -> Lane:
    """How the stack up to Turgor Volume, or up to the place that it would get, is read."""
    animated = stack.animated_settings(ob)
    return Lane(tuple(_posing_reasons(ob, animated)), tuple(_body_reasons(ob, animated)))


def signature(ob: bpy.types.Object) -> tuple[object, ...]:
    """What a binding depends on: while equal, the stack makes the same of an unchanged mesh, and is read alike."""
    lane = lane_of(ob)
    parent = None if ob.parent is None else ob.parent_type
    return (*stack.signature(ob), lane, parent, *([] if lane.moves else _places(ob)))


def _posing_reasons(ob: bpy.types.Object, animated: stack.Animated) -> Iterator[Message]:
    armature = stack.armature_modifier(ob)
    posing = stack.posing_modifiers(ob)
    limb = _is_limb(ob, posing)
    for modifier in posing:
        if modifier == armature or modifier.type in stack.STILL_TYPES or (limb and modifier == posing[-1]):
            continue
        if armature is None:
            yield message("{modifier} poses it without an Armature", modifier=modifier.name)
        else:
            yield message("{modifier} moves it after the Armature", modifier=modifier.name)
    if armature is None:
        return
    if armature.use_multi_modifier:
        yield message("{modifier} uses Multi Modifier", modifier=armature.name)
    if animated.get(armature.name, frozenset()) - stack.FOLLOWED:
        yield message("{modifier} has animated settings", modifier=armature.name)


def is_blended(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> bool:
    """Whether an Armature alone, with these settings, skins otherwise than the engine."""
    return armature.use_multi_modifier or stack.is_animated(ob, armature, but=stack.FOLLOWED)


def _is_limb(ob: bpy.types.Object, posing: list[bpy.types.Modifier]) -> bool:
    """Whether Turgor Spine alone stands between the Armature and ours: the engine then asks it what it adds."""
    spine = stack.own_modifier(ob, node_group.SPINE)
    return spine is not None and posing[1:] == [spine] and posing[0].type == "ARMATURE"


def _body_reasons(ob: bpy.types.Object, animated: stack.Animated) -> Iterator[Message]:
    yield from _key_reasons(ob)
    has_keys = ob.data.shape_keys is not None
    for modifier in _body_modifiers(ob):
        name = modifier.name
        if modifier.type in stack.IDLE_TYPES:
            continue
        if modifier.type not in STEADY_TYPES or (modifier.type == "MASK" and modifier.mode == "ARMATURE"):
            yield message("{modifier} may move the mesh before it is posed", modifier=name)
        elif animated.get(name):
            yield message("{modifier} is animated before it is posed", modifier=name)
        elif has_keys and modifier.type not in stack.LINEAR_TYPES:
            yield message("{modifier} changes shape keys before it is posed", modifier=name)
        elif (other := _moving_pointer(modifier)) is not None:
            yield message("{modifier} follows {other}, which may move", modifier=name, other=other)


def _body_modifiers(ob: bpy.types.Object) -> Iterator[bpy.types.Modifier]:
    end = stack.body_end(ob)
    return iter(()) if end is None else stack.modifiers_before(ob, end)


def _moving_pointer(modifier: bpy.types.Modifier) -> str | None:
    """Name of what a modifier looks at and that may be another on every frame."""
    for name, value in pointers(modifier):
        if isinstance(value, bpy.types.Object):
            is_still = (modifier.type, name) in _PLACES and _stands_still(value)
        elif isinstance(value, bpy.types.Texture):
            is_still = _is_still_texture(value)
        else:
            is_still = isinstance(value, bpy.types.NodeTree) and _is_still_tree(value)
        if not is_still:
            return value.name
    if modifier.type == "NODES" and modifier.node_group is not None:
        for value in modifier_inputs.read_pointers(modifier):
            if not isinstance(value, bpy.types.Material):
                return value.name
    return None


def pointers(modifier: bpy.types.Modifier) -> Iterator[tuple[str, bpy.types.ID]]:
    """All data that a modifier's settings name, without the inputs of Geometry Nodes."""
    for prop in modifier.bl_rna.properties:
        if prop.type == "POINTER" and isinstance(value := getattr(modifier, prop.identifier), bpy.types.ID):
            yield prop.identifier, value


def _places(ob: bpy.types.Object) -> list[object]:
    """Where objects stand that modifiers before the Armature look at: the artist may move them by hand."""
    found: list[object] = []
    for modifier in _body_modifiers(ob):
        for name, value in pointers(modifier):
            if (modifier.type, name) in _PLACES and isinstance(value, bpy.types.Object):
                found.append(tuple(map(tuple, ob.matrix_world.inverted_safe() @ value.matrix_world)))
    return found


def _stands_still(ob: bpy.types.Object | None) -> bool:
    """Whether an object's place is known to be the same on every frame."""
    while ob is not None:
        if _is_animated(ob) or len(ob.constraints) or ob.rigid_body is not None or frame_handlers():
            return False
        if ob.parent is not None and ob.parent_type != "OBJECT":
            return False
        ob = ob.parent
    return True


def stands_still_to(ob: bpy.types.Object, other: bpy.types.Object) -> bool:
    """Whether two objects are known to stand to each other on every frame as they do now."""
    ways = [list(_way_up(each)) for each in (ob, other)]
    shared = next((each for each in ways[0] if each in ways[1]), None)
    below = [way if shared is None else way[: way.index(shared)] for way in ways]
    return all(_is_placed_by_hand(each) for way in below for each in way)


def _way_up(ob: bpy.types.Object | None) -> Iterator[bpy.types.Object]:
    while ob is not None:
        yield ob
        ob = ob.parent


_PLACE_PATHS = ("location", "rotation", "scale", "delta_", "matrix_", "parent")


def _is_placed_by_hand(ob: bpy.types.Object) -> bool:
    """Whether nothing but the artist changes where an object stands to its parent."""
    is_free = not len(ob.constraints) and ob.rigid_body is None and (ob.parent is None or ob.parent_type == "OBJECT")
    return is_free and not any(path.startswith(_PLACE_PATHS) for path in stack.animated_paths(ob.animation_data))


def _is_animated(owner: bpy.types.ID) -> bool:
    animation = getattr(owner, "animation_data", None)
    if animation is None:
        return False
    return animation.action is not None or len(animation.nla_tracks) > 0 or len(animation.drivers) > 0


def _is_still_texture(texture: bpy.types.Texture) -> bool:
    tree = texture.node_tree
    if _is_animated(texture) or (tree is not None and _is_animated(tree)):
        return False
    return texture.type != "IMAGE" or texture.image is None or texture.image.source not in {"MOVIE", "SEQUENCE"}


def _is_still_tree(tree: bpy.types.NodeTree, known: frozenset[bpy.types.NodeTree] = frozenset()) -> bool:
    if tree in known:
        return True
    if _is_animated(tree):
        return False
    for node in tree.nodes:
        if any(part in node.bl_idname for part in _MOVING_NODES):
            return False
        if any(socket.type in _MOVING_SOCKETS for socket in (*node.inputs, *node.outputs) if not _is_end(node)):
            return False
        inner = getattr(node, "node_tree", None)
        if inner is not None and not _is_still_tree(inner, known | {tree}):
            return False
    return True


def _is_end(node: bpy.types.Node) -> bool:
    """Inputs that name an object are looked at in the modifier."""
    return node.bl_idname in {"NodeGroupInput", "NodeGroupOutput"}


def _key_reasons(ob: bpy.types.Object) -> Iterator[Message]:
    """Shape keys are mixed by the engine where only their values change."""
    if any(stack.animated_paths(ob.data.animation_data)):
        yield message("{mesh} is animated itself", mesh=ob.data.name)
    keys = ob.data.shape_keys
    if keys is None or len(keys.key_blocks) < 2:
        return
    if not keys.use_relative:
        yield message("its shape keys are absolute")
        return
    if not all(path.endswith(_KEY_PATHS) for path in stack.animated_paths(keys.animation_data)):
        yield message("points of its shape keys are animated")
    if (name := _own_function(keys)) is not None:
        yield message("a driver of its shape keys calls {function}, which may rewrite them", function=name)
    elif handlers := frame_handlers():
        yield message("{handler} is called on every frame and may rewrite its shape keys", handler=handlers[0])


# While handlers are put aside, those that there were.
_put_aside: list[str] | None = None


@contextmanager
def handlers_put_aside() -> Iterator[None]:
    """Within it `frame_handlers` tells those of before: how a stack is read does not change while poses are sampled."""
    global _put_aside
    before = _put_aside
    _put_aside = frame_handlers()
    try:
        yield
    finally:
        _put_aside = before


def frame_handlers() -> list[str]:
    """Names of functions of others that Blender calls on every frame, and that may change anything."""
    if _put_aside is not None:
        return _put_aside
    return [
        f"{handler.__module__}.{handler.__name__}"
        for event in _FRAME_EVENTS
        for handler in getattr(bpy.app.handlers, event)
        if callable(handler) and not f"{handler.__module__}.".startswith(f"{_PACKAGE}.")
    ]


def _own_function(keys: bpy.types.Key) -> str | None:
    """Name of a function that somebody gave to drivers, called by one of the keys' drivers."""
    animation = keys.animation_data
    for curve in () if animation is None else animation.drivers:
        driver = curve.driver
        if driver.type == "SCRIPTED" and not driver.is_simple_expression:
            for name in _names(driver.expression):
                given = bpy.app.driver_namespace.get(name)
                if callable(given) and type(given).__name__ != "builtin_function_or_method":
                    return name
    return None


def _names(expression: str) -> list[str]:
    try:
        tree = ast.parse(expression, mode="eval")
    except SyntaxError:
        return []
    return [node.id for node in ast.walk(tree) if isinstance(node, ast.Name)]
