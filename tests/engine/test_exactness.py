"""The corrected volume is the target's, to rounding, whatever the rig does."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_volume import mean_of_fans
from rigs import Mode, Rig, careless, chain, limb
from surfaces import open_tube, tube

EXACT = 1e-12
seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])
fields_kinds = st.sampled_from(["plain", "even"])


def relative_errors(report: turgor.Report) -> np.ndarray:
    return np.abs(report.corrected_volumes - report.target_volumes) / np.abs(report.target_volumes)


def assert_exact(rig: Rig, frame: turgor.Frame):
    """By the engine's own figures and by the independent measure."""
    assert np.isfinite(frame.positions).all()
    assert frame.report.relative_error <= EXACT
    assert relative_errors(frame.report).max() <= EXACT
    measured = mean_of_fans(rig.surface, frame.positions)
    assert measured == pytest.approx(frame.report.target_volumes.sum(), rel=10 * EXACT)


@given(seeds, modes, solvers, fields_kinds)
def test_random_poses(seed: int, mode: Mode, solver, fields):
    rig = limb(bone_count=4)
    frame = rig.body(mode, solver=solver, fields=fields).deform(rig.random_pose(np.random.default_rng(seed), 1.2))
    assert_exact(rig, frame)
    assert frame.report.target_volumes.sum() == pytest.approx(mean_of_fans(rig.surface), rel=EXACT)


@given(seeds, modes, solvers, fields_kinds)
def test_careless_weights(seed: int, mode: Mode, solver, fields):
    rng = np.random.default_rng(seed)
    rig = careless(limb(bone_count=4), rng)
    assert_exact(rig, rig.body(mode, solver=solver, fields=fields).deform(rig.random_pose(rng, 0.8)))


@given(seeds, modes, solvers, fields_kinds)
def test_modifier_vertex_group(seed: int, mode: Mode, solver, fields):
    rng = np.random.default_rng(seed)
    rig = limb()
    rig = rig.with_mask(np.clip(rig.surface.positions[:, 0] / 2.0, 0.0, 1.0))
    assert_exact(rig, rig.body(mode, solver=solver, fields=fields).deform(rig.random_pose(rng, 0.8)))


@given(seeds, modes, solvers, st.booleans())
def test_bone_scale_and_translation(seed: int, mode: Mode, solver, keep_bone_scale: bool):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    body = rig.body(mode, solver=solver, keep_bone_scale=keep_bone_scale)
    frame = body.deform(rig.random_pose(rng, 0.6, scale=0.2, shift=0.1))
    assert_exact(rig, frame)
    if not keep_bone_scale:
        assert frame.report.target_volumes.sum() == pytest.approx(mean_of_fans(rig.surface), rel=EXACT)


@given(seeds, modes)
def test_scale_of_the_whole_rig_is_kept(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    size = rng.uniform(0.5, 2.0)
    pose = np.diag([size, size, size, 1.0]) @ rig.random_pose(rng, 0.8)
    frame = rig.body(mode).deform(pose)
    assert frame.report.target_volumes.sum() == pytest.approx(size**3 * mean_of_fans(rig.surface), rel=1e-9)


@settings(max_examples=3)
@given(seeds, modes, solvers, fields_kinds)
def test_two_hundred_bones(seed: int, mode: Mode, solver, fields):
    rig = chain(tube(rings=601, sides=8, length=40.0), 200, length=40.0)
    assert_exact(
        rig, rig.body(mode, solver=solver, fields=fields).deform(rig.random_pose(np.random.default_rng(seed), 0.3))
    )


@given(seeds, modes)
def test_open_tubes_keep_the_volume_under_their_caps(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    sleeve = open_tube(33, 12)
    rig = chain(sleeve, 3)
    frame = rig.body(mode).deform(rig.random_pose(rng, 0.8))
    assert frame.report.relative_error <= EXACT
    assert sleeve.mesh().volume(frame.positions) == pytest.approx(sleeve.mesh().volume(sleeve.positions), rel=EXACT)


@given(seeds, modes)
def test_split_seams(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    split = tube(33, 12).split_apart()
    rig = chain(split, 3)
    frame = rig.body(mode).deform(rig.random_pose(rng, 0.8))
    assert frame.report.relative_error <= EXACT
    assert split.mesh().volume(frame.positions) == pytest.approx(split.mesh().volume(split.positions), rel=EXACT)
    assert frame.report.seam_gap <= 1e-12


@given(seeds)
def test_coincident_vertices_with_different_weights_receive_the_same_correction(seed: int):
    rng = np.random.default_rng(seed)
    whole = tube(33, 12)
    rig = careless(chain(whole.split_apart(), 3), rng)
    frame = rig.body().deform(rig.random_pose(rng, 0.8))
    assert frame.report.relative_error <= EXACT
    assert frame.report.seam_gap > 0.0
    correction = frame.positions - frame.skinned
    first = np.unique(whole.face_corners, return_index=True)[1]
    np.testing.assert_allclose(correction, correction[first][whole.face_corners], atol=1e-12)


@given(seeds, modes)
def test_each_shell_keeps_its_own_volume(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    outer, inner = tube(33, 12), tube(17, 8)
    both = outer.joined(inner.moved(inner.positions * [1.0, 0.5, 0.5]))
    rig = chain(both, 3)
    report = rig.body(mode).deform(rig.random_pose(rng, 0.8)).report
    assert relative_errors(report).max() <= EXACT
    expected = [component.rest_volume for component in both.mesh().components]
    np.testing.assert_allclose(report.target_volumes, expected, rtol=EXACT)


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_rest_pose_is_left_alone(mode: Mode):
    rig = limb()
    frame = rig.body(mode).deform(rig.rest_pose())
    np.testing.assert_allclose(frame.offsets, 0.0, atol=1e-12)
    np.testing.assert_allclose(frame.positions, rig.surface.positions, atol=1e-12)
    np.testing.assert_allclose(frame.report.joint_losses, 0.0, atol=1e-12)
