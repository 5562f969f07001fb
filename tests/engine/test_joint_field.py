"""The field of a joint as an overlay draws it (MATH 3, 4)."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Rig, applied, chain, limb, random_rigid_motion, rotation, translation
from surfaces import strip, tube

seeds = st.integers(0, 2**32 - 1)
X = np.linspace(-1.0, 1.0, 65)
CURVES = (np.exp(-((X + 0.2) ** 2) * 4.0), 1.0 - 0.5 * X**2, np.maximum(X, 0.0) * (1.0 - X**2))


def fields(rig: Rig, pose: np.ndarray, profiles=None, **settings) -> list[turgor.JointField]:
    joints = [turgor.Joint(bone, profiles=profiles, **settings) for bone in range(rig.bone_count)]
    body = rig.body(joints=joints)
    return [body.joint_field(bone, pose) for bone in range(rig.bone_count)]


def in_lengths(field: turgor.JointField, points: np.ndarray) -> np.ndarray:
    """(N, 3) places in the joint's frame, units of its length."""
    return np.linalg.solve(field.axes.T * field.length, (points - field.origin).T).T


@given(seeds)
def test_frame_is_that_of_the_bones(seed: int):
    rig = limb(bone_count=4)
    pose = rig.random_pose(np.random.default_rng(seed), 1.0)
    heads = np.array([applied(pose[bone], rig.rest_matrices[bone][:3, 3]) for bone in range(4)])
    along = np.diff(heads, axis=0)
    body = rig.body()
    for bone in (1, 2):
        field = body.joint_field(bone, pose)
        e0, own = (v / np.linalg.norm(v) for v in along[bone - 1 : bone + 1])
        bend = np.cross(e0, own)
        np.testing.assert_allclose(field.origin, heads[bone], atol=1e-12)
        np.testing.assert_allclose(field.axes[0], e0, atol=1e-12)
        np.testing.assert_allclose(field.axes[1], bend / np.linalg.norm(bend), atol=1e-9)
        np.testing.assert_allclose(field.axes[2], np.cross(field.axes[1], field.axes[0]), atol=1e-12)
        assert field.length == pytest.approx(body.joint_lengths[list(body.joint_bones).index(bone)])
        sine_squared = float(bend @ bend)
        assert field.axes_share == pytest.approx(sine_squared / (sine_squared + 0.04), rel=1e-9)


@pytest.mark.parametrize("twist", [0.0, 0.7])
def test_straight_pose_has_no_share_and_some_axes(twist: float):
    rig = limb()
    field = fields(rig, rig.bent(0.0, twist), CURVES)[1]
    assert field.axes_share <= 1e-12
    np.testing.assert_allclose(field.axes @ field.axes.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(field.axes[0], [1.0, 0.0, 0.0], atol=1e-12)


def test_inside_of_the_bend_is_where_the_limb_goes():
    rig = limb(bone_count=2)
    field = rig.body().joint_field(1, rig.bent(1.0))
    np.testing.assert_allclose(field.axes, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]], atol=1e-12)


@given(seeds)
def test_gamma_is_the_profiles_over_the_vicinity(seed: int):
    rig = limb(rings=65, sides=16)
    pose = rig.random_pose(np.random.default_rng(seed), 1.2)
    skinned = rig.skinning().deform(rig.surface.positions, pose)
    bells, drawn = fields(rig, pose), fields(rig, pose, CURVES)
    for bell, field in zip(bells, drawn, strict=True):
        place = in_lengths(field, skinned)
        round_height = np.maximum(1.0 - (place**2).sum(axis=1) / 0.5, 0.0) ** 8
        is_near = round_height > 1e-3
        vicinity = bell.gamma[is_near] / round_height[is_near]
        assert (vicinity <= 1.0 + 1e-4).all()
        heights = np.prod([np.interp(x, X, y, 0.0, 0.0) for x, y in zip(place[is_near].T, CURVES, strict=True)], axis=0)
        expected = field.axes_share * heights + (1.0 - field.axes_share) * round_height[is_near]
        np.testing.assert_allclose(field.gamma[is_near], vicinity * expected, rtol=2e-3, atol=1e-5)


