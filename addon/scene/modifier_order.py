"""Where modifiers stand in the stack, and moving them."""

from __future__ import annotations

import bpy

from . import modifier_places, node_group, spine_stack, stack


def armature_to_follow(ob: bpy.types.Object) -> bpy.types.ArmatureModifier | None:
    """The last Armature that is on, or the last one, wherever Turgor Volume stands."""
    armatures = [modifier for modifier in ob.modifiers if modifier.type == "ARMATURE"]
    return ([modifier for modifier in armatures if stack.is_on(modifier)] or armatures or [None])[-1]


def move_below_armature(
    ob: bpy.types.Object, ours: bpy.types.NodesModifier, armature: bpy.types.ArmatureModifier
) -> None:
    """Right after the Armature, or after the Turgor Spine that changes the skin of its bones. Raises PlaceError."""
    modifiers = list(ob.modifiers)
    end = armature
    if spine_stack.limb_modifier(ob) == armature:
        end = stack.own_modifier(ob, node_group.SPINE)
    _move(ob, modifiers.index(ours), modifiers.index(end))


def move_above(ob: bpy.types.Object, ours: bpy.types.Modifier, modifier: bpy.types.Modifier) -> None:
    """Move ours right above a modifier before it. Raises RuntimeError where Blender does not let it."""
    modifiers = list(ob.modifiers)
    if modifiers.index(modifier) < modifiers.index(ours):
        ob.modifiers.move(modifiers.index(ours), modifiers.index(modifier))


def move_after(ob: bpy.types.Object, modifier: bpy.types.Modifier, ours: bpy.types.Modifier) -> None:
    """Move a modifier right after ours; nothing happens where it stands later already. Raises PlaceError."""
    modifiers = list(ob.modifiers)
    if modifiers.index(modifier) < modifiers.index(ours):
        _move(ob, modifiers.index(modifier), modifiers.index(ours))


def move_below(ob: bpy.types.Object, ours: bpy.types.Modifier, later: bpy.types.Modifier) -> None:
    """Move ours right after a later modifier; nothing happens where it stands there already. Raises PlaceError."""
    modifiers = list(ob.modifiers)
    if modifiers.index(ours) < modifiers.index(later):
        _move(ob, modifiers.index(ours), modifiers.index(later))


def _move(ob: bpy.types.Object, place: int, before: int) -> None:
    """Move the modifier at `place` to right after the one that stands at `before`."""
    modifier_places.put(ob, ob.modifiers[place], before if place < before else before + 1)
