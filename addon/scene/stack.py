"""The modifier stack: which modifiers are ours, and what stands before the Armature."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

import bpy

from . import modifier_inputs, modifier_places, node_group, skeleton

# They shape the mesh by something that may move or that only exists while playing: what stands before the Armature
# must be the same on every frame.
MOVING_TYPES = frozenset(
    "BOOLEAN BUILD CLOTH COLLISION CORRECTIVE_SMOOTH CURVE DYNAMIC_PAINT EXPLODE FLUID HOOK LAPLACIANDEFORM LATTICE"
    " MESH_CACHE MESH_DEFORM MESH_SEQUENCE_CACHE OCEAN PARTICLE_INSTANCE PARTICLE_SYSTEM SHRINKWRAP SOFT_BODY"
    " SURFACE_DEFORM WARP WAVE".split()
)
MOVING_NODES = frozenset(
    "GeometryNodeInputSceneTime GeometryNodeObjectInfo GeometryNodeCollectionInfo GeometryNodeSimulationInput"
    " GeometryNodeInputActiveCamera GeometryNodeSelfObject".split()
)
SIMULATION_TYPES = frozenset("CLOTH DYNAMIC_PAINT EXPLODE FLUID PARTICLE_INSTANCE SOFT_BODY".split())
# Particles leave the mesh alone, but are simulated too.
SIMULATED_TYPES = SIMULATION_TYPES | {"PARTICLE_SYSTEM"}
SIMULATION_NODES = frozenset("GeometryNodeSimulationInput GeometryNodeXPBDSolver GeometryNodeBake".split())
# Of modifiers by their names: settings, or identifiers of inputs.
Animated = Mapping[str, frozenset[str]]
# More levels than any subdivision has.
ANY_LEVEL = 99
# With these before the Armature the mesh is a weighted sum of the shape keys' meshes.
LINEAR_TYPES = frozenset(
    "MIRROR SUBSURF TRIANGULATE MULTIRES EDGE_SPLIT MASK NORMAL_EDIT WEIGHTED_NORMAL UV_PROJECT UV_WARP"
    " VERTEX_WEIGHT_EDIT VERTEX_WEIGHT_MIX VERTEX_WEIGHT_PROXIMITY DATA_TRANSFER".split()
)


# They move vertices and make none.
DEFORMING_TYPES = frozenset(
    "ARMATURE CAST CORRECTIVE_SMOOTH CURVE DISPLACE HOOK LAPLACIANDEFORM LAPLACIANSMOOTH LATTICE MESH_CACHE MESH_DEFORM"
    " SHRINKWRAP SIMPLE_DEFORM SMOOTH SURFACE_DEFORM VOLUME_DISPLACE WARP WAVE".split()
)
# They leave positions, faces and weights alone.
IDLE_TYPES = frozenset("COLLISION NORMAL_EDIT PARTICLE_SYSTEM SURFACE UV_PROJECT UV_WARP WEIGHTED_NORMAL".split())
# They leave positions and faces alone.
STILL_TYPES = IDLE_TYPES | frozenset(
    "DATA_TRANSFER VERTEX_WEIGHT_EDIT VERTEX_WEIGHT_MIX VERTEX_WEIGHT_PROXIMITY".split()
)


def own_modifier(ob: bpy.types.Object, kind: node_group.Kind) -> bpy.types.NodesModifier | None:
    """Ours of this kind, the first in the stack."""
    for modifier in ob.modifiers:
        if modifier.type == "NODES" and node_group.is_of_kind(modifier.node_group, kind):
            return modifier
    return None


def add_own_modifier(
    ob: bpy.types.Object, kind: node_group.Kind, place: int, *, show_in_editmode: bool
) -> bpy.types.NodesModifier:
    """A new modifier of this kind at a place of the stack, without Blender's own panel of settings.

    Raises modifier_places.PlaceError, and has added nothing.
    """
    ours = ob.modifiers.new(kind.label, "NODES")
    try:
        modifier_places.put(ob, ours, place)
    except modifier_places.PlaceError:
        ob.modifiers.remove(ours)
        raise
    ours.node_group = node_group.ensure(kind)
    ours.show_in_editmode = show_in_editmode
    ours.show_group_selector = False
    if hasattr(ours, "show_manage_panel"):  # from Blender 5.0 on
        ours.show_manage_panel = False
    return ours


def volume_modifier(ob: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """The modifier Turgor Volume of an object, None where it has none."""
    return own_modifier(ob, node_group.VOLUME)


def armature_modifier(ob: bpy.types.Object) -> bpy.types.ArmatureModifier | None:
    """The Armature that divides the stack: what stands before it makes the body, what stands from it on poses that.

    Of several before our modifier the first in use.
    """
    armatures = [modifier for modifier in modifiers_to_own(ob) if modifier.type == "ARMATURE"]
    in_use = [modifier for modifier in armatures if is_on(modifier)]
    able = [modifier for modifier in in_use if modifier.object is not None and modifier.object.type == "ARMATURE"]
    return (able or in_use or armatures or [None])[0]


def modifiers_to_own(ob: bpy.types.Object) -> list[bpy.types.Modifier]:
    """All modifiers before Turgor Volume, or before the place that it would get."""
    modifiers = list(ob.modifiers)
    ours = volume_modifier(ob)
    return modifiers[: place_for_new(ob) if ours is None else modifiers.index(ours)]


def place_for_new(ob: bpy.types.Object) -> int:
    """Where in the stack a new Turgor Volume goes: after what poses the mesh.

    That is the last Armature, and a Turgor Spine that changes the skin of its bones; without any, the last modifier
    that moves vertices before one that makes other vertices.
    """
    modifiers = list(ob.modifiers)
    armatures = [place for place, modifier in enumerate(modifiers) if modifier.type == "ARMATURE"]
    armatures = [place for place in armatures if is_on(modifiers[place])] or armatures
    if armatures:
        place = armatures[-1] + 1
        spine = own_modifier(ob, node_group.SPINE)
        return place + 1 if spine is not None and modifiers[place : place + 1] == [spine] else place
    place = 0
    for index, modifier in enumerate(modifiers):
        if is_on(modifier) and (modifier.type in DEFORMING_TYPES or modifier.type == "NODES"):
            place = index + 1
        elif place and modifier.type not in STILL_TYPES and is_on(modifier):
            break
    return place


def body_end(ob: bpy.types.Object) -> bpy.types.Modifier | None:
    """The first modifier that the body does not have: the Armature, without one the first that may move vertices."""
    armature = armature_modifier(ob)
    if armature is not None:
        return armature
    posing = (each for each in ob.modifiers if is_on(each) and (each.type in DEFORMING_TYPES or each.type == "NODES"))
    return next(posing, next(iter(ob.modifiers), None))


def posing_modifiers(ob: bpy.types.Object) -> list[bpy.types.Modifier]:
    """Modifiers that pose the body: in use, from the Armature, or else from the first of all, up to ours."""
    before, end = modifiers_to_own(ob), body_end(ob)
    first = before.index(end) if end in before else 0
    return [modifier for modifier in before[first:] if is_on(modifier)]


def is_on(modifier: bpy.types.Modifier) -> bool:
    """Whether a modifier is on in the viewport or in renders."""
    return modifier.show_viewport or modifier.show_render


def modifiers_before(ob: bpy.types.Object, modifier: bpy.types.Modifier) -> Iterator[bpy.types.Modifier]:
    """Modifiers before this one that change the mesh in the viewport or in renders."""
    for earlier in ob.modifiers:
        if earlier == modifier:
            return
        if is_on(earlier):
            yield earlier


def later_armatures(ob: bpy.types.Object) -> Iterator[bpy.types.ArmatureModifier]:
    """Armature modifiers after ours that are on in the viewport or in renders."""
    for later in list(ob.modifiers)[len(modifiers_to_own(ob)) :]:
        if later.type == "ARMATURE" and is_on(later):
            yield later


def simulates(modifier: bpy.types.Modifier) -> bool:
    """Whether what it makes follows from all frames before."""
    if modifier.type == "NODES":
        return has_node(modifier.node_group, SIMULATION_NODES)
    return modifier.type in SIMULATION_TYPES


def moves(modifier: bpy.types.Modifier) -> bool:
    """Whether a modifier makes a mesh that may be another on every frame."""
    if modifier.type in MOVING_TYPES:
        return True
    if modifier.type == "MASK":
        return modifier.mode == "ARMATURE"
    return modifier.type == "NODES" and has_node(modifier.node_group, MOVING_NODES)


def has_node(tree: bpy.types.NodeTree | None, kinds: frozenset[str]) -> bool:
    """Whether a node of one of these kinds is in the tree or in a group within."""
    if tree is None:
        return False
    return any(node.bl_idname in kinds or has_node(getattr(node, "node_tree", None), kinds) for node in tree.nodes)


# Switches of the Armature that our modifier follows by its drivers.
FOLLOWED = frozenset({"show_viewport", "show_render"})


def is_animated(ob: bpy.types.Object, modifier: bpy.types.Modifier, but: frozenset[str] = frozenset()) -> bool:
    """Whether any of its settings has keyframes or a driver, `but` for these."""
    return bool(animated_settings(ob).get(modifier.name, frozenset()) - but)


def animated_settings(ob: bpy.types.Object) -> Animated:
    """Names of settings of its modifiers that have keyframes or a driver, by name of the modifier."""
    found: dict[str, set[str]] = {}
    for path in animated_paths(ob.animation_data):
        parts = re.match(r'modifiers\["((?:[^"\\]|\\.)*)"\](.*)', path)
        if parts is not None:
            setting = re.findall(r"\w+", parts[2].removesuffix(".value"))[-1:]
            found.setdefault(bpy.utils.unescape_identifier(parts[1]), set()).update(setting)
    return {name: frozenset(settings) for name, settings in found.items()}


def animated_paths(animation: bpy.types.AnimData | None) -> Iterator[str]:
    """Data paths with a driver, or with a curve in the active action or in a strip of the NLA."""
    if animation is None:
        return
    for curve in animation.drivers:
        yield curve.data_path
    yield from keyed_paths(animation)


def keyed_paths(animation: bpy.types.AnimData) -> Iterator[str]:
    """Data paths with a curve in the active action or in a strip of the NLA, of the slots that are used."""
    yield from _paths_of(animation.action, animation.action_slot)
    for track in animation.nla_tracks:
        for strip in track.strips:
            yield from _paths_of_strip(strip)


def _paths_of_strip(strip: bpy.types.NlaStrip) -> Iterator[str]:
    yield from _paths_of(strip.action, strip.action_slot)
    for inner in strip.strips:  # of a meta strip
        yield from _paths_of_strip(inner)


def _paths_of(action: bpy.types.Action | None, slot: bpy.types.ActionSlot | None) -> Iterator[str]:
    if action is None:
        return
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                if slot is None or bag.slot_handle == slot.handle:
                    for curve in bag.fcurves:
                        yield curve.data_path


# Switches of the user interface, and figures that Blender writes.
NOT_SETTINGS = frozenset(
    "execution_time is_active is_override_data name persistent_uid show_expanded show_group_selector show_in_editmode"
    " show_manage_panel show_on_cage use_apply_on_spline use_pin_to_last".split()
)


# Of Data Transfer: Blender evaluates the source for the names of their choices, which must not happen amid a frame.
EVALUATING_SETTINGS = "layers_"


def signature(ob: bpy.types.Object) -> tuple[object, ...]:
    """Bones at rest, and settings up to the Armature: while equal, they make the same of an unchanged mesh.

    Settings that are animated are left out: where there are any, their values are of the frame.
    """
    armature = armature_modifier(ob)
    read: list[object] = [ob.data.session_uid, [group.name for group in ob.vertex_groups]]
    if armature is not None and armature.object is not None and armature.object.type == "ARMATURE":
        read += skeleton.signature(armature.object.data)
    read += [(later.name, later.show_viewport, later.show_render) for later in later_armatures(ob)]
    read.append(shape_key_settings(ob.data.shape_keys))
    spine = own_modifier(ob, node_group.SPINE)
    read.append(None if spine is None else (spine.name, spine.show_viewport, spine.show_render))
    animated = animated_settings(ob)
    read += settings_before(ob, body_end(ob), animated)
    return (*read, [] if armature is None else settings_of(armature, animated.get(armature.name, frozenset())))


def most_levels() -> tuple[int, int]:
    """Subdivision levels that the scene allows in the viewport and in renders."""
    render = bpy.context.scene.render
    if not render.use_simplify:
        return ANY_LEVEL, ANY_LEVEL
    return render.simplify_subdivision, render.simplify_subdivision_render


def shape_key_settings(keys: bpy.types.Key | None) -> list[object]:
    """Which keys there are; their values are of the frame."""
    if keys is None:
        return []
    return [keys.use_relative, [(key.name, key.relative_key.name, key.vertex_group) for key in keys.key_blocks]]


def settings_before(
    ob: bpy.types.Object, end: bpy.types.Modifier | None, animated: Animated | None = None
) -> list[object]:
    """Settings of all modifiers before `end`; those of `animated` left out."""
    modifiers = list(ob.modifiers)
    before = modifiers if end is None else modifiers[: modifiers.index(end)]
    but = animated or {}
    return [most_levels(), *(settings_of(modifier, but.get(modifier.name, frozenset())) for modifier in before)]


def settings_of(modifier: bpy.types.Modifier, but: frozenset[str] = frozenset()) -> list[object]:
    """Plain values of all settings of a modifier but these; other data by its uid."""
    found: list[object] = [modifier.name]
    for prop in modifier.bl_rna.properties:
        if prop.identifier in NOT_SETTINGS or prop.identifier in but or prop.type == "COLLECTION":
            continue
        if prop.identifier.startswith(EVALUATING_SETTINGS):
            continue
        value = getattr(modifier, prop.identifier)
        if isinstance(value, bpy.types.ID):
            found.append(value.session_uid)
        elif isinstance(value, bpy.types.CurveMapping):
            found.append([(*point.location, point.handle_type) for curve in value.curves for point in curve.points])
        elif prop.type != "POINTER":
            found.append(tuple(value) if getattr(prop, "is_array", False) else value)
    if modifier.type == "NODES" and modifier.node_group is not None:
        found += modifier_inputs.read_values(modifier, but)
    return found