def test_gamma_is_where_the_correction_goes():
    """One joint gives back: what moves has gamma, but for the thousandth that the whole shell takes."""
    rig = chain(tube(rings=121, sides=12, length=12.0), 6, length=12.0)
    local = [np.eye(4)] * 6
    local[3] = rotation([0.0, 0.0, 1.0], 0.9)
    pose = rig.pose(local)
    body = rig.body()
    gamma = body.joint_field(3, pose).gamma
    moved = np.linalg.norm(body.deform(pose).offsets, axis=1)
    assert moved[gamma == 0.0].max() < 2e-3 * moved.max()
    assert moved[gamma > 0.5].min() > 2e-3 * moved.max()


def test_gamma_does_not_depend_on_density():
    """The field divides by the vertex's area, gamma does not: it is smooth where the mesh is not."""
    coarse, fine = limb(rings=33, sides=12), limb(rings=65, sides=12)
    shared = np.isclose(fine.surface.positions[:, :1] * 8.0 % 1.0, 0.0).ravel()
    results = [rig.body().joint_field(1, rig.bent(0.5)).gamma for rig in (coarse, fine)]
    assert results[0].max() > 0.3
    np.testing.assert_allclose(results[0], results[1][shared], atol=0.02)


@given(seeds)
def test_field_moves_with_the_whole(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb()
    pose, move = rig.random_pose(rng, 0.8), random_rigid_motion(rng)
    body = rig.body(joints=[turgor.Joint(bone, profiles=CURVES) for bone in range(3)])
    still, moved = body.joint_field(1, pose), body.joint_field(1, move @ pose)
    np.testing.assert_allclose(moved.origin, applied(move, still.origin[None])[0], atol=1e-11)
    np.testing.assert_allclose(moved.axes, still.axes @ move[:3, :3].T, atol=1e-9)
    np.testing.assert_allclose(moved.gamma, still.gamma, atol=1e-4)
    assert moved.length == pytest.approx(still.length)


@given(seeds)
def test_object_space_is_where_the_mesh_is(seed: int):
    """An armature of another scale, turned, stretched: the frame's places are the same places of the body."""
    rng = np.random.default_rng(seed)
    rig = limb()
    pose = rig.random_pose(rng, 0.8)
    stretch = np.diag([*rng.uniform(0.5, 2.0, 3), 1.0])
    object_from_armature = random_rigid_motion(rng) @ stretch @ np.diag([100.0, 100.0, 100.0, 1.0])
    surface = rig.surface.moved(applied(object_from_armature, rig.surface.positions))
    other = rig.with_surface(surface).body(object_from_armature=object_from_armature)
    plain = rig.body().joint_field(1, pose)
    field = other.joint_field(1, pose, object_from_armature=object_from_armature)
    corners = rng.uniform(-1.0, 1.0, (5, 3))
    places = [f.origin + f.length * (corners @ f.axes) for f in (plain, field)]
    np.testing.assert_allclose(places[1], applied(object_from_armature, places[0]), rtol=1e-9, atol=1e-7)
    np.testing.assert_allclose(field.gamma, plain.gamma, atol=1e-4)


def test_folding_shows_in_gamma():
    """Belly folds as more is lost: so does its gamma, and less strength folds less."""
    rig = limb(rings=65, sides=16)
    pose = rig.bent(1.2)
    body = rig.body(joints=[turgor.presets.belly(1)])
    gammas = [body.joint_field(1, pose, strengths=[s, s, s]).gamma for s in (0.0, 0.5, 1.0)]
    steps = [np.abs(gamma - gammas[0]).max() for gamma in gammas]
    assert 0.0 < steps[1] < steps[2]


@given(seeds, st.floats(0.01, 1.0))
def test_each_profile_turns_into_its_second_as_the_loss_grows(seed: int, most: float):
    rng = np.random.default_rng(seed)
    rig = limb(rings=65, sides=16)
    pose = rig.random_pose(rng, 1.0)
    second = (np.maximum(X, 0.0), 1.0 - X**4, 0.2 + np.abs(X))
    settings = {"folded_profiles": second, "folded_loss_relative": most}
    body = rig.body(joints=[turgor.Joint(bone, profiles=CURVES, **settings) for bone in range(3)])
    losses = dict(zip(body.joint_bones, body.deform(pose).report.joint_losses, strict=True))
    skinned = rig.skinning().deform(rig.surface.positions, pose)
    constant = fields(rig, pose, (np.ones(2),) * 3)
    for bone in (1, 2):
        field, everywhere, bell = (
            f[bone] for f in (fields(rig, pose, CURVES, **settings), constant, fields(rig, pose))
        )
        part = min(abs(losses[bone]) / (most * 0.1 * field.length**3), 1.0)
        x = in_lengths(field, skinned).T
        first_heights, second_heights = (
            [np.interp(xi, X, y, 0.0, 0.0) for xi, y in zip(x, curves, strict=True)] for curves in (CURVES, second)
        )
        heights = np.prod(
            [(1 - part) * f + part * g for f, g in zip(first_heights, second_heights, strict=True)], axis=0
        )
        rounds = (1.0 - field.axes_share) * bell.gamma
        drawn, whole = field.gamma - rounds, everywhere.gamma - rounds
        inside = (np.abs(x) < 0.999).all(axis=0)
        np.testing.assert_allclose(drawn[inside], (whole * heights)[inside], atol=2e-3)


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
def test_folding_to_the_end_is_having_the_second_profiles(solver):
    rig = limb(rings=65, sides=16)
    pose = rig.bent(1.0)
    second = (1.0 - X**2, np.maximum(X, 0.0), 1.0 - X**4)

    def deformed(profiles, **settings) -> np.ndarray:
        joints = [turgor.Joint(bone, (0.2, 0.3, 0.5), profiles, **settings) for bone in range(3)]
        return rig.body(joints=joints, solver=solver).deform(pose).positions

    folded = deformed(CURVES, folded_profiles=second, folded_loss_relative=1e-6)
    np.testing.assert_allclose(folded, deformed(second), atol=1e-6)
    hardly = deformed(CURVES, folded_profiles=second, folded_loss_relative=1e9)
    np.testing.assert_allclose(hardly, deformed(CURVES), atol=1e-6)
    assert np.abs(folded - hardly).max() > 1e-3
    assert np.array_equal(deformed(CURVES, folded_profiles=CURVES), deformed(CURVES))


def test_folded_profiles_that_are_none():
    with pytest.raises(turgor.TurgorError, match="folded_profiles: need profiles too"):
        turgor.Joint(0, folded_profiles=CURVES)
    with pytest.raises(turgor.TurgorError, match="profile: found 1 values, need 2"):
        turgor.Joint(0, profiles=CURVES, folded_profiles=([1.0], *CURVES[1:]))
    with pytest.raises(turgor.TurgorError, match="folded_loss_relative is 0, need a number from 1e-12 to 1e12"):
        turgor.Joint(0, profiles=CURVES, folded_profiles=CURVES, folded_loss_relative=0.0)


def test_shells_without_an_inside_have_no_gamma():
    both = tube(33, 12).joined(strip())
    rig = chain(both, 3)
    gamma = rig.body().joint_field(1, rig.bent(0.5)).gamma
    assert gamma.shape == (len(both.positions),)
    assert gamma.dtype == np.float32
    assert not gamma[-len(strip().positions) :].any()
    assert gamma.any()


def test_joint_field_leaves_frames_alone():
    rig = limb()
    body = rig.body()
    pose = rig.bent(0.8)
    before = body.deform(pose).positions
    body.joint_field(1, rig.bent(0.3))
    assert np.array_equal(body.deform(pose).positions, before)


def test_a_bone_without_a_joint_is_an_error():
    rig = limb(bone_count=3)
    # A fourth bone that holds nothing.
    far = np.append(rig.rest_matrices, [translation([9.0, 0.0, 0.0])], axis=0)
    more = Rig(rig.surface, np.append(rig.parents, 2).astype(np.int32), far, rig.bones, rig.weights)
    body = more.body()
    pose = more.rest_pose()
    for bone in (3, 4, 10**6):
        with pytest.raises(turgor.TurgorError, match=f"bone {bone} has no joint"):
            body.joint_field(bone, pose)
    with pytest.raises(turgor.TurgorError, match="index of 0 or more"):
        body.joint_field(-1, pose)
    with pytest.raises(turgor.TurgorError, match="pose has 3 bones"):
        body.joint_field(0, pose[:3])
