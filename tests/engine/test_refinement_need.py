"""Where poses ask for more vertices: the most of all joints and frames, of those that lose volume."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Rig, applied, limb, random_rigid_motion

seeds = st.integers(0, 2**32 - 1)
X = np.linspace(-1.0, 1.0, 129)
FLAT = np.ones(129)
# The part of its vicinity's volume from which on a loss counts in full; a vicinity is a tenth of the length cubed.
IN_FULL, VICINITY = 0.02, 0.1


def waves(frequency: float) -> np.ndarray:
    return np.square(np.sin(np.pi * frequency * X))


def counted(body: turgor.VolumeSkin, pose: np.ndarray) -> dict[int, float]:
    losses = body.deform(pose).report.joint_losses
    parts = np.abs(losses) / (VICINITY * body.joint_lengths**3 * IN_FULL)
    return dict(zip(body.joint_bones.tolist(), np.minimum(parts, 1.0).tolist(), strict=True))


def strongest(body: turgor.VolumeSkin, poses: np.ndarray) -> np.ndarray:
    """The same joint by joint and pose by pose."""
    found = np.zeros(body.mesh.vertex_count)
    for pose in poses:
        for bone, part in counted(body, pose).items():
            found = np.maximum(found, part * body.joint_field(bone, pose).gamma)
    return found


def random_poses(rig: Rig, seed: int, count: int = 4) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.array([rig.random_pose(rng, rng.uniform(0.0, 1.0)) for _ in range(count)])


@given(seeds)
def test_gamma_is_the_largest_of_all_joints_and_poses(seed: int):
    rig = limb(bone_count=4)
    body, poses = rig.body(), random_poses(rig, seed)
    np.testing.assert_allclose(body.refinement_need(poses).gamma, strongest(body, poses), atol=1e-5)


@given(seeds)
def test_folds_are_filled_in(seed: int):
    """Valleys between folds are as high as the lower of the folds beside them, and nothing is lower than gamma."""
    rig = limb(rings=65)
    joints = [turgor.Joint(bone, (0.0, 0.5, 0.5), (waves(3.0), FLAT, FLAT)) for bone in range(3)]
    body, poses = rig.body(joints=joints), random_poses(rig, seed)
    filled = rig.body(joints=[turgor.Joint(bone, (0.0, 0.5, 0.5), (FLAT, FLAT, FLAT)) for bone in range(3)])
    need = body.refinement_need(poses).gamma
    assert (need >= strongest(body, poses) - 1e-5).all()
    assert (need <= strongest(filled, poses) + 1e-5).all()


@given(seeds, st.floats(0.01, 100.0))
def test_height_of_profiles_does_not_matter(seed: int, height: float):
    """Nor does it in a correction: only weights against each other count."""
    rig = limb()
    poses = random_poses(rig, seed)
    low, high = (
        rig.body(joints=[turgor.Joint(b, (0.1, 0.1, 0.8), (h * waves(3.0), FLAT, FLAT)) for b in range(3)])
        for h in (1.0, height)
    )
    np.testing.assert_allclose(low.refinement_need(poses).gamma, high.refinement_need(poses).gamma, atol=1e-6)


@given(seeds)
def test_poses_only_add_and_their_order_does_not_matter(seed: int):
    rig = limb()
    body, poses = rig.body(joints=[turgor.presets.belly(bone) for bone in range(3)]), random_poses(rig, seed, 6)
    some, all_poses = body.refinement_need(poses[:3]), body.refinement_need(poses)
    assert (all_poses.gamma >= some.gamma).all()
    assert (all_poses.edge_lengths <= some.edge_lengths).all()
    shuffled = body.refinement_need(np.random.default_rng(seed).permutation(np.concatenate([poses, poses])))
    assert np.array_equal(shuffled.gamma, all_poses.gamma)
    assert np.array_equal(shuffled.edge_lengths, all_poses.edge_lengths)


@pytest.mark.parametrize("what", ["rest", "no strength", "no poses", "masked"])
def test_where_nothing_comes_back_nothing_is_needed(what: str):
    rig = limb()
    body = rig.body(joints=[turgor.presets.folds(bone) for bone in range(3)])
    poses = np.array([rig.bent(0.8)])
    if what == "rest":
        poses = np.array([rig.rest_pose()])
    elif what == "no strength":
        body = rig.body(joints=[turgor.Joint(bone, strength=0.0) for bone in range(3)])
    elif what == "no poses":
        poses = poses[:0]
    else:
        mask = (rig.surface.positions[:, 0] < 1.0).astype(np.float32)
        body = body.with_mask(mask)
    need = body.refinement_need(poses)
    is_still = need.gamma[rig.surface.positions[:, 0] >= 1.0] if what == "masked" else need.gamma
    assert not is_still.any() or (what == "rest" and is_still.max() < 1e-6)
    if what != "rest":
        assert np.isinf(need.edge_lengths[need.gamma == 0.0]).all()


@given(seeds, st.sampled_from([1e-3, 0.1, 100.0]))
def test_unit_and_place_do_not_matter(seed: int, scale: float):
    rng = np.random.default_rng(seed)
    rig = limb()
    poses = random_poses(rig, seed)
    plain = rig.body().refinement_need(poses)
    object_from_armature = random_rigid_motion(rng) @ np.diag([scale, scale, scale, 1.0])
    surface = rig.surface.moved(applied(object_from_armature, rig.surface.positions))
    body = rig.with_surface(surface).body(object_from_armature=object_from_armature)
    need = body.refinement_need(poses, object_from_armature=object_from_armature)
    np.testing.assert_allclose(need.gamma, plain.gamma, atol=1e-4)
    is_near = plain.gamma > 0.01
    np.testing.assert_allclose(need.edge_lengths[is_near], scale * plain.edge_lengths[is_near], rtol=1e-2)


@given(st.floats(0.01, 1.0))
def test_small_losses_count_in_proportion(part: float):
    """Half as much given back asks for half as much, below two per cent of the vicinity."""
    rig = limb()
    body, pose = rig.body(), rig.bent(0.05)
    full = counted(body, pose)
    assert max(full.values()) < 1.0
    weak, strong = (body.refinement_need(pose[None], strengths=[s] * 3) for s in (part, 1.0))
    np.testing.assert_allclose(weak.gamma, part * strong.gamma, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("frequency", [1.0, 2.0, 4.0])
def test_edges_are_as_short_as_folds_ask_for(frequency: float):
    """Waves of twice the frequency need edges half as long; and 5 % is what such edges miss of a wave."""
    rig = limb(rings=65, sides=16)
    pose = rig.bent(1.0)

    def lengths(waves_per_length: float) -> float:
        joint = turgor.Joint(1, (0.0, 0.5, 0.5), (waves(waves_per_length), FLAT, FLAT))
        off = [turgor.Joint(bone, strength=0.0) for bone in (0, 2)]
        body = rig.body(joints=[*off, joint])
        need, field = body.refinement_need(pose[None]), body.joint_field(1, pose)
        best = int(need.gamma.argmax())
        # Per joint length, where gamma is 1.
        return float(need.edge_lengths[best] * np.sqrt(need.gamma[best])) / field.length

    once, twice = lengths(frequency), lengths(2.0 * frequency)
    assert once / twice == pytest.approx(2.0, rel=0.15)
    # 1/2 - 1/2 cos(2 pi f x): chords of length h miss (1 - cos(pi f h)) / 2 of it.
    expected = np.arccos(1.0 - 0.05 * np.sqrt(3.0)) / (np.pi * frequency)
    assert once == pytest.approx(expected, rel=0.1)


def test_what_is_refused():
    rig = limb()
    poses = np.array([rig.bent(0.3), rig.bent(0.6)])
    poses[1, 0, 0, 0] = np.nan
    with pytest.raises(turgor.TurgorError, match="frame 1: "):
        rig.body().refinement_need(poses)
    with pytest.raises(turgor.TurgorError, match="fleshed: found 1 values, need 3"):
        rig.body().refinement_need(poses[:1], fleshed=[True])


def test_flesh_that_another_deformer_moves_needs_nothing():
    rig = limb()
    poses = np.array([rig.bent(0.7)])
    need = rig.body().refinement_need(
        poses, fleshed=[True] * 3, added_offsets=np.zeros((len(rig.bones), 3), np.float32)
    )
    assert not need.gamma.any()
