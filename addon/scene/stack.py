"""The modifier stack: which modifiers are ours, and what stands before the Armature."""

from __future__ import annotations

from collections.abc import Iterator

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
# More levels than any subdivision has.
ANY_LEVEL = 99
# With these before the Armature the mesh is a weighted sum of the shape keys' meshes.
LINEAR_TYPES = frozenset(
    "MIRROR SUBSURF TRIANGULATE MULTIRES EDGE_SPLIT MASK NORMAL_EDIT WEIGHTED_NORMAL UV_PROJECT UV_WARP"
    " VERTEX_WEIGHT_EDIT VERTEX_WEIGHT_MIX VERTEX_WEIGHT_PROXIMITY DATA_TRANSFER".split()
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
    """The Armature that is corrected: right before our modifier, or the last one in use when ours is not there yet.

    Turgor Spine may stand between: it changes the skin of its own bones, which is then corrected too.
    """
    modifiers: list[bpy.types.Modifier] = []
    for modifier in ob.modifiers:
        if modifier.type == "NODES" and node_group.is_of_kind(modifier.node_group, node_group.VOLUME):
            is_fleshed = bool(modifiers) and modifiers[-1] == own_modifier(ob, node_group.SPINE)
            modifiers = modifiers[-2:-1] if is_fleshed else modifiers[-1:]
            break
        modifiers.append(modifier)
    armatures = [modifier for modifier in modifiers if modifier.type == "ARMATURE"]
    in_use = [modifier for modifier in armatures if is_on(modifier)]
    return (in_use or armatures or [None])[-1]


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


def later_armatures(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> Iterator[bpy.types.ArmatureModifier]:
    """Armature modifiers after `armature` that are on in the viewport or in renders."""
    modifiers = list(ob.modifiers)
    for later in modifiers[modifiers.index(armature) + 1 :]:
        if later.type == "ARMATURE" and is_on(later):
            yield later


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
    prefix = f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"]'
    paths = (path for path in animated_paths(ob.animation_data) if path.startswith(prefix))
    return any(path.removeprefix(f"{prefix}.") not in but for path in paths)


def animated_paths(animation: bpy.types.AnimData | None) -> Iterator[str]:
    """Data paths with a driver, or with a curve in the active action."""
    if animation is None:
        return
    for curve in animation.drivers:
        yield curve.data_path
    action = animation.action
    if action is None:
        return
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                for curve in bag.fcurves:
                    yield curve.data_path


# Switches of the user interface, and figures that Blender writes.
_NOT_SETTINGS = frozenset(
    "execution_time is_active is_override_data name persistent_uid show_expanded show_group_selector show_in_editmode"
    " show_manage_panel show_on_cage use_apply_on_spline use_pin_to_last".split()
)


def signature(ob: bpy.types.Object) -> tuple[object, ...]:
    """Bones at rest, and settings up to the Armature: while equal, they make the same of an unchanged mesh."""
    armature = armature_modifier(ob)
    read: list[object] = [ob.data.session_uid, [group.name for group in ob.vertex_groups]]
    if armature is not None and armature.object is not None and armature.object.type == "ARMATURE":
        read += skeleton.signature(armature.object.data)
        read += [(later.name, later.show_viewport, later.show_render) for later in later_armatures(ob, armature)]
    read.append(shape_key_settings(ob.data.shape_keys))
    spine = own_modifier(ob, node_group.SPINE)
    read.append(None if spine is None else (spine.name, spine.show_viewport, spine.show_render))
    return (*read, *settings_before(ob, armature), [] if armature is None else settings_of(armature))


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


def settings_before(ob: bpy.types.Object, end: bpy.types.Modifier | None) -> list[object]:
    """Settings of all modifiers before `end`."""
    modifiers = list(ob.modifiers)
    before = modifiers if end is None else modifiers[: modifiers.index(end)]
    return [most_levels(), *(settings_of(modifier) for modifier in before)]


def settings_of(modifier: bpy.types.Modifier) -> list[object]:
    """Plain values of all settings of a modifier; other data by its uid."""
    found: list[object] = [modifier.name]
    for prop in modifier.bl_rna.properties:
        if prop.identifier in _NOT_SETTINGS or prop.type == "COLLECTION":
            continue
        value = getattr(modifier, prop.identifier)
        if isinstance(value, bpy.types.ID):
            found.append(value.session_uid)
        elif prop.type != "POINTER":
            found.append(tuple(value) if getattr(prop, "is_array", False) else value)
    if modifier.type == "NODES" and modifier.node_group is not None:
        found += modifier_inputs.read_values(modifier)
    return found
