"""The engine's report of a frame -> percentages for the artist."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from .character_figures import JointFigures


class FrameFigures(NamedTuple):
    """Deviations in percent of the volume at full strength; per joint, in percent of the rest volume."""

    corrected_deviation: float
    skinned_deviation: float
    shown_deviation: float | None  # of what is measured
    lost: list[float]  # (J,)
    regained: list[float]  # (J,)
    is_capped: list[bool]  # (J,)
    target_volume: float  # at full strength


def frame_figures(
    report: turgor.Report,
    rest_volume: float,
    strengths: NDArray[np.float64],
    target_scale: float,
    shown_volumes: NDArray[np.float64] | None,
) -> FrameFigures:
    """Components count by the size of their volume, so that faces looking inwards do not cancel others.

    strengths: (J,) per joint of the report. A joint below full strength lowers the engine's target by what it keeps;
    the artist is shown how much is missing. shown_volumes: (K,) measured on the mesh that is shown, apart from the
    engine's solver; None where it cannot be measured.
    """
    kept = float(((1.0 - strengths) * report.joint_losses).sum()) * target_scale
    target = np.abs(report.target_volumes).sum() + kept
    percent = 100.0 / rest_volume if rest_volume > 0.0 else 0.0
    return FrameFigures(
        _deviation(np.abs(report.corrected_volumes).sum(), target),
        _deviation(np.abs(report.skinned_volumes).sum(), target),
        None if shown_volumes is None else _deviation(np.abs(shown_volumes).sum(), target),
        (report.joint_losses * percent).tolist(),
        (report.joint_regained * percent).tolist(),
        report.joint_is_capped.tolist(),
        float(target),
    )


def of_joints(found: FrameFigures, names: Sequence[str]) -> dict[str, JointFigures]:
    """By name; what several parts of one joint lose and get back is summed. names: (J,)."""
    joints: dict[str, JointFigures] = {}
    for name, lost, regained, is_capped in zip(names, found.lost, found.regained, found.is_capped, strict=True):
        known = joints.get(name, JointFigures(0.0, 0.0, False))
        joints[name] = JointFigures(known.lost + lost, known.regained + regained, known.is_capped or is_capped)
    return joints


def _deviation(volume: float, target: float) -> float:
    return 100.0 * float(volume - target) / float(target) if target > 0.0 else 0.0


class MotionFigures(NamedTuple):
    """Figures of F frames and J joints, in the units of `FrameFigures`."""

    corrected_deviations: NDArray[np.float64]  # (F,)
    skinned_deviations: NDArray[np.float64]  # (F,)
    lost: NDArray[np.float64]  # (F, J)
    targets: NDArray[np.float64]  # (F,) volumes at full strength


def motion_figures(
    measures: turgor.Measures | turgor.Report,
    rest_volume: float,
    strengths: NDArray[np.float64],
    target_scales: NDArray[np.float64],
) -> MotionFigures:
    """Figures from the engine's measures of F frames, or from a report as one frame. target_scales: (F,)."""
    kept = (np.atleast_2d(measures.joint_losses) * (1.0 - strengths)).sum(axis=1) * target_scales
    target = _sizes(measures.target_volumes) + kept
    percent = 100.0 / rest_volume if rest_volume > 0.0 else 0.0
    return MotionFigures(
        _deviations(_sizes(measures.corrected_volumes), target),
        _deviations(_sizes(measures.skinned_volumes), target),
        np.atleast_2d(measures.joint_losses) * percent,
        target,
    )


def _sizes(volumes: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.abs(np.atleast_2d(volumes)).sum(axis=1)


def _deviations(volumes: NDArray[np.float64], targets: NDArray[np.float64]) -> NDArray[np.float64]:
    return 100.0 * np.divide(volumes - targets, targets, out=np.zeros_like(targets), where=targets > 0.0)


def summed(rows: NDArray[np.float64], parts: Sequence[NDArray[np.intp]]) -> NDArray[np.float64]:
    """(F, J) of joints from (F, R) of their rows. parts: (J,) the rows of each."""
    return np.stack([rows[:, own].sum(axis=1) for own in parts], axis=1) if parts else np.zeros((len(rows), 0))


# The engine's measure of folding: losses are compared with this part of the joint's length cubed (MATH 4).
VICINITY_VOLUME = 0.1


def fold_losses(
    losses: NDArray[np.float64], lengths: NDArray[np.float64], object_from_armature: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(F, J) losses in the unit of the engine's `folded_loss_relative`; 0 where a joint has no extent.

    losses: object space. lengths: (J,), armature space.
    """
    sizes = np.abs(np.linalg.det(np.reshape(object_from_armature, (-1, 4, 4))[:, :3, :3]))
    found, vicinities = np.abs(np.atleast_2d(losses)), VICINITY_VOLUME * sizes[:, None] * lengths**3
    return np.divide(found, vicinities, out=np.zeros_like(found), where=vicinities > 0.0)
