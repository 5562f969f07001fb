"""What automatic weights become on a mesh: new weights of the chosen bones beside those that stay."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .weights import BoneWeights

# Less is rounding, not room for another bone.
LEAST_ROOM = 1e-6


class Choice(NamedTuple):
    """Which of B bones, and which of N vertices."""

    bones: NDArray[np.bool_]  # (B,) get new weights
    is_locked: NDArray[np.bool_]  # (B,) keep theirs
    vertices: NDArray[np.bool_]  # (N,)


def merged(found: BoneWeights, existing: BoneWeights, choice: Choice) -> BoneWeights:
    """Weights of the chosen vertices; rows of the others are empty.

    found: all bones' automatic weights, locked ones in them. Chosen bones get theirs, other bones share what is left in
    the proportions they have; where they have none, chosen ones take it, and where those have none either, the found
    weights of all bones stand.
    """
    bone_count = len(choice.bones)
    if choice.bones.all() and choice.vertices.all():
        return BoneWeights(found.offsets, found.bones, found.weights.astype(np.float32))
    new, old = (dense(weights, bone_count) for weights in (found, existing))
    is_chosen = choice.bones & ~choice.is_locked
    is_other = ~choice.bones & ~choice.is_locked
    if is_other.any():
        chosen, others = new[:, is_chosen].sum(axis=1), old[:, is_other].sum(axis=1)
        room = np.maximum(1.0 - new[:, choice.is_locked].sum(axis=1), 0.0)
        left = np.maximum(room - chosen, 0.0)
        keeps = others > 0.0
        shares = np.where(keeps, left / np.where(keeps, others, 1.0), 0.0)[:, None] * old[:, is_other]
        fills = ~keeps & (chosen > LEAST_ROOM)
        new[:, is_chosen] *= np.where(fills, room / np.where(fills, chosen, 1.0), 1.0)[:, None]
        new[:, is_other] = np.where((keeps | fills)[:, None], shares, new[:, is_other])
    new[~choice.vertices] = 0.0
    return sparse(new)


def as_on_body(
    found: BoneWeights, body: BoneWeights, places: NDArray[np.int32], is_locked: NDArray[np.bool_]
) -> BoneWeights:
    """Weights of vertices that are vertices of the body too: the body's, which modifiers made of this mesh.

    places: (N,) vertex of the body, -1 for none. Locked bones keep what the vertex has.
    """
    bone_count = len(is_locked)
    new, whole = dense(found, bone_count), dense(body, bone_count)
    is_there = places >= 0
    room = np.maximum(1.0 - new[:, is_locked].sum(axis=1), 0.0)
    new[np.ix_(is_there, ~is_locked)] = (room[:, None] * whole[places][:, ~is_locked])[is_there]
    return sparse(new)


def sparse(weights: NDArray[np.float64]) -> BoneWeights:
    """Weights by vertex, without zeros, from an array (N, B)."""
    vertices, bones = np.nonzero(weights)
    offsets = np.searchsorted(vertices, np.arange(len(weights) + 1)).astype(np.int32)
    return BoneWeights(offsets, bones.astype(np.int32), weights[vertices, bones].astype(np.float32))


def part(weights: BoneWeights, start: int, stop: int) -> BoneWeights:
    """The rows of some vertices."""
    first, last = weights.offsets[start], weights.offsets[stop]
    offsets = weights.offsets[start : stop + 1] - first
    return BoneWeights(offsets, weights.bones[first:last], weights.weights[first:last])


def joined(parts: list[BoneWeights]) -> BoneWeights:
    """The rows of several meshes, one after the other."""
    counts = np.concatenate([np.diff(rows.offsets) for rows in parts])
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    bones = np.concatenate([rows.bones for rows in parts])
    return BoneWeights(offsets, bones, np.concatenate([rows.weights for rows in parts]))


def dense(weights: BoneWeights, bone_count: int) -> NDArray[np.float64]:
    """(N, B); influences of one bone on a vertex add up."""
    count = len(weights.offsets) - 1
    vertices = np.repeat(np.arange(count), np.diff(weights.offsets))
    cells = vertices * bone_count + weights.bones
    sums = np.bincount(cells, weights.weights, count * bone_count).astype(np.float64, copy=False)
    return sums.reshape(count, bone_count)
