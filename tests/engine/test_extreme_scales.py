"""At any scale every call gives numbers or says what is too large or too small: never NaN or infinity."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Rig, limb, translation
from spines import Method, helix, line
from surfaces import cube

RIG = limb(bone_count=3, rings=9, sides=6)
COUNT = len(RIG.surface.positions)
FIGURES = (
    "skinned_volumes",
    "target_volumes",
    "corrected_volumes",
    "joint_losses",
    "joint_regained",
    "joint_displacements",
    "seam_gap",
    "max_displacement",
)

scales = st.one_of(st.floats(-150.0, 150.0), st.floats(-20.0, 20.0)).map(lambda exponent: 10.0**exponent)
factors = st.one_of(st.just(1.0), scales)


T = TypeVar("T")


def or_refused(call: Callable[[], T]) -> T | None:
    """What a call makes; None where it says that numbers are out of range, and which."""
    try:
        return call()
    except turgor.TurgorError as error:
        message = str(error)
        words = ("need", "no inverse", "beyond all numbers", "lets nothing move")
        assert any(word in message for word in words), message
        return None


def scaled(matrix: np.ndarray, by: float) -> np.ndarray:
    result = matrix.copy()
    result[..., :3, 3] *= by
    return result


def finite(*arrays: object) -> bool:
    return all(np.isfinite(np.asarray(array, float)).all() for array in arrays)


@given(scales, factors, factors, factors, st.sampled_from(["linear", "dual_quaternion"]), st.booleans())
def test_frames(mesh_scale: float, bone_scale: float, pose_scale: float, object_scale: float, mode, repair_folds: bool):
    rig: Rig = RIG
    positions = rig.surface.positions * mesh_scale
    mesh = or_refused(lambda: turgor.Mesh(positions, rig.surface.face_offsets, rig.surface.face_corners))
    skeleton = or_refused(lambda: turgor.Skeleton(rig.parents, scaled(rig.rest_matrices, bone_scale)))
    if mesh is None or skeleton is None:
        return
    assert finite(mesh.volume(positions), mesh.volume_gradient(positions))
    offsets = np.arange(0, rig.bones.size + 1, rig.bones.shape[1])
    skinning = turgor.Skinning(skeleton, offsets, rig.bones.ravel(), rig.weights.ravel(), mode)
    skin = or_refused(lambda: turgor.VolumeSkin(mesh, skinning))
    if skin is None:
        return
    pose = scaled(rig.bent(1.0), bone_scale)
    pose[1, :3, :3] *= pose_scale
    place = np.diag([object_scale] * 3 + [1.0])
    frame = or_refused(lambda: skin.deform(pose, repair_folds=repair_folds, object_from_armature=place))
    if frame is None:
        return
    assert finite(frame.positions, frame.skinned, frame.offsets)
    assert finite(*(getattr(frame.report, figure) for figure in FIGURES))
    assert finite(skin.joint_lengths)
    assert finite(skin.deform_many(pose[None], repair_folds=repair_folds, object_from_armature=place))
    assert finite(skin.measure(pose[None], object_from_armature=place).corrected_volumes)


@given(scales, scales, scales)
def test_far_away(mesh_place: float, bone_place: float, pose_place: float):
    positions = RIG.surface.positions + mesh_place
    mesh = or_refused(lambda: turgor.Mesh(positions, RIG.surface.face_offsets, RIG.surface.face_corners))
    rest = RIG.rest_matrices.copy()
    rest[:, :3, 3] += bone_place
    skeleton = or_refused(lambda: turgor.Skeleton(RIG.parents, rest))
    if mesh is None or skeleton is None:
        return
    offsets = np.arange(0, RIG.bones.size + 1, RIG.bones.shape[1])
    skinning = turgor.Skinning(skeleton, offsets, RIG.bones.ravel(), RIG.weights.ravel())
    skin = or_refused(lambda: turgor.VolumeSkin(mesh, skinning))
    pose = RIG.bent(1.0)
    pose[2] = translation([pose_place, 0, 0]) @ pose[2]
    frame = skin and or_refused(lambda: skin.deform(pose))
    if frame:
        assert finite(frame.positions, frame.offsets, frame.report.corrected_volumes, frame.report.max_displacement)


SKIN = RIG.body()
POSE = RIG.bent(1.0)


@given(scales, scales, scales, scales)
def test_settings(strength: float, size: float, target_scale: float, height: float):
    curve = np.array([0.0, height, 0.3 * height])

    def joint() -> turgor.Joint:
        return turgor.Joint(1, "auto", (curve, curve, curve), strength=strength, size=size)

    made = or_refused(joint)
    skin = SKIN if made is None else SKIN.with_joints([made])
    frame = or_refused(lambda: skin.deform(POSE, target_scale=target_scale))
    if frame is not None:
        assert finite(frame.positions, frame.offsets, frame.report.corrected_volumes, frame.report.max_displacement)
    added = np.full((COUNT, 3), min(strength, 3e38), np.float32)
    frame = or_refused(lambda: SKIN.deform(POSE, added_offsets=added, strengths=[size] * 3))
    if frame is not None:
        assert finite(frame.positions, frame.offsets, frame.report.corrected_volumes)


@given(scales, scales, scales)
def test_the_bare_correction(scale: float, volume: float, gamma: float):
    surface = cube()
    positions = surface.positions * scale
    mesh = or_refused(lambda: turgor.Mesh(positions, surface.face_offsets, surface.face_corners))
    if mesh is not None:
        weights = np.linspace(0.5, 1.0, len(positions)) * gamma
        for axes in (None, np.eye(3)):
            corrected = or_refused(lambda axes=axes: turgor.correct(mesh, positions, volume, weights, axes))
            assert corrected is None or finite(corrected)


@given(scales, scales, scales, st.sampled_from(["spline", "polynomial", "b_spline", "bezier", "nurbs", "poly"]))
def test_spines(rest_scale: float, posed_scale: float, point_scale: float, method: str):
    def spine(points: np.ndarray) -> turgor.Spine:
        if method == "bezier":
            return turgor.Spine.from_bezier(points, points - points[1] * 0.1, points + points[1] * 0.1)
        if method == "nurbs":
            return turgor.Spine.from_nurbs(points)
        if method == "poly":
            return turgor.Spine.from_poly(points)
        return turgor.Spine(points, cast("Method", method))

    rest, posed = or_refused(lambda: spine(line() * rest_scale)), or_refused(lambda: spine(helix() * posed_scale))
    if rest is None or posed is None:
        return
    places = or_refused(lambda: rest.evaluate(np.array([-1.0, 0.5, 2.0]) * point_scale))
    if places is not None:
        assert finite(places.positions, places.tangents, places.normals, places.curvatures, places.speeds)
    points = helix(12) * point_scale
    flesh = or_refused(lambda: turgor.Fleshing(rest, points, match="relative_length"))
    if flesh is None:
        return
    assert finite(rest.closest(points).distances, rest.closest(points).parameters)
    for match in ("relative_length", "length"):
        flesh = turgor.Fleshing(rest, points, match=match)
        bent = or_refused(lambda flesh=flesh: flesh.deform(posed, twist=1.0))
        assert bent is None or finite(bent)
        back = or_refused(lambda flesh=flesh: flesh.inverse(points, posed))
        assert back is None or finite(back)


@pytest.mark.parametrize("where", ["rest_positions", "positions", "pose_matrices", "rest_matrices"])
def test_what_is_too_large_is_said(where: str):
    far, matrix = np.full((8, 3), 1e20), np.eye(4)[None] * 1e20
    calls: dict[str, Callable[[], object]] = {
        "rest_positions": lambda: turgor.Mesh(far, cube().face_offsets, cube().face_corners),
        "positions": lambda: cube().mesh().volume(far),
        "pose_matrices": lambda: SKIN.deform(np.tile(matrix, (3, 1, 1))),
        "rest_matrices": lambda: turgor.Skeleton([-1], matrix),
    }
    with pytest.raises(turgor.TurgorError, match=rf"{where}: row 0 holds 1e20, need numbers up to 1e15 in size"):
        calls[where]()


def test_bones_that_take_the_mesh_too_far_are_named():
    pose = RIG.bent(0.0)
    pose[2, :3, :3] *= 1e15
    with pytest.raises(turgor.TurgorError, match="bone 2 takes the mesh as far as"):
        SKIN.deform(pose)
