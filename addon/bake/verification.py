"""The baked copy, evaluated by Blender, beside the live result."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import turgor
from numpy.typing import NDArray

from ..logic.bake_report import FrameError
from ..scene import baked_copy
from .baking import MADE, Baking, Progress

# Frames of one slice.
FRAMES_PER_SLICE = 16


def verify(baking: Baking) -> Iterator[Progress]:
    """Adds the error of every frame to the report."""
    copy, read = baking.copy, baking.source.rest
    assert copy is not None
    mesh = turgor.Mesh(read.positions, read.face_offsets, read.face_corners)
    frames = baking.options.frames
    live = (positions for chunk in baking.chunks for positions in chunk)
    for start in range(0, len(frames), FRAMES_PER_SLICE):
        with baked_copy.watched(copy, baking.last) as sampler:
            for number in frames[start : start + FRAMES_PER_SLICE]:
                error = _error(mesh, float(number), sampler.positions(float(number)), next(live), baking.size)
                baking.report.errors.append(error)
        done = min(start + FRAMES_PER_SLICE, len(frames))
        yield Progress(MADE + (1.0 - MADE) * done / len(frames), f"Verified {done} of {len(frames)} frames")


def _error(
    mesh: turgor.Mesh, number: float, baked: NDArray[np.float32], live: NDArray[np.float32], size: float
) -> FrameError:
    distances = np.linalg.norm(baked.astype(np.float64) - live, axis=1)
    longest = float(distances.max(initial=0.0))
    before, after = (float(np.abs(mesh.component_volumes(each)).sum()) for each in (live, baked))
    return FrameError(
        number,
        longest,
        float(np.sqrt(np.mean(distances**2))) if len(distances) else 0.0,
        longest / size if size else 0.0,
        after / before - 1.0 if before else 0.0,
    )
