"""Vertex groups -> blend weights of bones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class BoneWeights(NamedTuple):
    """W influences of N vertices, stored order kept."""

    offsets: NDArray[np.int32]  # (N + 1,)
    bones: NDArray[np.int32]  # (W,)
    weights: NDArray[np.float32]  # (W,)


def bone_weights(
    offsets: NDArray[np.int32],
    groups: NDArray[np.int32],
    weights: NDArray[np.float32],
    group_names: Sequence[str],
    bone_indices: Mapping[str, int],
) -> BoneWeights:
    """Only groups that name a deform bone count."""
    bone_of_group = np.array([bone_indices.get(name, -1) for name in group_names] + [-1], np.int32)
    # A weight may name a group that was deleted.
    bones = bone_of_group[np.minimum(groups, len(group_names))]
    is_kept = bones >= 0
    kept_before = np.concatenate([[0], np.cumsum(is_kept)]).astype(np.int32)
    return BoneWeights(kept_before[offsets], bones[is_kept], weights[is_kept])


def of_bones(weights: BoneWeights, is_kept: NDArray[np.bool_]) -> BoneWeights:
    """Only influences of some bones. is_kept: (B,)."""
    kept = is_kept[weights.bones] if len(is_kept) else np.zeros(0, bool)
    kept_before = np.concatenate([[0], np.cumsum(kept)]).astype(np.int32)
    return BoneWeights(kept_before[weights.offsets], weights.bones[kept], weights.weights[kept])


def sums(weights: BoneWeights) -> NDArray[np.float64]:
    """(N,) of each vertex."""
    total = np.concatenate([[0.0], np.cumsum(weights.weights, dtype=np.float64)])
    return total[weights.offsets[1:]] - total[weights.offsets[:-1]]


# Blender leaves vertices alone whose weights sum to less.
LEAST_SUM = 1e-4


def unweighted_count(weights: BoneWeights, mask: NDArray[np.float32] | None) -> int:
    """Vertices that no bone holds, among those on which the Armature acts. mask: (N,) its vertex group."""
    is_free = sums(weights) <= LEAST_SUM
    return int((is_free if mask is None else is_free & (mask > 0.0)).sum())


def vertex_mask(
    offsets: NDArray[np.int32],
    groups: NDArray[np.int32],
    weights: NDArray[np.float32],
    group: int,
    is_inverted: bool,
) -> NDArray[np.float32]:
    """(N,) influence by one vertex group; vertices outside have none, or all when inverted."""
    vertices = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    mask = np.zeros(len(offsets) - 1, np.float32)
    is_member = groups == group
    mask[vertices[is_member]] = weights[is_member]
    return 1.0 - mask if is_inverted else mask


def effect_mask(
    group: NDArray[np.float32] | None, is_inverted: bool, pin_group: NDArray[np.float32] | None
) -> NDArray[np.float32] | None:
    """(N,) how much of what it would move each vertex moves, 0 to 1; None where nothing masks.

    group: (N,) weights of the group where volume may come back; pin_group: (N,) of vertices that stay as skinned.
    """
    if group is None and pin_group is None:
        return None
    mask = np.ones_like(pin_group) if group is None else 1.0 - group if is_inverted else group
    if pin_group is not None:
        mask = mask * (1.0 - pin_group)
    return np.clip(mask, 0.0, 1.0)
