"""Skeletons as control rigs leave them: bones that deform have no parent among the bones that deform."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from rigs import Mode, Rig, limb, random_rigid_motion, random_rotation, rotation, translation
from surfaces import tube

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


@given(seeds, modes, st.sets(st.integers(1, 11), min_size=1))
def test_a_long_chain_of_short_bones_is_put_together_as_it_was(seed: int, mode: Mode, cuts: set[int]):
    """As bendy bones are: the first node of a bone that was cut off hangs on the last node of the bone before."""
    rig = limb(bone_count=12, rings=73)
    cut = replace(rig, parents=np.array([-1 if bone in cuts else bone - 1 for bone in range(12)], dtype=np.int32))
    pose = rig.random_pose(np.random.default_rng(seed), 0.3)
    whole, apart = rig.body(mode).deform(pose).report, cut.body(mode).deform(pose).report
    rest = rig.surface.mesh().components[0].rest_volume
    np.testing.assert_allclose(apart.joint_losses, whole.joint_losses, atol=1e-12 * rest)
    np.testing.assert_allclose(apart.target_volumes, whole.target_volumes, rtol=1e-12)


CONTROL, CHEST, SHOULDER, ARM, FOREARM = range(5)
ALONG_X = rotation([0.0, 0.0, 1.0], -np.pi / 2)


def cut_arm(heads: NDArray[np.float64], *, parent: int = CONTROL) -> Rig:
    """A chest, a shoulder that holds the upper side where the arm begins, an arm and a forearm that hangs on it.

    heads: (5, 3), of a control without skin and of these; `parent`: of chest, shoulder and arm.
    """
    surface = tube(49, 16)
    x, y = surface.positions[:, 0], surface.positions[:, 1]

    def after(at: float, width: float) -> NDArray[np.float64]:
        t = np.clip((x - at) / width + 0.5, 0.0, 1.0)
        return t * t * (3.0 - 2.0 * t)

    shoulder = 0.6 * np.exp(-(((x - 1.7) / 0.35) ** 2)) * np.clip(y / 0.5 + 0.2, 0.0, 1.0)
    arm, forearm = after(1.5, 1.2), after(3.0, 0.6)
    weights = np.stack([(1.0 - arm) * (1.0 - shoulder), shoulder, arm * (1.0 - shoulder) * (1.0 - forearm)], axis=1)
    weights = np.column_stack([weights, arm * (1.0 - shoulder) * forearm])
    bones = np.tile(np.array([CHEST, SHOULDER, ARM, FOREARM], dtype=np.int32), (len(x), 1))
    rest = np.array([translation(head) @ ALONG_X for head in heads])
    return Rig(surface, np.array([-1, parent, parent, parent, ARM], dtype=np.int32), rest, bones, weights)


HEADS = np.array([[-1.0, 0.3, 0.0], [0.0, 0.0, 0.0], [1.1, 0.3, 0.0], [1.5, 0.0, 0.0], [3.0, 0.0, 0.0]])
parents = st.sampled_from([-1, CONTROL])


def losses_of(rig: Rig, pose: NDArray[np.float64], mode: Mode = "linear") -> NDArray[np.float64]:
    """(B,) of each bone, as parts of the rest volume; what all lose is what the target is above the skinned volume."""
    body = rig.body(mode)
    report = body.deform(pose).report
    losses = np.zeros(rig.bone_count)
    losses[body.joint_bones] = report.joint_losses
    total = report.target_volumes.sum() - report.skinned_volumes.sum()
    rest = rig.surface.mesh().components[0].rest_volume
    assert losses.sum() == pytest.approx(total, abs=1e-11 * max(rest, np.abs(losses).max()))
    return losses / rest


@given(seeds, modes, parents)
def test_what_stands_still_is_given_nothing_however_the_chain_came_out(seed: int, mode: Mode, parent: int):
    """Heads lie anywhere: weights and places then tell nothing of the anatomy."""
    rng = np.random.default_rng(seed)
    heads = rng.uniform([0.0, -0.5, -0.5], [4.0, 0.5, 0.5], (5, 3))
    rig = cut_arm(heads, parent=parent)
    moved = translation(heads[ARM]) @ random_rotation(rng, 1.2) @ translation(-heads[ARM])
    pose = np.array([np.eye(4), np.eye(4), np.eye(4), moved, moved])
    losses = losses_of(rig, pose, mode)
    np.testing.assert_allclose(losses[[CONTROL, CHEST, SHOULDER, FOREARM]], 0.0, atol=1e-12)


@given(seeds, modes, parents)
def test_a_shoulder_that_goes_with_the_chest_is_given_nothing(seed: int, mode: Mode, parent: int):
    rng = np.random.default_rng(seed)
    rig = cut_arm(HEADS, parent=parent)
    chest = random_rigid_motion(rng)
    arm = chest @ translation(HEADS[ARM]) @ random_rotation(rng, 1.2) @ translation(-HEADS[ARM])
    losses = losses_of(rig, np.array([np.eye(4), chest, chest, arm, arm]), mode)
    np.testing.assert_allclose(losses[[CHEST, SHOULDER, FOREARM]], 0.0, atol=1e-9)


@given(seeds, modes)
def test_a_control_at_the_place_of_a_bone_stands_for_it(seed: int, mode: Mode):
    """As Rigify does it: bones that deform lie on those that carry them, and hang on those of others."""
    rng = np.random.default_rng(seed)
    heads = HEADS.copy()
    heads[CONTROL] = heads[SHOULDER]
    rig = cut_arm(heads)
    rig = replace(rig, parents=np.array([-1, -1, CONTROL, CONTROL, ARM], dtype=np.int32))
    whole = replace(rig, parents=np.array([-1, -1, CHEST, SHOULDER, ARM], dtype=np.int32))
    local = [np.eye(4), np.eye(4), random_rotation(rng, 0.5), random_rotation(rng, 1.0), random_rotation(rng, 0.5)]
    pose = whole.pose(local)
    pose[CONTROL] = pose[SHOULDER]
    np.testing.assert_allclose(losses_of(rig, pose, mode), losses_of(whole, pose, mode), atol=1e-12)


@given(seeds, modes)
def test_losses_are_continuous_as_a_bone_begins_to_move(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    heads = rng.uniform([0.0, -0.5, -0.5], [4.0, 0.5, 0.5], (5, 3))
    rig = cut_arm(heads)
    axes = rng.normal(size=(5, 3))

    def at(t: float) -> NDArray[np.float64]:
        turns = [0.0, 0.0, 0.8 * t, 1.0, 1.0 - 0.8 * t]
        moved = [
            translation(head) @ rotation(axis, angle) @ translation(-head)
            for head, axis, angle in zip(heads, axes, turns, strict=True)
        ]
        return losses_of(rig, np.array(moved), mode)

    for t in (0.0, 1e-3, 0.05, 0.3, 0.7):
        assert np.abs(at(t + 1e-5) - at(t)).max() < 2e-3
    np.testing.assert_allclose(at(1e-9), at(0.0), atol=1e-8)


@given(seeds, modes, parents)
def test_numbers_of_bones_mean_nothing(seed: int, mode: Mode, parent: int):
    rng = np.random.default_rng(seed)
    heads = rng.uniform([0.0, -0.5, -0.5], [4.0, 0.5, 0.5], (5, 3))
    rig = cut_arm(heads, parent=parent)
    pose = np.array([random_rigid_motion(rng) if bone else np.eye(4) for bone in range(5)])
    order = rng.permutation(5)
    place = np.argsort(order)
    renumbered = replace(
        rig,
        parents=np.array([-1 if p < 0 else place[p] for p in rig.parents[order]], dtype=np.int32),
        rest_matrices=rig.rest_matrices[order],
        bones=place[rig.bones].astype(np.int32),
    )
    np.testing.assert_allclose(losses_of(renumbered, pose[order], mode), losses_of(rig, pose, mode)[order], atol=1e-9)
    assert sorted(order[renumbered.body(mode).joint_bones]) == sorted(rig.body(mode).joint_bones)
