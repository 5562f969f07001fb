"""Where Blender lets a modifier of ours stand, and putting it there or saying why not."""

from __future__ import annotations

import bpy

from ..messages import Message, message

# They read the mesh as it is stored: Blender lets nothing but deformers stand before them, and so none of ours.
STORED_MESH_TYPES = frozenset({"MULTIRES", "SOFT_BODY"})


class PlaceError(ValueError):
    """Blender does not let the modifier stand there, and what to do."""


def refusal(ob: bpy.types.Object, place: int, label: str) -> Message | None:
    """Why no modifier of ours, called `label`, can stand at `place` of the stack; None where it can."""
    for modifier in list(ob.modifiers)[place:]:
        if modifier.type == "MULTIRES":
            return message(
                "Blender lets {ours} stand only below {modifier}, which needs the mesh as it is stored: move {modifier}"
                " above the Armature, or apply it",
                ours=label,
                modifier=modifier.name,
            )
        if modifier.type in STORED_MESH_TYPES:
            return message(
                "Blender lets {ours} stand only below {modifier}, which needs the mesh as it is stored: remove"
                " {modifier}, or simulate a copy of the mesh",
                ours=label,
                modifier=modifier.name,
            )
    return None


def put(ob: bpy.types.Object, modifier: bpy.types.Modifier, place: int) -> None:
    """Move `modifier` to `place`, counted with it taken out. Raises PlaceError; then it stays where it was.

    Modifiers that are pinned to the end of the stack have only pinned ones after them: after such a one ours is pinned.
    """
    name, others = modifier.name, [each for each in ob.modifiers if each != modifier]
    before, was_pinned = list(ob.modifiers).index(modifier), modifier.use_pin_to_last
    if place and others[place - 1].use_pin_to_last:
        modifier.use_pin_to_last = True
    told = ""
    try:
        ob.modifiers.move(ob.modifiers.find(name), place)
    except RuntimeError as error:
        told = str(error).removeprefix("Error:").strip()
    if not told and ob.modifiers.find(name) == place:
        return
    if modifier.use_pin_to_last != was_pinned:
        modifier.use_pin_to_last = was_pinned
    if ob.modifiers.find(name) != before:
        ob.modifiers.move(ob.modifiers.find(name), before)
    raise PlaceError(_why(ob, modifier, place, told))


def _why(ob: bpy.types.Object, modifier: bpy.types.Modifier, place: int, told: str) -> Message:
    why = refusal(ob, place, modifier.name) if modifier.type == "NODES" else None
    if why is not None:
        return why
    if told:
        return message("Blender does not let {modifier} stand there: {reason}", modifier=modifier.name, reason=told)
    return message("Blender does not let {modifier} stand there: move it by hand", modifier=modifier.name)
