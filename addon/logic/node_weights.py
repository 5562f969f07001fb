"""Weights of bendy bones -> weights of their nodes: hats over the length of the bone, in stored order."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .weights import BoneWeights


class NodeWeights(NamedTuple):
    """W influences of N vertices, stored order kept."""

    offsets: NDArray[np.int32]  # (N + 1,)
    bones: NDArray[np.int32]  # (W,)
    nodes: NDArray[np.int32]  # (W,) 0 of bones that do not bend
    weights: NDArray[np.float32]  # (W,)

    def used_nodes(self, bone: int) -> list[int]:
        """Nodes of a bone that hold skin, rising."""
        return np.unique(self.nodes[(self.bones == bone) & (self.weights != 0.0)]).tolist()

    def on_rows(self, rows: NDArray[np.int64]) -> BoneWeights:
        """On the rows of a skeleton. rows: (B, S + 1), of each node of each bone."""
        return BoneWeights(self.offsets, rows[self.bones, self.nodes].astype(np.int32), self.weights)


def split(weights: BoneWeights, coordinates: NDArray[np.float64], segments: NDArray[np.int32]) -> NodeWeights:
    """Blend each influence of a bone that bends between two nodes.

    coordinates: (W,) where the vertex lies along the bone of each influence, i at node i. segments: (B,) of each bone,
    1 where it does not bend.
    """
    most = segments[weights.bones]
    is_bent = most > 1
    first = np.minimum(np.floor(np.where(is_bent, coordinates, 0.0)), most - 1).astype(np.int32)
    part = np.where(is_bent, coordinates - first, 0.0)
    halves = np.stack([weights.weights * (1.0 - part), weights.weights * part], axis=1).astype(np.float32)
    halves[~is_bent, 0] = weights.weights[~is_bent]
    nodes = np.stack([first, first + 1], axis=1)
    # Blender leaves influences of nothing out; those of plain bones are kept as they are stored.
    is_kept = halves != 0.0
    is_kept[~is_bent] = True, False
    kept_before = np.concatenate([[0], np.cumsum(is_kept.sum(axis=1))]).astype(np.int32)
    return NodeWeights(
        kept_before[weights.offsets],
        np.repeat(weights.bones, is_kept.sum(axis=1)),
        nodes[is_kept].astype(np.int32),
        halves[is_kept],
    )
