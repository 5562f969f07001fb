"""Poses of the test range of motion: rotations about joints, followed by descendants and nobody else."""

from __future__ import annotations

import numpy as np
import pytest

from addon.logic import range_of_motion

#     0 - 1 - 2
#      \  3 - 4
PARENTS = [-1, 0, 1, 0, 3]
DESCENDANTS = {0: {0, 1, 2, 3, 4}, 1: {1, 2}, 2: {2}, 3: {3, 4}, 4: {4}}


def _rest(scale: float = 1.0) -> np.ndarray:
    random = np.random.default_rng(3)
    matrices = np.tile(np.eye(4), (len(PARENTS), 1, 1))
    for matrix in matrices:
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        matrix[:3, :3] = turn * np.sign(np.linalg.det(turn)) * scale
        matrix[:3, 3] = random.normal(size=3) * 5
    return matrices


def _of(found: np.ndarray, group: int) -> np.ndarray:
    return found[range_of_motion.TURNS_PER_JOINT * group :][: range_of_motion.TURNS_PER_JOINT]


@pytest.mark.parametrize("scale", [1.0, 100.0])
def test_each_joint_turns_itself_and_its_descendants_about_its_head(scale):
    rest = _rest(scale)
    found = range_of_motion.poses(PARENTS, rest, [[1], [3], [4]])
    assert found.shape == (3 * range_of_motion.TURNS_PER_JOINT, 5, 4, 4)
    for group, joint in enumerate([1, 3, 4]):
        for pose in _of(found, group):
            for bone in range(5):
                if bone not in DESCENDANTS[joint]:
                    assert (pose[bone] == np.eye(4)).all()
                    continue
                assert (pose[bone] == pose[joint]).all()
            turn = pose[joint, :3, :3].astype(np.float64)
            assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-6)
            assert np.linalg.det(turn) == pytest.approx(1.0, abs=1e-6)
            assert np.arccos((np.trace(turn) - 1.0) / 2.0) == pytest.approx(range_of_motion.ANGLE, abs=1e-6)
            assert np.allclose(pose[joint] @ rest[joint, :, 3], rest[joint, :, 3], atol=1e-5)


def test_turns_are_about_the_axes_of_the_bone_to_both_sides():
    rest = _rest()
    turns = _of(range_of_motion.poses(PARENTS, rest, [[2]]), 0)[:, 2].astype(np.float64)
    kept = [
        axis for turn in turns for axis in range(3) if np.allclose(turn[:3, :3] @ rest[2, :3, axis], rest[2, :3, axis])
    ]
    assert sorted(kept) == [0, 0, 1, 1, 2, 2]
    for one, other in zip(turns[::2], turns[1::2], strict=True):
        assert np.allclose(one @ other, np.eye(4), atol=1e-6)


def test_groups_turn_together_as_each_alone():
    """Joints in branches of their own make of their bones what they make alone."""
    rest = _rest()
    both = range_of_motion.poses(PARENTS, rest, [[1], [4]], group_count=1)
    first, second = range_of_motion.poses(PARENTS, rest, [[1]]), range_of_motion.poses(PARENTS, rest, [[4]])
    assert (both[:, [1, 2]] == first[:, [1, 2]]).all()
    assert (both[:, 4] == second[:, 4]).all()


def test_followers_of_two_turning_joints_follow_both():
    rest = _rest()
    found = range_of_motion.poses(PARENTS, rest, [[1], [2]], group_count=1).astype(np.float64)
    alone = range_of_motion.poses(PARENTS, rest, [[1], [2]]).astype(np.float64)
    expected = _of(alone, 0)[:, 2] @ _of(alone, 1)[:, 2]
    assert np.allclose(found[:, 2], expected, atol=1e-5)


@pytest.mark.parametrize("group_count", [None, 0, 1, 99])
def test_without_joints_there_are_no_poses(group_count):
    assert range_of_motion.poses(PARENTS, _rest(), [], group_count).shape == (0, 5, 4, 4)


def test_all_joints_bent_is_the_first_pose_in_one_group():
    rest = _rest()
    found = range_of_motion.all_bent(PARENTS, rest, [1, 3, 4])
    assert np.array_equal(found, range_of_motion.poses(PARENTS, rest, [[1], [3], [4]], 1)[:1])


def test_segments_share_the_angle_and_may_stand_in_any_order():
    """Parents after their children, as nodes of bendy bones do."""
    parents, rest = [-1, 3, 0, 2, 1], _rest()
    (found,) = _of(range_of_motion.poses(parents, rest, [[2, 3]]), 0)[:1].astype(np.float64)
    for bone in (2, 3):
        own = np.linalg.inv(found[parents[bone]]) @ found[bone]
        assert np.arccos((np.trace(own[:3, :3]) - 1.0) / 2.0) == pytest.approx(range_of_motion.ANGLE / 2.0, abs=1e-5)
    assert (found[0] == np.eye(4)).all()
    assert (found[1] == found[3]).all()
    assert (found[4] == found[3]).all()
