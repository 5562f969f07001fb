"""Which joint each row of a skeleton is of."""

from __future__ import annotations

from collections.abc import Sequence

from ..properties.joint_names import bend_of
from ..scene.skeleton import RestBones


def of_region(bones: RestBones, row: int) -> str:
    """Name of the joint at the head of a row's bone or node."""
    return bones.names[row] if row < len(bones.names) else bend_of(bones.names[bones.bone_of(row)])


def of_rows(bones: RestBones, rows: Sequence[int]) -> tuple[str, ...]:
    """Of rows with a joint, parents first: the first of a bone is the joint at its head, the others are its bend."""
    seen: set[int] = set()
    names = []
    for row in rows:
        bone = bones.bone_of(row)
        names.append(bend_of(bones.names[bone]) if bone in seen else bones.names[bone])
        seen.add(bone)
    return tuple(names)


def rows_of(bones: RestBones, rows: Sequence[int], *, but_bones: bool = False) -> dict[str, list[int]]:
    """By name, the rows of each joint; of bones without one, unless they are left out, their own."""
    found: dict[str, list[int]] = {}
    for row, name in zip(rows, of_rows(bones, rows), strict=True):
        found.setdefault(name, []).append(row)
    return found if but_bones else {name: [row] for row, name in enumerate(bones.names)} | found
