"""Weights by bone envelopes, as Blender's Armature modifier takes them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .weights import BoneWeights


def factors(
    points: NDArray[np.float64],
    heads: NDArray[np.float64],
    tails: NDArray[np.float64],
    head_radii: NDArray[np.float64],
    tail_radii: NDArray[np.float64],
    distances: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(n,) 1 within the radius of each point's bone, falling to 0 over the distance beyond; arguments per point."""
    along = tails - heads
    lengths = np.linalg.norm(along, axis=-1)
    directions = np.divide(along, lengths[..., None], out=np.zeros_like(along), where=lengths[..., None] > 0.0)
    places = np.einsum("...i,...i->...", points - heads, directions)
    parts = np.clip(np.divide(places, lengths, out=np.zeros_like(places), where=lengths > 0.0), 0.0, 1.0)
    radii = (1.0 - parts) * head_radii + parts * tail_radii
    beyond = np.linalg.norm(points - heads - parts[..., None] * along, axis=-1) - radii
    is_within = beyond < 0.0
    fall = np.divide(beyond, distances, out=np.ones_like(beyond), where=distances > 0.0)
    return np.where(is_within, 1.0, np.where(fall >= 1.0, 0.0, 1.0 - fall * fall))


def weigh(
    weights: BoneWeights,
    is_free: NDArray[np.bool_],
    factors_of: NDArray[np.float64],
    is_multiplied: NDArray[np.bool_],
    envelope_weights: NDArray[np.float64],
) -> BoneWeights:
    """Weights of groups multiplied where their bone says so; of free vertices those of the envelopes, in bones' order.

    is_free: (N,) vertices that no group gives to a bone, and that envelopes may hold. factors_of: (N, B) `factors` of
    all bones, 0 for those that do not deform. envelope_weights, is_multiplied: (B,).
    """
    vertices = np.repeat(np.arange(len(is_free)), np.diff(weights.offsets))
    grown = np.where(is_multiplied[weights.bones], factors_of[vertices, weights.bones], 1.0)
    scaled = np.where(grown == 1.0, weights.weights, (weights.weights * grown).astype(np.float32))
    held = np.where(is_free[:, None], factors_of * envelope_weights, 0.0)
    rows, bones = np.nonzero(held > 0.0)
    all_rows = np.concatenate([vertices, rows])
    order = np.argsort(all_rows, kind="stable")
    offsets = np.zeros(len(is_free) + 1, np.int32)
    np.cumsum(np.bincount(all_rows, minlength=len(is_free)), out=offsets[1:])
    return BoneWeights(
        offsets,
        np.concatenate([weights.bones, bones.astype(np.int32)])[order],
        np.concatenate([scaled, held[rows, bones].astype(np.float32)])[order],
    )
