"""Colours for what became of the flesh."""

from __future__ import annotations

import numpy as np

from ..enclosed_volume import Points

# Relative change of volume that is shown in full colour.
FULL_TONE = 0.25
LARGER, SMALLER, SAME = np.array((0.80, 0.16, 0.06)), np.array((0.08, 0.24, 0.66)), np.array((0.66, 0.62, 0.56))


def tones(changes: Points) -> Points:
    """(K, 3) colours of relative changes (K,): red what grew, blue what shrank, pale what kept its volume."""
    shares = np.clip(changes / FULL_TONE, -1.0, 1.0)[:, None]
    return SAME + np.maximum(shares, 0.0) * (LARGER - SAME) + np.maximum(-shares, 0.0) * (SMALLER - SAME)
