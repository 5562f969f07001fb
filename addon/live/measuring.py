"""Measuring a character over a motion: which joints lose volume, and how much. On the main thread only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..logic import figures
from ..logic.character_figures import Motion
from ..scene import stack
from ..states import VolumeBinding
from . import joint_names, sampling, stack_measures
from .binding_rules import is_editable
from .sampling import Sample


def measure(
    target: bpy.types.Object,
    frames: Sequence[float],
    *,
    tell: Callable[[int], None] = lambda done: None,
    use_test_motion: bool = True,
    is_evaluated: bool = False,
) -> Motion:
    """Measure a character at these frames; keep figures for a graph and the largest loss of each joint.

    tell: is told how many frames are done; with `is_evaluated` twice as many. is_evaluated: also measure the mesh that
    Blender makes of each frame, which takes as long as Blender takes.

    use_test_motion: where nothing moves in these frames, a test range of motion is measured instead.

    Raises ValueError where the character is not bound or a frame cannot be read.
    """
    bound = sampling.bound(target)
    numbers = np.asarray(frames, np.float64)
    samples = sampling.Watched(sampling.samples(target, bound, frames, tell))
    found = _motion(bound, samples, numbers)
    if use_test_motion and not samples.has_moved:
        found = _motion(bound, sampling.turned(target, bound), None)
    elif is_evaluated:
        found = _evaluated(target, bound, found, frames, tell)
    runtime.character(target.session_uid).motion = found
    if is_editable(target):
        peaks = np.abs(found.joint_losses).max(axis=0, initial=0.0)
        for name, peak in zip(found.joint_names, peaks.tolist(), strict=True):
            target.turgor.joints[name].peak_loss = peak
    return found


def _evaluated(
    target: bpy.types.Object,
    bound: VolumeBinding,
    motion: Motion,
    frames: Sequence[float],
    tell: Callable[[int], None],
) -> Motion:
    ours = stack.volume_modifier(target)
    count = len(frames)
    seen = stack_measures.volumes(target, ours, bound.body.mesh, frames, lambda done: tell(count + done))
    measured, final = (stack_measures.deviations(each, motion.targets) for each in seen)
    return replace(motion, measured_deviations=measured, final_deviations=final)


def _motion(bound: VolumeBinding, samples: Iterable[Sample], frames: NDArray[np.float64] | None) -> Motion:
    of_rows = joint_names.of_rows(bound.bones, bound.body.joint_bones)
    names = tuple(dict.fromkeys(of_rows))
    found = [figures.MotionFigures(np.zeros(0), np.zeros(0), np.zeros((0, len(of_rows))), np.zeros(0))]
    folds = [np.zeros((1, len(of_rows)))]
    for batch in sampling.batches(samples):
        matrices = np.stack([sample.object_from_armature for sample in batch])
        scales = np.array([sample.target_scale for sample in batch])
        first = batch[0]
        measures = _measures(batch, bound)
        found.append(figures.motion_figures(measures, bound.body.rest_volume, first.strengths, scales))
        folds.append(figures.fold_losses(measures.joint_losses, first.engine.joint_lengths, matrices))
    corrected, skinned, lost, targets = (np.concatenate(parts) for parts in zip(*found, strict=True))
    parts = [np.flatnonzero([name == of_row for of_row in of_rows]) for name in names]
    peaks = np.concatenate(folds).max(axis=0)
    peak_folds = {name: float(peaks[own].max()) for name, own in zip(names, parts, strict=True)}
    return Motion(frames, corrected, skinned, targets, names, figures.summed(lost, parts), peak_folds)


def _measures(batch: Sequence[Sample], bound: VolumeBinding) -> turgor.Measures:
    poses = np.stack([sample.pose_matrices for sample in batch])
    return batch[0].engine.measure(poses, **sampling.arguments(batch, bound))
