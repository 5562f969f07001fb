"""Which frames of a bake are compared with the live character where not all are: those that are likely to be worst."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Frames that are compared where not all are asked for.
MOST_FRAMES = 24
# Of them, for frames at which a joint is worst; the others are spread.
MOST_WORST = 16


def compared(frame_count: int, losses: NDArray[np.floating] | None = None, most: int = MOST_FRAMES) -> NDArray[np.intp]:
    """Rising indices of at most `most` of so many frames, all of them where there are no more; 0 for all.

    losses: (F, J) of volume by joint, signed. Among the frames are the first, the last, and of each joint the one at
    which it loses or gains most, the worst joints first; the others are spread as evenly as numbers go.
    """
    if most <= 0 or frame_count <= most:
        return np.arange(frame_count)
    chosen = list(dict.fromkeys((0, frame_count - 1)))[:most]
    if losses is not None and losses.size:
        sizes = np.nan_to_num(np.abs(losses))
        for joint in np.argsort(-sizes.max(axis=0), kind="stable"):
            worst = int(sizes[:, joint].argmax())
            if len(chosen) < min(most, 2 + MOST_WORST) and worst not in chosen:
                chosen.append(worst)
    while len(chosen) < most:
        # The middle of the widest gap.
        known = np.sort(chosen)
        widest = int(np.diff(known).argmax())
        chosen.append(int(known[widest] + known[widest + 1]) // 2)
    return np.sort(chosen)
