"""Skeletons as control rigs leave them: bones that deform have no parent among the bones that deform."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import Mode, limb

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])


@given(seeds, modes)
def test_a_chain_cut_apart_is_corrected_like_the_whole_one(seed: int, mode: Mode):
    rig = limb(bone_count=4)
    cut = replace(rig, parents=np.full(4, -1, dtype=np.int32))
    pose = rig.random_pose(np.random.default_rng(seed), 0.8)
    whole, apart = rig.body(mode).deform(pose), cut.body(mode).deform(pose)
    np.testing.assert_allclose(apart.report.target_volumes, whole.report.target_volumes, rtol=1e-12)
    assert apart.report.max_displacement < 2.0 * whole.report.max_displacement + 0.01


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_a_dense_end_does_not_become_the_root(mode: Mode):
    """A head full of eyes is still hung on the neck: by its skin, not by how many vertices it has."""
    rig = limb(bone_count=4, rings=49)
    # The last two bones form one cut tree whose second bone shares skin with a heavier, third tree.
    parents = np.array([-1, 0, -1, 2], dtype=np.int32)
    cut = replace(rig, parents=parents)
    pose = rig.bent(0.6)
    target = cut.body(mode).deform(pose).report.target_volumes[0]
    assert abs(target / cut.surface.mesh().components[0].rest_volume - 1.0) < 1e-12


@given(seeds, modes)
def test_the_shift_of_a_bone_that_hangs_by_its_skin_is_not_meant(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=3)
    cut = replace(rig, parents=np.array([-1, 0, -1], dtype=np.int32))
    pose = rig.random_pose(rng, 0.5)
    pose[2, :3, 3] += rng.uniform(-0.1, 0.1, 3)
    rest = rig.surface.mesh().components[0].rest_volume
    report = cut.body(mode).deform(pose).report
    assert abs(report.target_volumes[0] / rest - 1.0) < 1e-12
    assert report.relative_error < 1e-12


@given(seeds, modes)
def test_a_bone_without_weights_between_others_turns_and_means_nothing_by_it(seed: int, mode: Mode):
    rig = limb(bone_count=5)
    # What followed the third bone follows its neighbours: it only passes its turn on.
    bones = np.where(rig.bones == 2, np.where(rig.surface.positions[:, :1] < 2.0, 1, 3), rig.bones)
    helper = replace(rig, bones=bones.astype(np.int32))
    pose = helper.random_pose(np.random.default_rng(seed), 0.6)
    rest = helper.surface.mesh().components[0].rest_volume
    report = helper.body(mode).deform(pose).report
    assert abs(report.target_volumes[0] / rest - 1.0) < 1e-12
