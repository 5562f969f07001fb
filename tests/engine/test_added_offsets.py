"""What another deformer adds to the skin is part of what is corrected; what it fleshes is not given back twice."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from reference_volume import mean_of_fans
from rigs import Mode, chain, limb
from surfaces import tube
from test_exactness import EXACT, assert_exact

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])


def _smooth_offsets(positions: np.ndarray, rng: np.random.Generator, most: float) -> np.ndarray:
    waves, phases = rng.normal(size=(3, 3)), rng.uniform(0, 6, 3)
    return (most * np.sin(positions @ waves + phases)).astype(np.float32)


@given(seeds, modes, solvers)
def test_exact_with_anything_added(seed: int, mode: Mode, solver):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    added = _smooth_offsets(rig.surface.positions, rng, 0.1)
    pose = rig.random_pose(rng, 0.7)
    body = rig.body(mode, solver=solver)
    frame = body.deform(pose, added_offsets=added)
    assert_exact(rig, frame)
    assert frame.report.target_volumes.sum() == pytest.approx(mean_of_fans(rig.surface), rel=EXACT)
    plain = body.deform(pose)
    assert np.abs(frame.skinned - plain.skinned - added).max() <= 1e-12
    assert frame.report.joint_losses == pytest.approx(plain.report.joint_losses, rel=1e-9, abs=1e-12)


@given(modes)
def test_adding_nothing_changes_nothing(mode: Mode):
    rig = limb(bone_count=4)
    pose = rig.random_pose(np.random.default_rng(7), 0.9)
    body = rig.body(mode)
    nothing = np.zeros_like(rig.surface.positions, dtype=np.float32)
    frame, plain = body.deform(pose, added_offsets=nothing), body.deform(pose)
    assert (frame.positions == plain.positions).all()
    # Nor is anything remembered.
    body.deform(pose, added_offsets=_smooth_offsets(rig.surface.positions, np.random.default_rng(1), 0.2))
    assert (body.deform(pose).positions == plain.positions).all()


@given(seeds, modes, solvers)
def test_coincident_vertices_are_one_point_that_moves_by_the_mean_of_theirs(seed: int, mode: Mode, solver):
    """Along every edge of faces that share no vertex, as if they did."""
    rng = np.random.default_rng(seed)
    whole = tube(rings=17, sides=8).roughened(rng, 0.05)
    corners = whole.face_corners
    added = rng.normal(scale=0.02, size=(len(corners), 3)).astype(np.float32)
    mean = np.zeros_like(whole.positions)
    np.add.at(mean, corners, added)
    mean /= np.bincount(corners)[:, None]
    welded, apart = chain(whole, 3), chain(whole.split_apart(), 3)
    pose = welded.random_pose(rng, 0.7)
    one = welded.body(mode, solver=solver).deform(pose, added_offsets=mean.astype(np.float32))
    other = apart.body(mode, solver=solver).deform(pose, added_offsets=added)
    assert other.report.skinned_volumes == pytest.approx(one.report.skinned_volumes, rel=1e-6)
    assert mean_of_fans(whole, one.skinned) == pytest.approx(one.report.skinned_volumes.sum(), rel=EXACT)
    np.testing.assert_allclose(other.offsets, one.offsets[corners], atol=1e-5)


def test_without_bones_the_whole_skin_gives_back():
    """A body that another deformer moves as a whole."""
    surface = tube(rings=21, sides=12)
    count = len(surface.positions)
    still = turgor.Skinning(turgor.Skeleton([-1], [np.eye(4)]), np.zeros(count + 1, np.int32), [], [])
    body = turgor.VolumeSkin(surface.mesh(), still)
    squeezed = (surface.positions * [0.0, -0.1, -0.1]).astype(np.float32)
    frame = body.deform([np.eye(4)], added_offsets=squeezed)
    assert mean_of_fans(surface, frame.positions) == pytest.approx(mean_of_fans(surface), rel=10 * EXACT)
    given_back = np.linalg.norm(frame.positions - frame.skinned, axis=1)
    assert given_back.max() <= 3.0 * np.median(given_back)


def test_fleshed_joints_give_nothing_back():
    """What skinning lost at a joint is there already: the correction has nothing to do."""
    rig = limb(bone_count=2)
    pose = rig.random_pose(np.random.default_rng(5), 0.9)
    body = rig.body("linear")
    whole = body.deform(pose)
    mended = (whole.positions - whole.skinned).astype(np.float32)
    frame = body.deform(pose, added_offsets=mended, fleshed=[False, True])
    assert frame.report.joint_regained[list(body.joint_bones).index(1)] == 0.0
    assert np.abs(frame.positions - whole.positions).max() <= 1e-6
    twice = body.deform(pose, added_offsets=mended)
    assert np.abs(twice.positions - whole.positions).max() > 1e-4
    assert_exact(rig, frame)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"added_offsets": np.zeros((3, 3), np.float32)}, "added_offsets: found 3 values"),
        ({"added_offsets": np.zeros((5, 2), np.float32)}, "added_offsets: need float32"),
        ({"fleshed": [True]}, "fleshed: found 1 values"),
    ],
)
def test_bad_input(options, words):
    rig = limb(bone_count=3)
    with pytest.raises(turgor.TurgorError, match=words):
        rig.body("linear").deform(rig.random_pose(np.random.default_rng(1), 0.1), **options)


def test_not_finite_offsets_are_refused():
    rig = limb(bone_count=3)
    offsets = np.zeros(rig.surface.positions.shape, np.float32)
    offsets[4, 1] = np.nan
    with pytest.raises(turgor.TurgorError, match="added_offsets: row 4 is not finite"):
        rig.body("linear").deform(rig.random_pose(np.random.default_rng(1), 0.1), added_offsets=offsets)
