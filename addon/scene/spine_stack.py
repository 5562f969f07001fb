"""Turgor Spine in the stack: what stands before it, whether bones skin the body too, and what we cannot follow."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..messages import message
from . import node_group, obstacles, skeleton, spine_chain, spine_curve, stack
from .gathered import gathered
from .obstacles import Obstacle

# Before these it is put into a new stack: they move the mesh, or make another one in renders.
LATER_TYPES = stack.MOVING_TYPES | {"ARMATURE", "SUBSURF", "MULTIRES"}


def spine_modifier(ob: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """Turgor Spine."""
    return stack.own_modifier(ob, node_group.SPINE)


def limb_modifier(ob: bpy.types.Object) -> bpy.types.ArmatureModifier | None:
    """The Armature right before ours, of the spine's own bones: their weights say which part of the body follows."""
    ours, saved = spine_modifier(ob), ob.turgor_spine
    if ours is None or saved.source != "BONES":
        return None
    modifiers = list(ob.modifiers)
    earlier = modifiers[: modifiers.index(ours)]
    if earlier and earlier[-1].type == "ARMATURE" and earlier[-1].object == saved.rig is not None:
        return earlier[-1]
    return None


def fleshed_limb(ob: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """Turgor Spine where it changes the skin that Turgor Volume, right after it, corrects; None where it is off."""
    ours = spine_modifier(ob)
    if ours is None or not ours.show_viewport or limb_modifier(ob) is None:
        return None
    modifiers = list(ob.modifiers)
    following = modifiers[modifiers.index(ours) + 1 :][:1]
    return ours if following == [stack.volume_modifier(ob)] else None


def render_difference(ob: bpy.types.Object) -> Obstacle | None:
    """Why Turgor Volume, after ours, is not right in renders."""
    ours = spine_modifier(ob)
    if ours is None or limb_modifier(ob) is None or ours.show_viewport == ours.show_render:
        return None
    text = message(
        "{modifier} is on in the viewport or in renders only: renders show plain skinning", modifier=ours.name
    )
    return Obstacle("render_switch", text, "SAME_IN_RENDERS", ours.name)


def rest_end(ob: bpy.types.Object) -> bpy.types.Modifier | None:
    """The first modifier that the body at rest does not have."""
    return limb_modifier(ob) or spine_modifier(ob)


def place_for_new(ob: bpy.types.Object, rig: bpy.types.Object | None) -> int:
    """Where in the stack a new Turgor Spine goes: after the Armature of its own bones, else before all that moves."""
    modifiers = list(ob.modifiers)
    for index, modifier in enumerate(modifiers):
        if modifier.type == "ARMATURE" and modifier.object is not None and modifier.object == rig:
            return index + 1
    place = next((index for index, each in enumerate(modifiers) if _stands_later(each)), len(modifiers))
    # Blender lets nothing of ours stand before a Multires; after it is as good where nothing between moves.
    levels = [index for index, each in enumerate(modifiers) if each.type == "MULTIRES"]
    if levels and all(each.type in {"SUBSURF", "MULTIRES"} for each in modifiers[place : levels[-1] + 1]):
        place = max(place, levels[-1] + 1)
    return place


def _stands_later(modifier: bpy.types.Modifier) -> bool:
    group = getattr(modifier, "node_group", None)
    return modifier.type in LATER_TYPES or node_group.is_of_kind(group, node_group.VOLUME)


def obstacle(ob: bpy.types.Object) -> Obstacle | None:
    """Why this body cannot follow its spine and what to do; None when it can."""
    saved, ours = ob.turgor_spine, spine_modifier(ob)
    if saved.source == "BONES":
        text = spine_chain.obstacle(saved.rig, saved.first_bone, saved.last_bone)
    else:
        text = spine_curve.obstacle(saved.curve)
    if text is not None:
        return Obstacle("no_spine", text)
    if ours is None:
        return None
    limb = limb_modifier(ob)
    found = None if limb is None else obstacles.armature_obstacle(ob, limb)
    return found or gathered(_earlier_obstacles(ob, limb or ours))


def _earlier_obstacles(ob: bpy.types.Object, end: bpy.types.Modifier) -> Iterator[Obstacle]:
    has_shape_keys = ob.data.shape_keys is not None
    for modifier in stack.modifiers_before(ob, end):
        name = modifier.name
        if modifier.type == "ARMATURE":
            text = message(
                "{modifier} deforms the body before Turgor Spine: move it below, or flesh its own bones", modifier=name
            )
            yield Obstacle("second_armature", text, "MOVE_AFTER", name)
        elif stack.moves(modifier):
            text = message("{modifier} can move the body before Turgor Spine: move it below", modifier=name)
            yield Obstacle("moving_modifier", text, "MOVE_AFTER", name)
        elif stack.is_animated(ob, modifier):
            text = message("{modifier} is animated before Turgor Spine: move it below", modifier=name)
            yield Obstacle("moving_modifier", text, "MOVE_AFTER", name)
        elif has_shape_keys and modifier.type not in stack.LINEAR_TYPES:
            text = message(
                "{modifier} changes shape keys before Turgor Spine: apply it, or move it below", modifier=name
            )
            yield Obstacle("shape_key_modifier", text, "MOVE_AFTER", name)


def chosen(saved: bpy.types.PropertyGroup) -> tuple[object, ...]:
    """Saved settings that a binding depends on; cheap enough for every frame."""
    rig, curve = saved.rig, saved.curve
    return (
        saved.source,
        None if rig is None else rig.name_full,
        saved.first_bone,
        saved.last_bone,
        None if curve is None else curve.name_full,
        saved.vertex_group,
        saved.invert_vertex_group,
        saved.bound_topology,
    )


def signature(ob: bpy.types.Object) -> tuple[object, ...]:
    """Settings up to our modifier, and what of the spine at rest is not saved: while equal, so is the binding."""
    saved, end = ob.turgor_spine, rest_end(ob)
    read: list[object] = [ob.data.session_uid, [group.name for group in ob.vertex_groups]]
    read.append(stack.shape_key_settings(ob.data.shape_keys))
    read += stack.settings_before(ob, end)
    if end is not None and end.type == "ARMATURE":
        read.append(stack.settings_of(end))
    if saved.source == "BONES" and saved.rig is not None and saved.rig.type == "ARMATURE":
        read += skeleton.signature(saved.rig.data)
    return (*read, *chosen(saved))
