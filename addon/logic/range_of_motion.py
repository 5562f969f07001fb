"""A test range of motion: poses that turn each joint about and across its bone, for rigs that nobody has animated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

# Radians, of each bend and each twist: about as far as most joints of a body go.
ANGLE = np.pi / 3
# Along the bone (a twist) last: bends cost most volume.
AXES = (0, 2, 1)
TURNS_PER_JOINT = 2 * len(AXES)


def poses(
    parents: Sequence[int],
    rest_matrices: NDArray[np.float64],
    joints: Sequence[Sequence[int]],
    group_count: int | None = None,
) -> NDArray[np.float32]:
    """(TURNS_PER_JOINT * groups, B, 4, 4) pose @ inverse(rest) of all bones, armature space.

    joints: (J,) each the bones that turn about their heads and share the angle; their descendants follow. group_count:
    so many joints at a time turn alone, J by default; with fewer groups joints that are far from each other in the
    order turn in the same poses.
    """
    groups = max(min(len(joints) if group_count is None else group_count, len(joints)), 0)
    found = np.empty((TURNS_PER_JOINT * groups, len(parents), 4, 4))
    turns = [(axis, sign * ANGLE) for axis in AXES for sign in (1.0, -1.0)]
    for group in range(groups):
        turning = {bone: 1.0 / len(bones) for bones in joints[group::groups] for bone in bones}
        for number, (axis, angle) in enumerate(turns):
            _pose(found[TURNS_PER_JOINT * group + number], parents, rest_matrices, turning, axis, angle)
    return found.astype(np.float32)


def all_bent(parents: Sequence[int], rest_matrices: NDArray[np.float64], joints: Sequence[int]) -> NDArray[np.float32]:
    """(1, B, 4, 4) the first of `poses` in one group."""
    found = np.empty((1, len(parents), 4, 4))
    _pose(found[0], parents, rest_matrices, dict.fromkeys(joints, 1.0), AXES[0], ANGLE)
    return found.astype(np.float32)


def _pose(
    into: NDArray[np.float64],
    parents: Sequence[int],
    rest_matrices: NDArray[np.float64],
    turning: Mapping[int, float],
    axis: int,
    angle: float,
) -> None:
    for bone in _parents_first(parents):
        above = np.eye(4) if parents[bone] < 0 else into[parents[bone]]
        part = turning.get(bone)
        into[bone] = above if part is None else above @ _turn(rest_matrices[bone], axis, part * angle)


def _parents_first(parents: Sequence[int]) -> list[int]:
    """All bones, each after its parent, else in their order."""
    order: list[int] = []
    is_done = [False] * len(parents)
    for bone in range(len(parents)):
        way = []
        while bone >= 0 and not is_done[bone]:
            is_done[bone] = True
            way.append(bone)
            bone = parents[bone]
        order += reversed(way)
    return order


def _turn(rest_matrix: NDArray[np.float64], axis: int, angle: float) -> NDArray[np.float64]:
    """(4, 4) rotation about an axis of the bone through its head, in armature space (Rodrigues)."""
    direction = rest_matrix[:3, axis] / np.linalg.norm(rest_matrix[:3, axis])
    x, y, z = direction
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(4)
    turn[:3, :3] += np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across
    head = rest_matrix[:3, 3]
    turn[:3, 3] = head - turn[:3, :3] @ head
    return turn
