"""What the artist sets: strength, size, solver, target, narrow profiles, shape keys."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Rig, chain, limb, rotation
from surfaces import tube

seeds = st.integers(0, 2**32 - 1)
strengths = st.floats(0.0, 2.0)


def joints(rig: Rig, **settings: float) -> list[turgor.Joint]:
    return [turgor.presets.isotropic(bone, **settings) for bone in range(rig.bone_count)]


@given(seeds, strengths)
def test_strength_is_the_part_given_back(seed: int, strength: float):
    rig = limb()
    frame = rig.body(joints=joints(rig, strength=strength)).deform(rig.random_pose(np.random.default_rng(seed), 0.8))
    skinned = frame.report.skinned_volumes.sum()
    rest = rig.surface.mesh().volume(rig.surface.positions)
    expected = skinned + strength * (rest - skinned)
    assert rig.surface.mesh().volume(frame.positions) == pytest.approx(expected, rel=1e-11)


@given(seeds)
def test_strengths_of_a_frame_replace_the_settings(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb()
    pose = rig.random_pose(rng, 0.8)
    strengths = rng.uniform(0.0, 2.0, rig.bone_count)
    set_before = [turgor.presets.isotropic(bone, strength=strength) for bone, strength in enumerate(strengths)]
    expected = rig.body(joints=set_before).deform(pose).positions
    assert np.array_equal(rig.body().deform(pose, strengths=strengths).positions, expected)


def test_no_strength_is_plain_skinning():
    rig = limb()
    frame = rig.body(joints=joints(rig, strength=0.0)).deform(rig.bent(0.8))
    np.testing.assert_allclose(frame.positions, frame.skinned, atol=1e-14)


def test_a_silenced_joint_keeps_its_loss():
    rig = limb(bone_count=3)
    silenced = [turgor.presets.isotropic(2, strength=0.0)]
    body = rig.body(joints=silenced)
    report = body.deform(rig.bent(0.9)).report
    losses = dict(zip(body.joint_bones, report.joint_losses, strict=True))
    rest = rig.surface.mesh().volume(rig.surface.positions)
    assert report.corrected_volumes.sum() == pytest.approx(rest - losses[2], rel=1e-11)


@given(seeds, st.floats(0.5, 1.5), st.sampled_from(["simultaneous", "sequential"]))
def test_breathing_reaches_its_target(seed: int, target_scale: float, solver):
    rig = limb()
    body = rig.body(solver=solver)
    frame = body.deform(rig.random_pose(np.random.default_rng(seed), 0.8), target_scale=target_scale)
    rest = rig.surface.mesh().volume(rig.surface.positions)
    assert frame.report.relative_error <= 1e-12
    assert rig.surface.mesh().volume(frame.positions) == pytest.approx(target_scale * rest, rel=1e-12)


def test_breathing_at_rest_moves_the_mesh():
    rig = limb()
    frame = rig.body().deform(rig.rest_pose(), target_scale=1.1)
    assert frame.report.relative_error <= 1e-12
    assert frame.report.max_displacement > 0.0


@given(seeds)
def test_solvers_agree_in_volume(seed: int):
    rig = limb(bone_count=4)
    pose = rig.random_pose(np.random.default_rng(seed), 0.9)
    volumes = [
        rig.surface.mesh().volume(rig.body(solver=solver).deform(pose).positions)
        for solver in ("simultaneous", "sequential")
    ]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-12)


def test_size_scales_the_joint_length():
    rig = limb()
    single, double = (rig.body(joints=joints(rig, size=size)).joint_lengths for size in (1.0, 2.0))
    np.testing.assert_allclose(double, 2.0 * single)


def test_with_joints_is_binding_again():
    rig = limb()
    settings = [turgor.presets.muscle(bone) for bone in range(rig.bone_count)]
    changed = rig.body().with_joints(settings, solver="sequential", keep_bone_scale=False)
    bound = rig.body(joints=settings, solver="sequential", keep_bone_scale=False)
    assert np.array_equal(changed.deform(rig.bent(0.8)).positions, bound.deform(rig.bent(0.8)).positions)


@pytest.mark.parametrize("width", [0.02, 0.05, 0.1])
@pytest.mark.parametrize("is_ring", [False, True])
def test_narrow_profiles_move_little_and_stay_exact(width: float, is_ring: bool):
    rig = chain(tube(rings=161, sides=24), 3)
    needle = np.exp(-((np.linspace(-1.0, 1.0, 401) / width) ** 2))
    across = np.ones(2) if is_ring else needle
    body = rig.body(joints=[turgor.Joint(bone, profiles=(needle, across, across)) for bone in range(3)])
    report = body.deform(rig.bent(1.2)).report
    assert report.relative_error <= 1e-12
    assert report.max_displacement < 0.2 * body.joint_lengths.max()


def test_a_profile_too_narrow_for_its_volume_is_reported():
    rig = chain(tube(rings=161, sides=24), 3)
    needle = np.exp(-((np.linspace(-1.0, 1.0, 401) / 0.02) ** 2))
    ring = [turgor.Joint(bone, profiles=(needle, np.ones(2), np.ones(2))) for bone in range(3)]
    assert rig.body(joints=ring).deform(rig.bent(1.2)).report.joint_is_capped.any()
    assert not rig.body().deform(rig.bent(1.2)).report.joint_is_capped.any()


def test_figures_of_the_report_agree():
    rig = limb()
    frame = rig.body().deform(rig.bent(0.9))
    report = frame.report
    moved = np.linalg.norm(frame.positions - frame.skinned, axis=1).max()
    assert report.max_displacement == pytest.approx(moved, rel=1e-6)
    assert report.joint_regained.sum() == pytest.approx(report.joint_losses.sum(), rel=0.2)
    assert report.joint_displacements.sum() >= 0.9 * moved
    assert rig.surface.mesh().component_volumes(frame.positions) == pytest.approx(report.corrected_volumes, rel=1e-13)


def test_vertices_out_of_reach_hardly_move():
    """They take part only in what is shared by the whole shell: a thousandth."""
    rig = chain(tube(rings=121, sides=12, length=12.0), 12, length=12.0)
    local = [np.eye(4)] * 12
    local[3] = rotation([0.0, 0.0, 1.0], 0.9)
    frame = rig.body().deform(rig.pose(local))
    is_far = rig.surface.positions[:, 0] > 9.0
    assert np.abs(frame.offsets[is_far]).max() < 1e-3 * np.abs(frame.offsets).max()


class TestShapeKeys:
    """A shape key is the artist's intent: it moves the target."""

    rig = limb()
    swollen = (rig.surface.positions * [0.0, 0.3, 0.3])[None]

    def body(self) -> turgor.VolumeSkin:
        return turgor.VolumeSkin(self.rig.surface.mesh(), self.rig.skinning(), shape_deltas=self.swollen)

    @pytest.mark.parametrize("value", [-0.5, 0.0, 0.5, 1.0])
    def test_key_is_kept_at_rest(self, value: float):
        frame = self.body().deform(self.rig.rest_pose(), shape_values=[value])
        np.testing.assert_allclose(frame.positions, self.rig.surface.positions + value * self.swollen[0], atol=1e-11)

    @pytest.mark.parametrize("value", [-0.5, 0.0, 0.5, 1.0])
    def test_posed_volume_is_that_of_the_key(self, value: float):
        shaped = self.rig.surface.positions + value * self.swollen[0]
        mesh = self.rig.surface.mesh()
        pose = self.rig.bent(0.8)
        frame = self.body().deform(pose, shape_values=[value])
        np.testing.assert_allclose(frame.skinned, self.rig.skinning().deform(shaped, pose), atol=1e-12)
        assert mesh.volume(frame.positions) == pytest.approx(mesh.volume(shaped), rel=1e-12)


@pytest.mark.parametrize("rings", [277, 4167])
def test_memory_per_vertex(rings: int):
    """At about 6,600 and 100,000 vertices, 17 bones."""
    rig = chain(tube(rings, sides=24, length=17.0), 17, length=17.0)
    assert rig.body().memory_bytes <= 400 * len(rig.surface.positions)
