"""What the shells of a mesh are like, as the artist should know them: open, inside out, without an inside."""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray


class Shells(NamedTuple):
    """Counts of shells, unless said otherwise."""

    sound: int  # corrected
    open: int  # of these closed in thought
    open_edges: int  # edges around their openings
    inverted: int  # sound, faces look inwards, and no cavity of another shell
    mixed: int  # sound, but some faces look the other way than most
    unsound: Counter[str]  # by status of `turgor.Component`: stay as skinned


def describe(mesh: turgor.Mesh) -> Shells:
    """Count the shells of a bound mesh by what they are like."""
    parts = mesh.components
    sound = [part for part in parts if part.is_sound]
    open_ones = [part for part in sound if part.status == "capped"]
    is_inverted = np.array([part.is_sound and part.rest_volume < 0.0 for part in parts], bool)
    return Shells(
        len(sound),
        len(open_ones),
        sum(part.boundary_edge_count for part in open_ones),
        int((is_inverted & ~_cavities(mesh, is_inverted)).sum()),
        sum(part.flipped_face_count > 0 for part in sound),
        Counter(part.status for part in parts if not part.is_sound),
    )


def _cavities(mesh: turgor.Mesh, is_inverted: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(K,) inverted shells whose box lies in that of a shell that looks outwards: a hollow, a mouth."""
    if not is_inverted.any():
        return is_inverted
    low, high = boxes(mesh.rest_positions, mesh.vertex_components, len(is_inverted))
    looks_out = np.array([part.is_sound and part.rest_volume > 0.0 for part in mesh.components], bool)
    found = np.zeros_like(is_inverted)
    for shell in np.flatnonzero(is_inverted):
        holds = (low <= low[shell]).all(1) & (high >= high[shell]).all(1)
        found[shell] = (holds & looks_out).any()
    return found


def boxes(
    positions: NDArray[np.float64], shells: NDArray[np.int32], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(K, 3) least and greatest coordinates of each shell. shells: (N,) which one, -1 for none."""
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    order = np.argsort(shells, kind="stable")
    order = order[np.searchsorted(shells[order], 0) :]
    if len(order):
        found, starts = np.unique(shells[order], return_index=True)
        low[found] = np.minimum.reduceat(positions[order], starts)
        high[found] = np.maximum.reduceat(positions[order], starts)
    return low, high
