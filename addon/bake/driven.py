"""Pose-driven keys: learnt from poses that no animation has, driven by how far bones are turned."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..logic import inverse_skinning, pose_driven, turns
from ..scene import shape_key_writing
from ..scene.shape_keys import RANGE
from .baking import Baking, Progress
from .correctives import Deltas, add, finish, make_copy
from .options import BakeError
from .volume_frames import VolumeFrames

# Every joint is turned so often, by up to so much.
POSES_PER_JOINT = 40
LARGEST_TURN = np.radians(75.0)
# Keys that move no vertex by more than this part of the tolerance are not worth having.
LEAST_PART = 1.0 / 16.0


def check(source: object) -> None:
    """Raises BakeError where poses alone do not make the frame."""
    if not isinstance(source, VolumeFrames):
        raise BakeError("Pose-driven keys need Turgor Volume: bake this body's frames instead")
    if source.is_fleshed:
        raise BakeError(
            "Turgor Spine moves bones of this character: pose-driven keys cannot follow it, bake its frames"
        )
    if source.bends:
        raise BakeError(
            "Bendy bones of this character lie by how others are posed: pose-driven keys cannot follow, bake its frames"
        )


def driven(baking: Baking) -> Iterator[Progress]:
    """Make keys driven by the pose: enough to keep the tolerance on every second frame, up to the options' most."""
    source, options = baking.source, baking.options
    assert isinstance(source, VolumeFrames)
    deltas = Deltas(baking)
    yield from deltas.compute()
    bones = deltas.skin.bones
    seen: dict[int, NDArray[np.float64]] = {}
    parts: list[pose_driven.Part] = []
    joints = source.joint_bones
    for number, bone in enumerate(joints):
        poses = turns.turned(
            bone, turns.within_ball(POSES_PER_JOINT, LARGEST_TURN, number), bones.rest_matrices, bones.parents
        )
        wanted, place = source.posed(poses)
        rest = source.rest.positions.astype(np.float64)
        made = [
            inverse_skinning.inverse(deltas.skin.skin.maps(pose, place), rest, positions).deltas
            for pose, positions in zip(poses, wanted, strict=True)
        ]
        seen[bone] = turns.local_turns(poses, bones.rest_matrices, bones.parents)[:, bone]
        parts.append(pose_driven.learn(bone, seen[bone], np.array(made), LEAST_PART * options.tolerance))
        yield baking.making(0.6 + 0.3 * number / len(joints), f"Learnt {number + 1} of {len(joints)} joints")
    learnt = _learnt(baking, deltas, parts, seen)
    make_copy(baking, deltas.skin)
    names = [
        add(baking, f"{bones.names[bone]} {rank}", key, -RANGE, RANGE)
        for bone, rank, key in zip(learnt.bones, _ranks(learnt.bones), learnt.keys, strict=True)
    ]
    finish(baking, len(names), {})
    assert baking.copy is not None
    keys, own = baking.copy.data.shape_keys, baking.target.data.shape_keys
    if keys is not None and own is not None:
        shape_key_writing.keep_animation(keys, own)
    rig = source.end.object
    for name, bone, row in zip(names, learnt.bones, learnt.coefficients, strict=True):
        shape_key_writing.drive_value(keys, name, rig, bones.names[bone], pose_driven.expression(row))


def _learnt(
    baking: Baking, deltas: Deltas, parts: list[pose_driven.Part], seen: dict[int, NDArray[np.float64]]
) -> pose_driven.Learnt:
    bones, options = deltas.skin.bones, baking.options
    poses = np.stack([posed.matrices for posed in baking.poses if posed is not None])
    turned = turns.local_turns(poses, bones.rest_matrices, bones.parents)
    rows = np.concatenate(deltas.chunks)
    is_held = np.arange(len(rows)) % 2 == 1
    least = options.tolerance
    while True:
        known = pose_driven.assemble(parts, least, options.most_keys)
        found = pose_driven.adjusted(known, seen, turned[~is_held], [rows[~is_held]])
        error = found.error(turned[~is_held], [rows[~is_held]]).max()
        if (
            error <= options.tolerance
            or least <= LEAST_PART * options.tolerance
            or len(known.bones) >= options.most_keys
        ):
            break
        least *= 0.5
    if is_held.any():
        baking.report.held_out_error = float(found.error(turned[is_held], [rows[is_held]]).max())
    return found


def _ranks(bones: NDArray[np.int32]) -> list[int]:
    """1, 2, … for each key of the same bone."""
    return [int((bones[:place] == bone).sum()) + 1 for place, bone in enumerate(bones)]
