"""Which objects of the file a command is about."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import bpy

from .. import runtime
from ..scene import spine_stack, stack
from ..states import AnyState
from .outcome import CommandError


class Subject(NamedTuple):
    """An object, and the state of one of its modifiers of ours."""

    object: bpy.types.Object
    modifier: str  # VOLUME or SPINE
    state: AnyState


def objects_with_turgor(names: Sequence[str]) -> list[bpy.types.Object]:
    """Objects with a modifier of ours, sorted by name: those named, or all of the file.

    Raises CommandError for a name whose object has neither modifier.
    """
    found = sorted((ob for ob in bpy.data.objects if has_turgor(ob)), key=lambda ob: (ob.name, ob.library is not None))
    if not names:
        return found
    chosen = [ob for ob in found if ob.name in names]
    missing = [name for name in names if name not in {ob.name for ob in chosen}]
    if missing:
        there = ", ".join(ob.name for ob in found) or "none"
        raise CommandError(f"Not an object with Turgor: {', '.join(missing)}; the file has {there}")
    return chosen


def has_turgor(ob: bpy.types.Object) -> bool:
    """Whether it has a modifier of ours."""
    return ob.type == "MESH" and (stack.volume_modifier(ob) is not None or spine_stack.spine_modifier(ob) is not None)


def baked_copies() -> list[tuple[bpy.types.Object, bpy.types.Object]]:
    """Copies that carry a bake, each with its character, by name."""
    copies = [ob for ob in bpy.data.objects if ob.turgor_bake.other is not None and not has_turgor(ob)]
    return [(copy, copy.turgor_bake.other) for copy in sorted(copies, key=lambda copy: copy.name)]


def subjects_of(ob: bpy.types.Object) -> list[Subject]:
    """One for each modifier of ours, in the order of the stack."""
    found = []
    if spine_stack.spine_modifier(ob) is not None:
        found.append(Subject(ob, "SPINE", runtime.spine(ob.session_uid)))
    if stack.volume_modifier(ob) is not None:
        found.append(Subject(ob, "VOLUME", runtime.character(ob.session_uid)))
    return found
