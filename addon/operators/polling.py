"""Why an operator is grey: reasons that several of them have, and how the artist reads them."""

from __future__ import annotations

import bpy

from ..live.binding_rules import is_editable
from ..messages import message
from ..scene import stack


def is_allowed(operator: type[bpy.types.Operator], reason: str | None) -> bool:
    """Whether there is no reason against it; else the reason is shown beside its tooltip."""
    if reason is not None:
        operator.poll_message_set(reason)
    return reason is None


def in_edit_mode(mode: str) -> str | None:
    """A reason where neither object nor pose mode is on. mode: of the context, or of the object."""
    return None if mode in {"OBJECT", "POSE"} else message("Leave the edit or paint mode first")


def linked(ob: bpy.types.Object) -> str | None:
    """A reason where the object is linked: what is written to it would be lost."""
    return None if is_editable(ob) else message("The object is linked: make a library override first")


def linked_mesh(ob: bpy.types.Object, reason: str) -> str | None:
    """`reason` where the object's mesh is linked from another file."""
    return None if ob.data.library is None else reason


def hidden(ob: bpy.types.Object) -> str | None:
    """A reason where the object is hidden: Blender lets nobody edit or paint it."""
    return None if ob.visible_get() else message("The object is hidden: show it first")


def without_volume(ob: bpy.types.Object | None) -> str | None:
    """A reason where there is no mesh with Turgor Volume."""
    has_volume = ob is not None and ob.type == "MESH" and stack.volume_modifier(ob) is not None
    return None if has_volume else message("The active object has no Turgor Volume")


def without_own_volume(ob: bpy.types.Object | None) -> str | None:
    """A reason where there is no mesh with Turgor Volume whose settings can be saved."""
    is_own = ob is not None and is_editable(ob) and without_volume(ob) is None
    return None if is_own else message("The active object has no Turgor Volume of its own")
