"""Why a fix cannot be applied: linked data is not ours to change."""

from __future__ import annotations

import bpy

from ..scene import stack

MESH_FIXES = frozenset({"SELECT_OPEN_EDGES", "SELECT_NON_MANIFOLD", "SELECT_UNWEIGHTED", "RECALCULATE_OUTSIDE"})
OWN_MOVES = frozenset({"MOVE_BELOW_ARMATURE", "MOVE_ABOVE"})
MOVING_FIXES = OWN_MOVES | {"MOVE_AFTER"}


def refusal(target: bpy.types.Object, fix: str, subject: str) -> str:
    """Empty where the fix can be applied. fix: of `properties.fixes`; subject: what it changes."""
    if target.library is not None:
        return "The object is linked: make a library override first"
    if fix in MESH_FIXES and target.data.library is not None:
        return "The mesh is linked: change it in its own file"
    if fix == "NO_ENVELOPE_MULTIPLY":
        armature = target.modifiers.get(subject)
        if armature is not None and armature.object is not None and armature.object.data.library is not None:
            return "The armature is linked: change it in its own file"
    if fix in MOVING_FIXES and target.override_library is not None:
        moved = stack.volume_modifier(target) if fix in OWN_MOVES else target.modifiers.get(subject)
        if moved is not None and moved.is_override_data:
            return "The modifier comes from the library: move it there"
    return ""
