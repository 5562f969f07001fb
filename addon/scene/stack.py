"""The modifier stack: which modifiers are ours, what stands before the Armature, and what we cannot follow."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from . import modifier_inputs, node_group, skeleton

MODIFIER_NAME = "Turgor Volume"

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
# With these before the Armature the mesh is a weighted sum of the shape keys' meshes.
LINEAR_TYPES = frozenset(
    "MIRROR SUBSURF TRIANGULATE MULTIRES EDGE_SPLIT MASK NORMAL_EDIT WEIGHTED_NORMAL UV_PROJECT UV_WARP"
    " VERTEX_WEIGHT_EDIT VERTEX_WEIGHT_MIX VERTEX_WEIGHT_PROXIMITY DATA_TRANSFER".split()
)


def volume_modifier(ob: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """Ours, the first in the stack."""
    for modifier in ob.modifiers:
        if modifier.type == "NODES" and node_group.is_volume_group(modifier.node_group):
            return modifier
    return None


def armature_modifier(ob: bpy.types.Object) -> bpy.types.ArmatureModifier | None:
    """The Armature that is corrected: right before our modifier, or the last one when ours is not there yet."""
    ours = volume_modifier(ob)
    modifiers = list(ob.modifiers)
    if ours is not None:
        modifiers = modifiers[: modifiers.index(ours)][-1:]
    armatures = [modifier for modifier in modifiers if modifier.type == "ARMATURE"]
    return armatures[-1] if armatures else None


def modifiers_before(ob: bpy.types.Object, modifier: bpy.types.Modifier) -> Iterator[bpy.types.Modifier]:
    """Those that change the mesh in the viewport or in renders."""
    for earlier in ob.modifiers:
        if earlier == modifier:
            return
        if earlier.show_viewport or earlier.show_render:
            yield earlier


def obstacle(ob: bpy.types.Object) -> str | None:
    """Why this object cannot be corrected and what to do; None when it can."""
    armature = armature_modifier(ob)
    if armature is None:
        if volume_modifier(ob) is not None:
            return "No Armature modifier right before Turgor Volume: move Turgor Volume directly below it"
        return "No Armature modifier: give the mesh one (Object > Parent > Armature Deform)"
    return _armature_obstacle(ob, armature) or _rig_obstacle(ob, armature) or _earlier_obstacle(ob, armature)


def render_difference(ob: bpy.types.Object) -> str | None:
    """What makes the stack before the Armature another mesh in renders, where it then stays as skinned."""
    armature = armature_modifier(ob)
    if armature is None:
        return None
    for modifier in modifiers_before(ob, armature):
        if modifier.show_viewport != modifier.show_render:
            return f"{modifier.name} is on in the viewport or in renders only: renders stay uncorrected"
        if modifier.type == "SUBSURF" and modifier.levels != modifier.render_levels:
            return f"{modifier.name} has other levels in renders: make them equal, or renders stay uncorrected"
    return None


def _armature_obstacle(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> str | None:
    if armature.object is None or armature.object.type != "ARMATURE":
        return f"{armature.name} has no armature: choose one in its Object field"
    if armature.use_multi_modifier:
        return f"{armature.name} uses Multi Modifier, which blends two armatures: turn it off"
    if armature.use_bone_envelopes or not armature.use_vertex_groups:
        return f"{armature.name} deforms by bone envelopes: use vertex groups only"
    keys = ob.data.shape_keys
    if keys is not None and not keys.use_relative:
        return "Shape keys are absolute: make them Relative in the mesh's properties"
    return None


def _rig_obstacle(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> str | None:
    groups = ob.vertex_groups
    for bone in armature.object.data.bones:
        if bone.use_deform and bone.name in groups:
            if bone.bbone_segments > 1:
                return f"Bone {bone.name} is a bendy bone, not supported yet: set its segments to 1"
            if bone.use_envelope_multiply:
                return f"Bone {bone.name} multiplies its weights by its envelope: turn that off"
    return None


def _earlier_obstacle(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> str | None:
    has_shape_keys = ob.data.shape_keys is not None
    for modifier in modifiers_before(ob, armature):
        if modifier.type == "ARMATURE":
            return f"{modifier.name} deforms before {armature.name}: only one Armature is supported, merge them"
        if modifier.type in MOVING_TYPES or (modifier.type == "NODES" and _moves(modifier.node_group)):
            return f"{modifier.name} can move the mesh before the Armature: move it after Turgor Volume"
        if _is_animated(ob, modifier):
            return f"{modifier.name} is animated before the Armature: move it after Turgor Volume"
        if has_shape_keys and modifier.type not in LINEAR_TYPES:
            return f"{modifier.name} changes shape keys before the Armature: apply it, or move it after Turgor Volume"
    return None


def _moves(tree: bpy.types.NodeTree | None) -> bool:
    if tree is None:
        return False
    return any(node.bl_idname in MOVING_NODES or _moves(getattr(node, "node_tree", None)) for node in tree.nodes)


def _is_animated(ob: bpy.types.Object, modifier: bpy.types.Modifier) -> bool:
    prefix = f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"]'
    return any(path.startswith(prefix) for path in animated_paths(ob.animation_data))


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
    keys = ob.data.shape_keys
    read: list[object] = [ob.data.session_uid, [group.name for group in ob.vertex_groups]]
    if armature is not None and armature.object is not None and armature.object.type == "ARMATURE":
        read += skeleton.signature(armature.object.data)
    if keys is not None:
        read += [keys.use_relative, [(key.name, key.relative_key.name, key.vertex_group) for key in keys.key_blocks]]
    for modifier in ob.modifiers:
        read.append(_settings(modifier))
        if modifier == armature:
            break
    return tuple(read)


def _settings(modifier: bpy.types.Modifier) -> list[object]:
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
