"""The skin around each joint: smooth shares of every vertex, 1 in sum, none beyond the bones that meet at the joint.

A vertex belongs to the ends of the bones that hold it, by its weights, and of one bone's ends to the nearer ones.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .weights import LEAST_SUM, BoneWeights, sums

# An end of a bone that is so many times as far away as the nearest has no share.
FAR = 4.0
# Stands for vertices that no bone holds.
NO_BONE = -1


class Region(NamedTuple):
    """n vertices around the joint at the head of `bone`, or held by none."""

    bone: int
    vertices: NDArray[np.intp]  # (n,) rising
    shares: NDArray[np.float64]  # (n,) above 0, at most 1


def regions(
    positions: NDArray[np.floating],
    weights: BoneWeights,
    parents: NDArray[np.int32],
    heads: NDArray[np.float64],
) -> list[Region]:
    """By the numbers of their bones. positions: (N, 3) at rest, heads: (B, 3) in the same space, parents: (B,)."""
    count, total = len(positions), sums(weights)
    rows = np.repeat(np.arange(count), np.diff(weights.offsets))
    parts = weights.weights / np.where(total > LEAST_SUM, total, np.inf)[rows]
    ends = _ends(np.bincount(weights.bones, parts, len(parents)) > 0.0, parents)
    of_joint: dict[int, NDArray[np.float64]] = {}
    for bone, joints in ends.items():
        is_own = weights.bones == bone
        vertices = rows[is_own]
        nearness = _nearness(positions[vertices], heads[joints]) * parts[is_own][:, None]
        for joint, column in zip(joints, nearness.T, strict=True):
            known = of_joint.setdefault(joint, np.zeros(count))
            np.add.at(known, vertices, column)
    if (total <= LEAST_SUM).any():
        of_joint[NO_BONE] = (total <= LEAST_SUM).astype(np.float64)
    whole = np.sum(list(of_joint.values()), axis=0) if of_joint else np.ones(count)
    found = []
    for bone, shares in sorted(of_joint.items()):
        vertices = np.flatnonzero(shares)
        found.append(Region(bone, vertices, shares[vertices] / whole[vertices]))
    return found


def _ends(is_holding: NDArray[np.bool_], parents: NDArray[np.int32]) -> dict[int, list[int]]:
    """By bone that holds skin: the joints at its ends, each named by the bone that it is the head of."""
    found: dict[int, list[int]] = {bone: [] for bone in np.flatnonzero(is_holding).tolist()}
    for bone in found:
        above = int(parents[bone])
        while above >= 0 and not is_holding[above]:
            above = int(parents[above])
        if above >= 0:
            found[bone].append(bone)
            found[above].append(bone)
    # A bone alone turns about its head.
    return {bone: sorted(joints) or [bone] for bone, joints in found.items()}


def _nearness(points: NDArray[np.floating], ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, m) share of each end, 1 in sum."""
    distances = np.linalg.norm(points[:, None, :] - ends[None], axis=2)
    nearest = distances.min(axis=1, keepdims=True)
    near = np.divide(nearest, distances, out=np.ones_like(distances), where=distances > 0.0)
    shares = np.maximum((FAR * near - 1.0) / (FAR - 1.0), 0.0) ** 2
    return shares / shares.sum(axis=1, keepdims=True)
