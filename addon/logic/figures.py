"""The engine's report of a frame -> percentages for the artist."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray


class FrameFigures(NamedTuple):
    """Deviations in percent of the volume at full strength; per joint, in percent of the rest volume."""

    corrected_deviation: float
    skinned_deviation: float
    lost: list[float]  # (J,)
    regained: list[float]  # (J,)
    is_capped: list[bool]  # (J,)


def frame_figures(
    report: turgor.Report, rest_volume: float, strengths: NDArray[np.float64], target_scale: float
) -> FrameFigures:
    """Components count by the size of their volume, so that faces looking inwards do not cancel others.

    strengths: (J,) per joint of the report. A joint below full strength lowers the engine's target by what it keeps;
    the artist is shown how much is missing.
    """
    kept = float(((1.0 - strengths) * report.joint_losses).sum()) * target_scale
    target = np.abs(report.target_volumes).sum() + kept
    percent = 100.0 / rest_volume if rest_volume > 0.0 else 0.0
    return FrameFigures(
        _deviation(np.abs(report.corrected_volumes).sum(), target),
        _deviation(np.abs(report.skinned_volumes).sum(), target),
        (report.joint_losses * percent).tolist(),
        (report.joint_regained * percent).tolist(),
        report.joint_is_capped.tolist(),
    )


def _deviation(volume: float, target: float) -> float:
    return 100.0 * float(volume - target) / float(target) if target > 0.0 else 0.0
