"""A coat of patches: cells about evenly spread seeds, with a light net between them."""

from __future__ import annotations

import numpy as np

SEED_DISTANCE = 0.27
NET = (0.02, 0.08)
"""Where a patch begins and where it has its full colour, by distance to the next patch minus distance to its own."""


def patch_strength(points: np.ndarray, coat: np.ndarray) -> np.ndarray:
    """0 between patches, 1 inside, by point (N, 3) in metres; seeds are chosen among the points of the coat."""
    seeds: list[np.ndarray] = []
    for point in points[coat]:
        if all(np.linalg.norm(point - seed) > SEED_DISTANCE for seed in seeds):
            seeds.append(point)
    distances = np.sort(np.linalg.norm(points[:, None] - np.array(seeds), axis=2), axis=1)
    return np.clip((distances[:, 1] - distances[:, 0] - NET[0]) / (NET[1] - NET[0]), 0.0, 1.0)
