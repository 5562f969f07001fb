"""Measuring a character over a motion: which joints lose volume, and how much. On the main thread only.

The motion is the scene's frames, sampled apart; where nothing moves in them, a test range of motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..logic import figures, range_of_motion
from ..scene import frame, pose_samples, settings, shape_keys, stack
from . import binding, spine_frame
from .binding import Bound
from .binding_rules import is_editable
from .frame import engine_of

# What a measurement takes at most where nobody asked for it, about a second: vertices times poses, and poses.
QUICK_VERTEX_POSES = 2e7
QUICK_POSES = 120
# Poses that the engine gets at once, spread over all processors.
BATCH = 64
# Entries of pose matrices that differ by less, in units of the rig's own entries, do not move.
STILL = 1e-5


class _Sample(NamedTuple):
    """One pose with the settings of its frame."""

    engine: turgor.VolumeSkin
    strengths: NDArray[np.float64]  # (J,)
    target_scale: float
    pose_matrices: NDArray[np.float32]  # (B, 4, 4)
    object_from_armature: NDArray[np.float64]  # (4, 4)
    shape_values: NDArray[np.float32]  # (K,)
    added_offsets: NDArray[np.float32] | None  # (N, 3) of Turgor Spine


def scene_frames(scene: bpy.types.Scene) -> list[int]:
    """All frames of the preview range if it is used, else of the scene."""
    if scene.use_preview_range:
        return list(range(scene.frame_preview_start, scene.frame_preview_end + 1))
    return list(range(scene.frame_start, scene.frame_end + 1))


def quick_frames(target: bpy.types.Object, frames: Sequence[int]) -> list[int]:
    """Frames for a measurement that nobody asked for: evenly fewer, the first and the last kept.

    By counts alone, not by the clock: the same file gets the same figures on every machine.
    """
    most = min(QUICK_POSES, _quick_poses(runtime.character(target.session_uid).body))
    if len(frames) <= most:
        return list(frames)
    return [frames[place] for place in np.unique(np.linspace(0, len(frames) - 1, most).round().astype(int))]


def measure(
    target: bpy.types.Object,
    frames: Sequence[float],
    *,
    tell: Callable[[int], None] = lambda done: None,
    use_test_motion: bool = True,
) -> runtime.Motion:
    """Keep figures for a graph and the largest loss of each joint. tell: is told how many frames are done.

    use_test_motion: where nothing moves in these frames, a test range of motion is measured instead.

    Raises ValueError where the character is not bound or a frame cannot be read.
    """
    known = runtime.character(target.session_uid)
    if known.signature != stack.signature(target):
        # A script changed the stack, and nothing has been evaluated since.
        binding.bind(target)
    bound: Bound | None = known.body
    if bound is None:
        raise ValueError(known.problem or "The character is not bound: press Rebind")
    numbers = np.asarray(frames, np.float64)
    samples = _Watched(_samples(target, bound, frames, tell))
    motion = _motion(bound, samples, numbers)
    if use_test_motion and not samples.has_moved:
        motion = _motion(bound, _range_of_motion(target, bound), None)
    known.motion = motion
    if is_editable(target):
        peaks = np.abs(motion.joint_losses).max(axis=0, initial=0.0)
        for name, peak in zip(motion.joint_names, peaks.tolist(), strict=True):
            target.turgor.joints[name].peak_loss = peak
    return motion


def _motion(bound: Bound, samples: Iterable[_Sample], frames: NDArray[np.float64] | None) -> runtime.Motion:
    names = tuple(bound.bones.names[bone] for bone in bound.body.joint_bones)
    found = [figures.MotionFigures(np.zeros(0), np.zeros(0), np.zeros((0, len(names))))]
    folds = [np.zeros((1, len(names)))]
    for batch in _batches(samples):
        matrices = np.stack([sample.object_from_armature for sample in batch])
        scales = np.array([sample.target_scale for sample in batch])
        first = batch[0]
        measures = _one(batch[0], bound) if first.added_offsets is not None else _many(batch, matrices, scales)
        found.append(figures.motion_figures(measures, bound.body.rest_volume, first.strengths, scales))
        folds.append(figures.fold_losses(measures.joint_losses, first.engine.joint_lengths, matrices))
    corrected, skinned, lost = (np.concatenate(parts) for parts in zip(*found, strict=True))
    peak_folds = np.concatenate(folds).max(axis=0)
    return runtime.Motion(frames, corrected, skinned, names, lost, dict(zip(names, peak_folds.tolist(), strict=True)))


def _many(batch: Sequence[_Sample], matrices: NDArray[np.float64], scales: NDArray[np.float64]) -> turgor.Measures:
    return batch[0].engine.measure(
        np.stack([sample.pose_matrices for sample in batch]),
        object_from_armature=matrices,
        shape_values=np.stack([sample.shape_values for sample in batch]) if len(batch[0].shape_values) else None,
        target_scale=scales,
    )


def _one(sample: _Sample, bound: Bound) -> turgor.Report:
    offsets = np.empty((bound.body.vertex_count, 3), np.float32)
    return sample.engine.deform_into(
        offsets,
        sample.pose_matrices,
        object_from_armature=sample.object_from_armature,
        shape_values=sample.shape_values if len(sample.shape_values) else None,
        target_scale=sample.target_scale,
        added_offsets=sample.added_offsets,
        fleshed=bound.fleshed,
    )


def _batches(samples: Iterable[_Sample]) -> Iterator[list[_Sample]]:
    """Neighbours under the same settings; one by one where Turgor Spine adds to the skin."""
    for _, alike in groupby(samples, lambda sample: id(sample.engine)):
        batch: list[_Sample] = []
        for sample in alike:
            batch.append(sample)
            if len(batch) == BATCH or sample.added_offsets is not None:
                yield batch
                batch = []
        if batch:
            yield batch


def _samples(
    target: bpy.types.Object, bound: Bound, frames: Sequence[float], tell: Callable[[int], None]
) -> Iterator[_Sample]:
    for done, evaluated in enumerate(pose_samples.evaluated_apart(target, frames)):
        inputs = frame.read_frame(evaluated)
        saved = settings.read_settings(evaluated)
        added = None
        if bound.fleshed is not None:
            added = spine_frame.added_offsets(evaluated, bound.body.vertex_count)
        yield _Sample(
            engine_of(evaluated, saved, bound),
            bound.body.joint_strengths,
            saved.target_volume,
            inputs.pose_matrices[bound.bones.pose_indices],
            inputs.object_from_armature,
            inputs.shape_values,
            added,
        )
        tell(done + 1)


def _range_of_motion(target: bpy.types.Object, bound: Bound) -> Iterator[_Sample]:
    saved = settings.read_settings(target)
    engine = engine_of(target, saved, bound)
    joints = bound.body.joint_bones
    groups = max(_quick_poses(bound) // range_of_motion.TURNS_PER_JOINT, 1)
    poses = range_of_motion.poses(bound.bones.parents.tolist(), bound.bones.rest_matrices, joints, groups)
    shape_values = np.zeros_like(shape_keys.read_values(target))
    for pose in poses:
        yield _Sample(engine, bound.body.joint_strengths, 1.0, pose, bound.placement, shape_values, None)


def _quick_poses(bound: Bound | None) -> int:
    vertex_count = 1 if bound is None else max(bound.body.vertex_count, 1)
    return max(int(QUICK_VERTEX_POSES / vertex_count), 2)


class _Watched:
    """Hands samples on and remembers whether any pose differs from the first."""

    def __init__(self, samples: Iterator[_Sample]) -> None:
        self._samples = samples
        self._first: NDArray[np.float32] | None = None
        self.has_moved = False

    def __iter__(self) -> Iterator[_Sample]:
        for sample in self._samples:
            if self._first is None:
                self._first = sample.pose_matrices
            least = STILL * max(float(np.abs(self._first).max(initial=0.0)), 1.0)
            if not self.has_moved:
                self.has_moved = bool(np.abs(sample.pose_matrices - self._first).max(initial=0.0) > least)
            yield sample
