"""Fewer keys, each of which moves the skin around one joint only.

The displacements are cut into smooth regions whose shares sum to 1, and each region is reduced on its own. What it may
miss at a vertex follows from its share there, so that all together miss no more than the error asked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import reduction
from .joint_regions import Region
from .reduction import Samples

# Vertices that skinning shrinks further than this count as if it did not.
LEAST_GROWTH = 1e-3


class LocalKeys(NamedTuple):
    """K keys of a region of n vertices; displacement of frame f there = values[f] @ keys, summed over all regions."""

    region: Region
    keys: NDArray[np.float32]  # (K, n, 3)
    values: NDArray[np.float64]  # (F, K) as large as 1


def reduce(
    samples: Samples, regions: Sequence[Region], tolerance: float, growth: NDArray[np.float64]
) -> Iterator[LocalKeys]:
    """Region by region, as many keys as keep `tolerance` once all regions are summed. growth: as in `reduction.reduce`.

    A larger tolerance never takes more keys; the same samples give the same bits.
    """
    # A region's part of the error: the root of its share, over the sum of all roots.
    roots = np.zeros(len(growth))
    for region in regions:
        roots[region.vertices] += np.sqrt(region.shares)
    for region in regions:
        at = region.vertices
        root = np.sqrt(region.shares)
        counted = np.maximum(growth[at], LEAST_GROWTH) * root * roots[at]
        parts = [(part[:, at] * counted[None, :, None]).astype(np.float32) for part in samples]
        found = reduction.reduce(parts, tolerance)
        keys = (found.keys * (region.shares / counted)[None, :, None]).astype(np.float32)
        yield LocalKeys(region, keys, found.values)


def within_unit(found: LocalKeys) -> LocalKeys:
    """Equal displacements with values from 0 to 1: a key that goes both ways becomes two, one for each way."""
    columns, keys = [], []
    for key, values in zip(found.keys, found.values.T, strict=True):
        for sign in (1.0, -1.0):
            one_way = np.maximum(sign * values, 0.0)
            if one_way.any():
                columns.append(one_way)
                keys.append(key * np.float32(sign))
    shape = (len(keys), *found.keys.shape[1:])
    values = np.array(columns, np.float64).reshape(len(columns), len(found.values)).T
    return LocalKeys(found.region, np.array(keys, np.float32).reshape(shape), values)
