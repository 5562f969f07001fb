"""Poses of a character with the settings of their frames, for what looks at a whole motion. On the main thread only.

The motion is the scene's frames, sampled apart; where nothing moves in them, a test range of motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any, NamedTuple

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..logic import range_of_motion
from ..scene import pose_samples, settings, shape_keys, stack_proof
from ..states import VolumeBinding
from . import binding, frame, joint_names, twins
from .engines import engine_of

# What looking at a motion takes at most where nobody asked for it, about a second: vertices times poses, and poses.
QUICK_VERTEX_POSES = 2e7
QUICK_POSES = 120
# Poses that the engine gets at once, spread over all processors.
BATCH = 64
BATCH_BYTES = 1 << 26
# Entries of pose matrices that differ by less, in units of the rig's own entries, do not move.
STILL = 1e-5


class Sample(NamedTuple):
    """One pose with the settings of its frame."""

    engine: turgor.VolumeSkin
    strengths: NDArray[np.float64]  # (J,)
    target_scale: float
    pose_matrices: NDArray[np.float32]  # (B, 4, 4)
    object_from_armature: NDArray[np.float64]  # (4, 4)
    shape_values: NDArray[np.float32]  # (K,)
    added_offsets: NDArray[np.float32] | None  # (N, 3) of Turgor Spine
    posed_positions: NDArray[np.float32] | None  # (N, 3) where Blender evaluates the stack for us
    rest_positions: NDArray[np.float32] | None  # (N, 3) the body, where it is another on every frame

    @property
    def own_bytes(self) -> int:
        """Of positions and offsets that this frame alone has."""
        own = (self.added_offsets, self.posed_positions, self.rest_positions)
        return sum(array.nbytes for array in own if array is not None)

    @property
    def moved(self) -> NDArray[np.float32] | None:
        """What moves skin apart from bones."""
        return self.added_offsets if self.posed_positions is None else self.posed_positions


def bound(target: bpy.types.Object) -> VolumeBinding:
    """The binding of a character with its stack as it is now. Raises ValueError where it is not bound."""
    character = runtime.character(target.session_uid)
    if character.signature != stack_proof.signature(target):
        # A script changed the stack, and nothing has been evaluated since.
        binding.bind(target)
    else:
        twins.follow(target)
    if character.binding is None:
        raise ValueError(character.problem or "The character is not bound: press Rebind")
    return character.binding


def scene_frames(scene: bpy.types.Scene) -> list[int]:
    """All frames of the preview range if it is used, else of the scene."""
    if scene.use_preview_range:
        return list(range(scene.frame_preview_start, scene.frame_preview_end + 1))
    return list(range(scene.frame_start, scene.frame_end + 1))


def quick_frames(target: bpy.types.Object, frames: Sequence[int]) -> list[int]:
    """Frames for a measurement that nobody asked for: evenly fewer, the first and the last kept.

    By counts alone, not by the clock: the same file gets the same figures on every machine.
    """
    most = min(QUICK_POSES, _quick_poses(runtime.character(target.session_uid).binding))
    if len(frames) <= most:
        return list(frames)
    return [frames[place] for place in np.unique(np.linspace(0, len(frames) - 1, most).round().astype(int))]


def samples(
    target: bpy.types.Object, bound: VolumeBinding, frames: Sequence[float], tell: Callable[[int], None]
) -> Iterator[Sample]:
    """Poses at these frames of the scene, with their settings. tell: is told how many are done."""
    character = runtime.character(target.session_uid)
    for done, evaluated in enumerate(pose_samples.evaluated_apart(target, frames)):
        asked = frame.read(evaluated, character, bound)
        yield Sample(
            asked.engine,
            asked.strengths,
            asked.options["target_scale"],
            asked.pose_matrices,
            asked.options["object_from_armature"],
            asked.options.get("shape_values", np.zeros(0, np.float32)),
            asked.options.get("added_offsets"),
            asked.options.get("posed_positions"),
            asked.options.get("rest_positions"),
        )
        tell(done + 1)


def turned(target: bpy.types.Object, bound: VolumeBinding) -> Iterator[Sample]:
    """Poses of a test range of motion: each joint turned in turn, all others at rest."""
    saved = settings.read_settings(target)
    engine, strengths = engine_of(target, saved, bound)
    joints = list(joint_names.rows_of(bound.bones, bound.body.joint_bones, but_bones=True).values())
    groups = max(_quick_poses(bound) // range_of_motion.TURNS_PER_JOINT, 1)
    poses = range_of_motion.poses(bound.bones.parents.tolist(), bound.bones.rest_matrices, joints, groups)
    shape_values = np.zeros_like(shape_keys.read_values(target))
    for pose in poses:
        yield Sample(engine, strengths, 1.0, pose, bound.placement, shape_values, None, None, None)


def batches(poses: Iterable[Sample]) -> Iterator[list[Sample]]:
    """Lists of neighbouring samples under the same settings; of fewer where each has positions of its own."""
    for _, alike in groupby(poses, lambda sample: (id(sample.engine), sample.own_bytes > 0)):
        batch: list[Sample] = []
        for sample in alike:
            batch.append(sample)
            if len(batch) == BATCH or len(batch) * sample.own_bytes > BATCH_BYTES:
                yield batch
                batch = []
        if batch:
            yield batch


def arguments(batch: Sequence[Sample], bound: VolumeBinding) -> dict[str, Any]:
    """What the engine is asked for samples of one batch, beside pose_matrices."""
    first = batch[0]
    return {
        "object_from_armature": np.stack([sample.object_from_armature for sample in batch]),
        "shape_values": stacked([sample.shape_values for sample in batch]) if len(first.shape_values) else None,
        "rest_positions": stacked([sample.rest_positions for sample in batch]),
        "target_scale": np.array([sample.target_scale for sample in batch]),
        "added_offsets": stacked([sample.added_offsets for sample in batch]),
        "posed_positions": stacked([sample.posed_positions for sample in batch]),
        "fleshed": None if first.moved is None else bound.fleshed,
    }


def stacked(arrays: Sequence[NDArray[np.float32] | None]) -> NDArray[np.float32] | None:
    """(F, ...) of samples of one batch; None where they have none."""
    given = [array for array in arrays if array is not None]
    return np.stack(given) if len(given) == len(arrays) else None


class Watched:
    """Hands samples on and remembers whether any pose differs from the first."""

    def __init__(self, poses: Iterator[Sample]) -> None:
        self._samples = poses
        self._first: NDArray[np.float32] | None = None
        self._first_moved: NDArray[np.float32] | None = None
        self.has_moved = False

    def __iter__(self) -> Iterator[Sample]:
        for sample in self._samples:
            if self._first is None:
                self._first, self._first_moved = sample.pose_matrices, sample.moved
            if not self.has_moved:
                self.has_moved = _differ(sample.pose_matrices, self._first)
            moved, first = sample.moved, self._first_moved
            if not self.has_moved and moved is not None:
                self.has_moved = first is None or _differ(moved, first)
            yield sample


def _differ(one: NDArray[np.float32], first: NDArray[np.float32]) -> bool:
    least = STILL * max(float(np.abs(first).max(initial=0.0)), 1.0)
    return bool(np.abs(one - first).max(initial=0.0) > least)


def _quick_poses(bound: VolumeBinding | None) -> int:
    vertex_count = 1 if bound is None else max(bound.body.vertex_count, 1)
    return max(int(QUICK_VERTEX_POSES / vertex_count), 2)
