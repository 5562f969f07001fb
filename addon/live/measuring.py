"""Measuring a character over a motion: which joints lose volume, and how much. On the main thread only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..logic import figures
from ..logic.character_figures import Motion
from ..states import VolumeBinding
from . import sampling
from .binding_rules import is_editable
from .sampling import Sample


def measure(
    target: bpy.types.Object,
    frames: Sequence[float],
    *,
    tell: Callable[[int], None] = lambda done: None,
    use_test_motion: bool = True,
) -> Motion:
    """Measure a character at these frames; keep figures for a graph and the largest loss of each joint.

    tell: is told how many frames are done.

    use_test_motion: where nothing moves in these frames, a test range of motion is measured instead.

    Raises ValueError where the character is not bound or a frame cannot be read.
    """
    bound = sampling.bound(target)
    numbers = np.asarray(frames, np.float64)
    samples = sampling.Watched(sampling.samples(target, bound, frames, tell))
    found = _motion(bound, samples, numbers)
    if use_test_motion and not samples.has_moved:
        found = _motion(bound, sampling.turned(target, bound), None)
    runtime.character(target.session_uid).motion = found
    if is_editable(target):
        peaks = np.abs(found.joint_losses).max(axis=0, initial=0.0)
        for name, peak in zip(found.joint_names, peaks.tolist(), strict=True):
            target.turgor.joints[name].peak_loss = peak
    return found


def _motion(bound: VolumeBinding, samples: Iterable[Sample], frames: NDArray[np.float64] | None) -> Motion:
    names = tuple(bound.bones.names[bone] for bone in bound.body.joint_bones)
    found = [figures.MotionFigures(np.zeros(0), np.zeros(0), np.zeros((0, len(names))))]
    folds = [np.zeros((1, len(names)))]
    for batch in sampling.batches(samples):
        matrices = np.stack([sample.object_from_armature for sample in batch])
        scales = np.array([sample.target_scale for sample in batch])
        first = batch[0]
        measures = _measures(batch, bound)
        found.append(figures.motion_figures(measures, bound.body.rest_volume, first.strengths, scales))
        folds.append(figures.fold_losses(measures.joint_losses, first.engine.joint_lengths, matrices))
    corrected, skinned, lost = (np.concatenate(parts) for parts in zip(*found, strict=True))
    peak_folds = np.concatenate(folds).max(axis=0)
    return Motion(frames, corrected, skinned, names, lost, dict(zip(names, peak_folds.tolist(), strict=True)))


def _measures(batch: Sequence[Sample], bound: VolumeBinding) -> turgor.Measures:
    first = batch[0]
    return first.engine.measure(
        np.stack([sample.pose_matrices for sample in batch]),
        object_from_armature=np.stack([sample.object_from_armature for sample in batch]),
        shape_values=sampling.stacked([sample.shape_values for sample in batch]) if len(first.shape_values) else None,
        rest_positions=sampling.stacked([sample.rest_positions for sample in batch]),
        target_scale=np.array([sample.target_scale for sample in batch]),
        added_offsets=sampling.stacked([sample.added_offsets for sample in batch]),
        fleshed=None if first.added_offsets is None else bound.fleshed,
    )
