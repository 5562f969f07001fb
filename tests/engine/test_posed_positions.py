"""A frame may be told where other deformers leave the skin: the same as adding what they add to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import turgor
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_volume import mean_of_fans
from rigs import Mode, limb, random_rigid_motion
from surfaces import Surface
from test_added_offsets import _smooth_offsets
from test_exactness import EXACT, assert_exact
from test_one_frame_all_paths import careless_rig, poses_of, solvers, surfaces

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
# What single precision leaves of a position, of its size.
SINGLE = 2.0**-22


def _local_offsets(positions: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Of a part of the body."""
    moved = _smooth_offsets(positions, rng, 0.1)
    moved[positions @ rng.normal(size=3) > 0.0] = 0.0
    return moved


@settings(max_examples=50)
@given(seeds, modes, solvers, st.booleans())
def test_exact_on_the_positions_and_as_with_offsets(seed: int, mode: Mode, solver, is_local: bool):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    offsets = (_local_offsets if is_local else lambda p, r: _smooth_offsets(p, r, 0.1))(rig.surface.positions, rng)
    pose, place = rig.random_pose(rng, 0.7), random_rigid_motion(rng)
    body = rig.body(mode, solver=solver)
    plain = body.deform(pose, object_from_armature=place)
    posed = (plain.skinned + offsets).astype(np.float32)
    frame = body.deform(pose, object_from_armature=place, posed_positions=posed)
    size = np.abs(posed).max()
    assert np.abs(frame.skinned - posed).max() <= 1e-12 * size
    assert_exact(rig, frame)
    assert frame.report.target_volumes.sum() == pytest.approx(mean_of_fans(rig.surface), rel=EXACT)
    added = body.deform(pose, object_from_armature=place, added_offsets=offsets)
    assert np.abs(frame.positions - added.positions).max() <= 1e-4 * size
    assert frame.report.joint_losses == pytest.approx(plain.report.joint_losses, rel=1e-9, abs=1e-12)


@given(seeds, modes)
def test_its_own_skin_is_moved_by_nothing(seed: int, mode: Mode):
    """The frame is that of its own skin, but for what rounds the positions."""
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    body, pose = rig.body(mode), rig.random_pose(rng, 0.9)
    plain = body.deform(pose)
    frame = body.deform(pose, posed_positions=plain.skinned.astype(np.float32))
    size = np.abs(plain.skinned).max()
    assert np.abs(frame.offsets - plain.offsets).max() <= 20.0 * SINGLE * size
    assert frame.report.joint_regained == pytest.approx(plain.report.joint_regained, abs=1e-6)
    # Nor is anything remembered.
    assert (body.deform(pose).positions == plain.positions).all()


def test_a_part_that_is_moved_changes_nothing_far_from_it():
    rig = limb(bone_count=4)
    body, pose = rig.body("linear"), rig.random_pose(np.random.default_rng(2), 0.0)
    skinned = body.deform(pose).skinned
    along = skinned @ np.linalg.svd(skinned - skinned.mean(axis=0))[2][0]
    reach = np.clip(1.0 - (along - along.min()) / (0.2 * np.ptp(along)), 0.0, 1.0)
    frame = body.deform(pose, posed_positions=(skinned * (1.0 - 0.2 * reach[:, None])).astype(np.float32))
    given_back = np.linalg.norm(frame.offsets, axis=1)
    assert given_back[reach == 0.0].max() < 0.2 * given_back.max()
    assert_exact(rig, frame)


@settings(max_examples=100)
@given(seeds, surfaces(), modes, solvers, st.booleans())
def test_every_path_gives_the_same_bits(seed: int, surface: Surface, mode: Mode, solver, has_bodies: bool):
    rng = np.random.default_rng(seed)
    rig = careless_rig(surface, rng)
    count = len(surface.positions)
    body = turgor.VolumeSkin(surface.mesh(), rig.skinning(mode), solver=solver)
    poses, options = poses_of(rig, rng, 2)
    options["posed_positions"] = rng.normal(scale=0.05, size=(2, count, 3)).astype("f4") + surface.positions.astype(
        "f4"
    )
    if has_bodies:
        options["rest_positions"] = rng.normal(scale=0.02, size=(2, count, 3)).astype("f4") + surface.positions.astype(
            "f4"
        )
    many, measures = body.deform_many(poses, **options), body.measure(poses, **options)
    for row, pose in enumerate(poses):
        own: dict[str, Any] = {name: values[row] for name, values in options.items()}
        frame = body.deform(pose, **own)
        size = max(1.0, float(np.abs(frame.skinned).max(initial=0.0)))
        assert np.abs(frame.skinned - own["posed_positions"]).max(initial=0.0) <= 1e-6 * size
        assert np.array_equal(many[row], (frame.skinned + frame.offsets.astype(float)).astype("f4"))
        room = np.full((count, 3), np.nan, np.float32)
        body.deform_into(room, pose, **own)
        assert np.array_equal(room, frame.offsets)
        assert np.array_equal(measures.corrected_volumes[row], frame.report.corrected_volumes)
        assert np.isfinite(frame.positions).all()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"posed_positions": np.zeros((3, 3), np.float32)}, "posed_positions: found 3 values"),
        ({"posed_positions": np.zeros((5, 2), np.float32)}, "posed_positions: need float32"),
    ],
)
def test_bad_input(options, words):
    rig = limb(bone_count=3)
    with pytest.raises(turgor.TurgorError, match=words):
        rig.body("linear").deform(rig.random_pose(np.random.default_rng(1), 0.1), **options)


def test_positions_that_are_no_places_are_refused():
    rig = limb(bone_count=3)
    body, pose = rig.body("linear"), rig.random_pose(np.random.default_rng(1), 0.1)
    positions = rig.surface.positions.astype(np.float32)
    with pytest.raises(turgor.TurgorError, match="added_offsets and posed_positions are both given: need one"):
        body.deform(pose, posed_positions=positions, added_offsets=positions)
    with pytest.raises(turgor.TurgorError, match=r"posed_positions is .*, need up to 1e15"):
        body.deform(pose, posed_positions=positions * 1e10, object_from_armature=np.diag([1e-8, 1e-8, 1e-8, 1.0]))
    positions[4, 1] = np.nan
    with pytest.raises(turgor.TurgorError, match="posed_positions: row 4 is not finite"):
        body.deform(pose, posed_positions=positions)
