"""Whose volume is it: the joints' losses telescope (MATH 3)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import Mode, careless, chain, limb, rotation
from surfaces import open_tube, tube

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])


def assert_telescopes(report):
    total = report.target_volumes.sum() - report.skinned_volumes.sum()
    scale = np.abs(report.target_volumes).sum()
    assert report.joint_losses.sum() == pytest.approx(total, abs=1e-12 * scale)


@given(seeds, modes)
def test_losses_sum_to_the_whole(seed: int, mode: Mode):
    rig = limb(bone_count=5)
    assert_telescopes(rig.body(mode).deform(rig.random_pose(np.random.default_rng(seed), 1.2)).report)


@given(seeds, modes)
def test_losses_sum_to_the_whole_under_scale(seed: int, mode: Mode):
    rig = limb(bone_count=5)
    pose = rig.random_pose(np.random.default_rng(seed), 0.8, scale=0.3, shift=0.2)
    assert_telescopes(rig.body(mode).deform(pose).report)


@given(seeds, modes)
def test_losses_sum_to_the_whole_with_careless_weights(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = careless(limb(bone_count=5), rng)
    rig = rig.with_mask(rng.uniform(0.0, 1.0, len(rig.surface.positions)))
    assert_telescopes(rig.body(mode).deform(rig.random_pose(rng, 0.8)).report)


@given(seeds, modes)
def test_losses_sum_to_the_whole_on_shells_and_openings(seed: int, mode: Mode):
    rig = chain(open_tube(33, 12).joined(tube(17, 8, radius=0.2)), 4)
    assert_telescopes(rig.body(mode).deform(rig.random_pose(np.random.default_rng(seed), 0.8)).report)


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_a_joint_that_did_not_turn_lost_nothing(mode: Mode):
    rig = limb(bone_count=4)
    local = [np.eye(4)] * 4
    local[2] = rotation([0.0, 0.0, 1.0], 1.0)
    body = rig.body(mode)
    losses = dict(zip(body.joint_bones, body.deform(rig.pose(local)).report.joint_losses, strict=True))
    assert abs(losses.pop(2)) > 1e-4
    np.testing.assert_allclose(list(losses.values()), 0.0, atol=1e-13)


def test_a_linear_twist_loses_volume():
    rig = limb(bone_count=2)
    local = [np.eye(4), rotation([0.0, 1.0, 0.0], np.pi / 2)]
    body = rig.body()
    report = body.deform(rig.pose(local)).report
    assert dict(zip(body.joint_bones, report.joint_losses, strict=True))[1] > 0.0
    assert report.skinned_volumes.sum() < report.target_volumes.sum()


def test_joints_come_parents_first():
    rig = limb(bone_count=5)
    assert list(rig.body().joint_bones) == sorted(rig.body().joint_bones)
