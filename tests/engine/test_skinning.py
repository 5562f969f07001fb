"""Blend skinning is Blender's: against an independent float64 numpy version."""

from __future__ import annotations

import numpy as np
import pytest
import reference_skinning
from hypothesis import given
from hypothesis import strategies as st
from rigs import Mode, applied, careless, limb, random_rigid_motion, translation

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
REFERENCES = {"linear": reference_skinning.linear, "dual_quaternion": reference_skinning.dual_quaternion}


@given(seeds, modes)
def test_random_poses(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=5)
    pose = rig.random_pose(rng, 1.5, shift=0.2)
    expected = REFERENCES[mode](rig, rig.surface.positions, pose)
    np.testing.assert_allclose(rig.skinning(mode).deform(rig.surface.positions, pose), expected, atol=1e-9)


@given(seeds, modes)
def test_frames_are_skinned_so_too_however_far_bones_turn(seed: int, mode: Mode):
    """Beyond half a turn dual quaternions are blended the other way around."""
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=5)
    pose = rig.random_pose(rng, np.pi, shift=0.2)
    expected = REFERENCES[mode](rig, rig.surface.positions, pose)
    np.testing.assert_allclose(rig.body(mode).deform(pose).skinned, expected, atol=1e-9)


@given(seeds, modes)
def test_bone_scale(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    pose = rig.random_pose(rng, 1.0, scale=0.4, shift=0.2)
    expected = REFERENCES[mode](rig, rig.surface.positions, pose)
    np.testing.assert_allclose(rig.skinning(mode).deform(rig.surface.positions, pose), expected, atol=1e-9)


@given(seeds, modes)
def test_careless_weights(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = careless(limb(bone_count=5), rng)
    pose = rig.random_pose(rng, 2.5)
    expected = REFERENCES[mode](rig, rig.surface.positions, pose)
    np.testing.assert_allclose(rig.skinning(mode).deform(rig.surface.positions, pose), expected, atol=1e-9)


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
@pytest.mark.parametrize(("total", "is_moved"), [(0.0, False), (0.99e-4, False), (1.01e-4, True), (1.0, True)])
def test_vertices_of_next_to_no_weight_stay(mode: Mode, total: float, is_moved: bool):
    """As in Blender: up to a sum of 0.0001 no bone holds a vertex, in frames too."""
    rig = limb()
    light = np.arange(0, len(rig.weights), 7)
    rig.weights[light] *= total
    pose = translation([0.3, -0.2, 0.1]) @ rig.random_pose(np.random.default_rng(4), 0.7)
    expected = REFERENCES[mode](rig, rig.surface.positions, pose)
    frame = rig.body(mode).deform(pose)
    for skinned in (rig.skinning(mode).deform(rig.surface.positions, pose), frame.skinned):
        np.testing.assert_allclose(skinned, expected, atol=1e-9)
        moved = np.abs(skinned - rig.surface.positions)[light].max(axis=1)
        assert (moved > 1e-3).all() if is_moved else (moved <= 1e-12).all()


@given(seeds, modes)
def test_modifier_vertex_group(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    rig = rig.with_mask(rng.uniform(0.0, 1.0, len(rig.surface.positions)))
    pose = rig.random_pose(rng, 1.2)
    expected = REFERENCES[mode](rig, rig.surface.positions, pose)
    np.testing.assert_allclose(rig.skinning(mode).deform(rig.surface.positions, pose), expected, atol=1e-9)


@given(seeds, modes)
def test_object_matrices_only_change_the_space(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    skinning = rig.skinning(mode)
    pose = rig.random_pose(rng, 1.0)
    object_from_armature = random_rigid_motion(rng) @ np.diag([*rng.uniform(0.5, 2.0, 3), 1.0])
    placed = applied(object_from_armature, rig.surface.positions)
    expected = applied(object_from_armature, skinning.deform(rig.surface.positions, pose))
    np.testing.assert_allclose(skinning.deform(placed, pose, object_from_armature), expected, atol=1e-9)


@given(seeds, modes)
def test_rigid_motion_of_the_pose_moves_the_mesh(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    skinning = rig.skinning(mode)
    pose = rig.random_pose(rng, 1.0)
    move = random_rigid_motion(rng)
    expected = applied(move, skinning.deform(rig.surface.positions, pose))
    np.testing.assert_allclose(skinning.deform(rig.surface.positions, move @ pose), expected, atol=1e-9)


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_rest_pose_moves_nothing(mode: Mode):
    rig = limb()
    deformed = rig.skinning(mode).deform(rig.surface.positions, rig.rest_pose())
    np.testing.assert_allclose(deformed, rig.surface.positions, atol=1e-13)
