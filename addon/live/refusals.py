"""Why a fix cannot be applied: linked data is not ours to change."""

from __future__ import annotations

import bpy

from ..scene import stack

MESH_FIXES = frozenset({"SELECT_OPEN_EDGES", "SELECT_NON_MANIFOLD", "SELECT_UNWEIGHTED", "RECALCULATE_OUTSIDE"})
# Fixes that lead into Edit Mode.
EDIT_FIXES = MESH_FIXES - {"RECALCULATE_OUTSIDE"}
# Fixes that move our modifier, and those that move another.
OWN_MOVES = frozenset({"MOVE_BELOW_ARMATURE", "MOVE_BELOW", "MOVE_ABOVE"})
MOVING_FIXES = OWN_MOVES | {"MOVE_AFTER"}


def refusal(target: bpy.types.Object, fix: str, subject: str) -> str:
    """Empty where the fix can be applied. fix: of `properties.fixes`; subject: what it changes, one name per line."""
    if target.library is not None:
        return "The object is linked: make a library override first"
    if fix in MESH_FIXES and target.data.library is not None:
        return "The mesh is linked: change it in its own file"
    if fix in EDIT_FIXES and not target.visible_get():
        return "The object is hidden: show it first"
    if fix in MOVING_FIXES and target.override_library is not None:
        named = [target.modifiers.get(name) for name in subject.splitlines()]
        moved = named if fix == "MOVE_AFTER" else [stack.volume_modifier(target)]
        if any(each is not None and each.is_override_data for each in moved):
            return "The modifier comes from the library: move it there"
    return ""
