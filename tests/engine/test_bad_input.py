"""Wrong input is answered by a TurgorError that says what was found and what is needed; never by NaN or a crash."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import turgor
from rigs import limb
from surfaces import cube

RIG = limb()
BODY = RIG.body()
POSE = RIG.bent(0.5)
CUBE = cube()
COUNT = len(RIG.surface.positions)
ONES = np.ones(COUNT)


def with_entry(array: np.ndarray, index: tuple[int, ...], value: float) -> np.ndarray:
    """A copy with one entry replaced."""
    changed = array.copy()
    changed[index] = value
    return changed


def mesh_of(positions=CUBE.positions, offsets=CUBE.face_offsets, corners=CUBE.face_corners) -> turgor.Mesh:
    return turgor.Mesh(positions, offsets, corners)


def skinning_of(offsets, bones, weights, mask=None) -> turgor.Skinning:
    return turgor.Skinning(RIG.skeleton(), offsets, bones, weights, "linear", mask)


OFFSETS = np.arange(0, 3 * COUNT + 1, 3, dtype=np.int32)
BONES = RIG.bones.ravel()
WEIGHTS = RIG.weights.ravel()

CASES: dict[str, Callable[[], object]] = {
    "mesh: positions of two columns": lambda: mesh_of(np.zeros((8, 2))),
    "mesh: position not a number": lambda: mesh_of(with_entry(CUBE.positions, (3, 1), np.nan)),
    "mesh: position infinite": lambda: mesh_of(with_entry(CUBE.positions, (3, 1), np.inf)),
    "mesh: corner out of range": lambda: mesh_of(corners=with_entry(CUBE.face_corners, (0,), 8)),
    "mesh: corner negative": lambda: mesh_of(corners=with_entry(CUBE.face_corners, (0,), -1)),
    "mesh: face of two corners": lambda: mesh_of(
        offsets=np.array([0, 2], np.int32), corners=np.array([0, 1], np.int32)
    ),
    "mesh: offsets beyond the corners": lambda: mesh_of(offsets=with_entry(CUBE.face_offsets, (6,), 40)),
    "mesh: offsets that go down": lambda: mesh_of(offsets=with_entry(CUBE.face_offsets, (2,), 0)),
    "mesh: no offsets": lambda: mesh_of(offsets=np.zeros(0, np.int32)),
    "volume: another vertex count": lambda: CUBE.mesh().volume(np.zeros((9, 3))),
    "gradient: another vertex count": lambda: CUBE.mesh().volume_gradient(np.zeros((9, 3))),
    "volume: position not a number": lambda: CUBE.mesh().volume(with_entry(CUBE.positions, (0, 0), np.nan)),
    "skeleton: a cycle": lambda: turgor.Skeleton([1, 0], np.array([np.eye(4)] * 2)),
    "skeleton: its own parent": lambda: turgor.Skeleton([0], np.array([np.eye(4)])),
    "skeleton: parent out of range": lambda: turgor.Skeleton([-1, 7], np.array([np.eye(4)] * 2)),
    "skeleton: matrices of three rows": lambda: turgor.Skeleton([-1], np.zeros((1, 3, 3))),
    "skeleton: matrix missing": lambda: turgor.Skeleton([-1, 0], np.array([np.eye(4)])),
    "skeleton: matrix not a number": lambda: turgor.Skeleton([-1], np.full((1, 4, 4), np.nan)),
    "skinning: bone out of range": lambda: skinning_of(OFFSETS, with_entry(BONES, (0,), 99), WEIGHTS),
    "skinning: weight missing": lambda: skinning_of(OFFSETS, BONES, WEIGHTS[:-1]),
    "skinning: weight not a number": lambda: skinning_of(OFFSETS, BONES, with_entry(WEIGHTS, (0,), np.nan)),
    "skinning: mask of another count": lambda: skinning_of(OFFSETS, BONES, WEIGHTS, np.ones(3)),
    "skinning: unknown mode": lambda: turgor.Skinning(
        RIG.skeleton(),
        OFFSETS,
        BONES,
        WEIGHTS,
        "cubic",  # pyright: ignore[reportArgumentType]
    ),
    "body: mesh and weights of different counts": lambda: turgor.VolumeSkin(CUBE.mesh(), RIG.skinning()),
    "body: joint of no bone": lambda: RIG.body(joints=[turgor.Joint(99)]),
    "body: one bone twice": lambda: RIG.body(joints=[turgor.Joint(1), turgor.Joint(1)]),
    "body: shape deltas of another count": lambda: turgor.VolumeSkin(
        RIG.surface.mesh(), RIG.skinning(), shape_deltas=np.zeros((1, 3, 3))
    ),
    "joint: negative share": lambda: turgor.Joint(0, (-1.0, 1.0, 1.0)),
    "joint: no share at all": lambda: turgor.Joint(0, (0.0, 0.0, 0.0)),
    "joint: negative strength": lambda: turgor.Joint(0, strength=-1.0),
    "joint: strength not a number": lambda: turgor.Joint(0, strength=np.nan),
    "joint: no size": lambda: turgor.Joint(0, size=0.0),
    "joint: profile of one sample": lambda: turgor.Joint(0, profiles=([1.0], [1.0, 1.0], [1.0, 1.0])),
    "pose: not a number": lambda: BODY.deform(with_entry(POSE, (1, 0, 0), np.nan)),
    "pose: infinite": lambda: BODY.deform(with_entry(POSE, (1, 0, 3), np.inf)),
    "pose: of another rig": lambda: BODY.deform(POSE[:-1]),
    "pose: three rows": lambda: BODY.deform(POSE[:, :3]),
    "object matrix without inverse": lambda: BODY.deform(POSE, object_from_armature=np.diag([1.0, 1.0, 0.0, 1.0])),
    "object matrix not a number": lambda: BODY.deform(POSE, object_from_armature=np.full((4, 4), np.nan)),
    "target: not a number": lambda: BODY.deform(POSE, target_scale=np.nan),
    "strengths of another rig": lambda: BODY.deform(POSE, strengths=[1.0]),
    "strengths: negative": lambda: BODY.deform(POSE, strengths=[1.0, -1.0, 1.0]),
    "shape values without shape keys": lambda: BODY.deform(POSE, shape_values=[1.0]),
    "offsets of another count": lambda: BODY.deform_into(np.zeros((3, 3), np.float32), POSE),
    "offsets of another type": lambda: BODY.deform_into(np.zeros((COUNT, 3)), POSE),  # pyright: ignore
    "address of another count": lambda: BODY.deform_into_address(np.zeros((COUNT, 3), np.float32).ctypes.data, 3, POSE),
    "address zero": lambda: BODY.deform_into_address(0, COUNT, POSE),
    "skinning: positions of another count": lambda: RIG.skinning().deform(CUBE.positions, POSE),
    "correct: weights of another count": lambda: turgor.correct(CUBE.mesh(), CUBE.positions, 1.5, ONES),
    "correct: negative weight": lambda: turgor.correct(CUBE.mesh(), CUBE.positions, 1.5, -np.ones(8)),
    "correct: target not a number": lambda: turgor.correct(CUBE.mesh(), CUBE.positions, np.nan, np.ones(8)),
    "correct: targets of another count": lambda: turgor.correct(CUBE.mesh(), CUBE.positions, [1.0, 2.0], np.ones(8)),
    "correct: axes of two rows": lambda: turgor.correct(CUBE.mesh(), CUBE.positions, 1.5, np.ones(8), np.eye(3)[:2]),
}


@pytest.mark.parametrize("case", CASES)
def test_wrong_input_is_an_error_that_says_what_is_needed(case: str):
    with pytest.raises(turgor.TurgorError) as caught:
        CASES[case]()
    message = str(caught.value)
    assert len(message) > 15
    assert "NdArray" not in message
    assert "PyArray" not in message


def test_errors_are_value_errors():
    assert issubclass(turgor.TurgorError, ValueError)


def test_a_shape_error_names_argument_found_and_needed():
    with pytest.raises(turgor.TurgorError, match=r"positions.*\(N, 3\).*\(8, 2\)"):
        mesh_of(np.zeros((8, 2)))


def test_a_vertex_count_error_tells_both_counts():
    with pytest.raises(turgor.TurgorError, match=r"(?s)9.*8|8.*9"):
        CUBE.mesh().volume(np.zeros((9, 3)))


class TestUnusualButFine:
    """Odd, not wrong: the result is finite and nothing that should stay is moved."""

    def test_bones_at_one_point(self):
        rest = np.array([np.eye(4)] * RIG.bone_count)
        skeleton = turgor.Skeleton(RIG.parents, rest)
        body = turgor.VolumeSkin(RIG.surface.mesh(), turgor.Skinning(skeleton, OFFSETS, BONES, WEIGHTS))
        assert np.isfinite(body.deform(POSE).positions).all()

    def test_negative_profile_samples_count_as_zero(self):
        def bent_with(along: list[float]) -> np.ndarray:
            curves = (along, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0])
            return RIG.body(joints=[turgor.Joint(1, profiles=curves)]).deform(POSE).positions

        clamped = bent_with([0.0, 1.0, 0.0])
        assert (bent_with([-3.0, 1.0, -0.5]) == clamped).all()
        assert (bent_with([3.0, 1.0, 0.5]) != clamped).any()

    def test_no_vertices(self):
        empty = turgor.Mesh(np.zeros((0, 3)), np.zeros(1, np.int32), np.zeros(0, np.int32))
        skinning = skinning_of(np.zeros(1, np.int32), np.zeros(0, np.int32), np.zeros(0))
        frame = turgor.VolumeSkin(empty, skinning).deform(POSE)
        assert frame.positions.shape == (0, 3)

    def test_no_weights(self):
        skinning = skinning_of(np.zeros(COUNT + 1, np.int32), np.zeros(0, np.int32), np.zeros(0))
        frame = turgor.VolumeSkin(RIG.surface.mesh(), skinning).deform(POSE)
        np.testing.assert_allclose(frame.positions, RIG.surface.positions, atol=1e-14)

    def test_bone_scaled_to_nothing(self):
        pose = POSE.copy()
        pose[1, :3, :3] = 0.0
        assert np.isfinite(BODY.deform(pose).positions).all()

    def test_everything_scaled_to_nothing(self):
        pose = POSE.copy()
        pose[:, :3, :3] = 0.0
        assert np.isfinite(BODY.deform(pose).positions).all()

    def test_unsound_component_stays_as_skinned(self):
        both = RIG.surface.joined(CUBE.moved(CUBE.positions * [0.5, 0.5, 0.0]))
        bones = np.concatenate([BONES, np.tile([0, 1, 2], 8)]).astype(np.int32)
        weights = np.concatenate([WEIGHTS, np.tile([0.3, 0.3, 0.4], 8)])
        skinning = skinning_of(np.arange(0, len(bones) + 1, 3, dtype=np.int32), bones, weights)
        frame = turgor.VolumeSkin(both.mesh(), skinning).deform(POSE)
        assert np.array_equal(frame.positions[COUNT:], frame.skinned[COUNT:])
        assert frame.report.relative_error <= 1e-12
        assert frame.report.corrected_volumes[-1] == 0.0
