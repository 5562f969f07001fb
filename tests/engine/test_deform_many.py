"""Positions of many poses at once are those of each alone."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Mode, limb, random_rigid_motion

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
COUNT = 5


@given(seeds, modes, st.integers(0, 9))
def test_many_at_once_are_the_same_bits_as_one_by_one(seed: int, mode: Mode, frame_count: int):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    body = rig.body(mode)
    poses = np.array([rig.random_pose(rng, 0.9) for _ in range(frame_count)]).reshape(-1, 4, 4, 4)
    effects = rng.uniform(size=frame_count)
    found = body.deform_many(poses, effect=effects)
    assert found.dtype == np.float32
    assert found.shape == (frame_count, body.mesh.vertex_count, 3)
    for pose, effect, positions in zip(poses, effects, found, strict=True):
        frame = body.deform(pose)
        expected = frame.skinned + effect * frame.offsets.astype(np.float64)
        assert np.array_equal(positions, expected.astype(np.float32))


@given(seeds)
def test_arrays_are_per_frame_or_the_same_for_all(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb()
    swollen = (rig.surface.positions * [0.0, 0.3, 0.3])[None]
    body = turgor.VolumeSkin(rig.surface.mesh(), rig.skinning(), shape_deltas=swollen)
    poses = np.array([rig.random_pose(rng, 0.8) for _ in range(COUNT)])
    objects = np.array([random_rigid_motion(rng) for _ in range(COUNT)])
    values, scales = rng.uniform(size=(COUNT, 1)), rng.uniform(0.8, 1.2, COUNT)
    found = body.deform_many(poses, object_from_armature=objects, shape_values=values, target_scale=scales)
    for frame in range(COUNT):
        alone = body.deform_many(
            poses[frame : frame + 1],
            object_from_armature=objects[frame],
            shape_values=values[frame],
            target_scale=scales[frame],
        )
        assert np.array_equal(found[frame], alone[0])


def test_an_array_of_the_caller_is_filled_and_handed_back():
    rig = limb()
    body = rig.body()
    poses = np.array([rig.random_pose(np.random.default_rng(3), 0.7) for _ in range(COUNT)])
    room = np.full((COUNT + 2, body.mesh.vertex_count, 3), np.nan, np.float32)
    own = room[1:-1]
    assert body.deform_many(poses, positions=own) is own
    assert np.array_equal(own, body.deform_many(poses))
    assert np.isnan(room[0]).all()
    assert np.isnan(room[-1]).all()
    read_only = own.copy()
    read_only.flags.writeable = False
    for wrong in (own[1:], own.astype(np.float64), room[::2][: len(own)], own[..., :2], [1.0], read_only):
        with pytest.raises(turgor.TurgorError, match="positions"):
            body.deform_many(poses, positions=wrong)  # pyright: ignore[reportArgumentType]


def test_bad_input_is_refused_by_name():
    rig = limb()
    body = rig.body()
    poses = np.array([rig.random_pose(np.random.default_rng(1), 0.5)] * 3)
    with pytest.raises(turgor.TurgorError, match=r"effect: need float64 one number or \(3,\)"):
        body.deform_many(poses, effect=[1.0, 1.0])
    with pytest.raises(turgor.TurgorError, match="effect"):
        body.deform_many(poses, effect=float("nan"))
    poses[1, 0, 0, 0] = np.inf
    with pytest.raises(turgor.TurgorError, match="frame 1"):
        body.deform_many(poses)
