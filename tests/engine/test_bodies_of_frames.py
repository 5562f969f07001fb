"""A frame may bring its own body: all that follows from rest positions is that of a binding made at them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import turgor
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from reference_volume import mean_of_fans
from rigs import Mode, Rig, limb, random_rigid_motion
from surfaces import Surface, open_tube, tube
from test_exactness import EXACT
from test_one_frame_all_paths import careless_rig, poses_of, solvers, surfaces

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
# Sums of two bindings are taken about other centres and in another order.
ROUNDING = 1e-11


def other_body(surface: Surface, rng: np.random.Generator, amount: float = 0.1) -> NDArray[np.float32]:
    """The same mesh, bulged and bent and put elsewhere."""
    waves, phases = rng.normal(size=(3, 3)), rng.uniform(0.0, 6.0, 3)
    return (surface.positions + amount * np.sin(surface.positions @ waves + phases) + rng.normal(size=3)).astype("f4")


def bound_at(rig: Rig, body: NDArray[np.float32]) -> Rig:
    return rig.with_surface(rig.surface.moved(body.astype(float)))


@settings(max_examples=40)
@given(seeds, modes, solvers, st.booleans())
def test_skin_losses_and_targets_are_those_of_a_binding_at_that_body(seed: int, mode: Mode, solver, is_apart: bool):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    if is_apart:
        rig = Rig(rig.surface.split_apart(), rig.parents, rig.rest_matrices, *_of_corners(rig))
    body = other_body(rig.surface, rng)
    pose = rig.random_pose(rng, 0.8, scale=0.1, shift=0.1)
    place = random_rigid_motion(rng)
    frame = rig.body(mode, solver=solver).deform(pose, object_from_armature=place, rest_positions=body)
    anew = bound_at(rig, body).body(mode, solver=solver).deform(pose, object_from_armature=place)
    assert np.abs(frame.skinned - anew.skinned).max() <= ROUNDING
    volume = mean_of_fans(rig.surface, body.astype(float))
    rounding = ROUNDING * abs(volume)
    for name in ("joint_losses", "skinned_volumes", "target_volumes"):
        assert getattr(frame.report, name) == pytest.approx(getattr(anew.report, name), abs=rounding), name
    assert frame.report.corrected_volumes == pytest.approx(frame.report.target_volumes, rel=EXACT)
    assert mean_of_fans(rig.surface, frame.positions) == pytest.approx(
        frame.report.target_volumes.sum(), rel=10 * EXACT
    )


def _of_corners(rig: Rig) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    corners = rig.surface.face_corners
    return rig.bones[corners], rig.weights[corners]


@given(seeds, modes)
def test_the_bound_body_changes_nothing_beyond_rounding(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    rig = bound_at(rig, rig.surface.positions.astype("f4"))
    body, pose = rig.body(mode), rig.random_pose(rng, 0.9)
    frame = body.deform(pose, rest_positions=rig.surface.positions.astype("f4"))
    plain = body.deform(pose)
    # The correction is in single precision.
    assert np.abs(frame.positions - plain.positions).max() <= 1e-6
    assert frame.report.joint_losses == pytest.approx(plain.report.joint_losses, abs=ROUNDING)


@given(seeds, modes, st.booleans())
def test_nothing_is_remembered(seed: int, mode: Mode, has_shapes: bool):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=3)
    shapes = rng.normal(scale=0.02, size=(1, *rig.surface.positions.shape)) if has_shapes else None
    skin = turgor.VolumeSkin(rig.surface.mesh(), rig.skinning(mode), shape_deltas=shapes)
    values = [0.7] if has_shapes else None
    bodies = [None, other_body(rig.surface, rng), other_body(rig.surface, rng, 0.3)]
    added = [None, rng.normal(scale=0.02, size=rig.surface.positions.shape).astype("f4")]
    asked = [{"rest_positions": body, "added_offsets": offsets} for body in bodies for offsets in added]
    pose = rig.random_pose(rng, 0.8)

    def alone(options: dict[str, Any]) -> NDArray[np.float64]:
        new = turgor.VolumeSkin(rig.surface.mesh(), rig.skinning(mode), shape_deltas=shapes)
        return new.deform(pose, shape_values=values, **options).positions

    expected = [alone(options) for options in asked]
    for index in rng.integers(0, len(asked), 12):
        assert np.array_equal(skin.deform(pose, shape_values=values, **asked[index]).positions, expected[index])


@settings(max_examples=50)
@given(seeds, surfaces(), modes, solvers)
def test_all_paths_give_the_same_bits(seed: int, surface: Surface, mode: Mode, solver):
    """With bodies, offsets and fleshed bones, of each frame or of all."""
    rng = np.random.default_rng(seed)
    rig = careless_rig(surface, rng)
    count = len(surface.positions)
    skin = turgor.VolumeSkin(surface.mesh(), rig.skinning(mode), solver=solver)
    poses, options = poses_of(rig, rng, 3)
    bodies = (surface.positions + rng.normal(scale=0.05, size=(3, count, 3))).astype("f4")
    added = rng.normal(scale=0.03, size=(3, count, 3)).astype("f4")
    if rng.random() < 0.8:
        options["rest_positions"] = bodies if rng.random() < 0.7 else bodies[0]
    if rng.random() < 0.6:
        options["added_offsets"] = added if rng.random() < 0.7 else added[0]
    fleshed = [bool(f) for f in rng.random(3) < 0.3] if rng.random() < 0.5 else None
    many = skin.deform_many(poses, fleshed=fleshed, **options)
    measures = skin.measure(poses, fleshed=fleshed, **options)
    for row, pose in enumerate(poses):
        of_all = {name for name, values in options.items() if np.ndim(values) == 2}
        own = {name: values if name in of_all else values[row] for name, values in options.items()}
        frame = skin.deform(pose, fleshed=fleshed, **own)
        assert np.isfinite(frame.positions).all()
        assert np.array_equal(many[row], (frame.skinned + frame.offsets.astype(float)).astype("f4"))
        room, raw = np.full((2, count, 3), np.nan, np.float32)
        skin.deform_into(room, pose, fleshed=fleshed, **own)
        skin.deform_into_address(raw.ctypes.data, count, pose, fleshed=fleshed, **own)
        assert np.array_equal(room, frame.offsets)
        assert np.array_equal(raw, frame.offsets)
        assert np.array_equal(measures.corrected_volumes[row], frame.report.corrected_volumes)
        assert np.array_equal(measures.target_volumes[row], frame.report.target_volumes)


@given(seeds)
def test_every_shell_has_the_volume_of_its_body(seed: int):
    rng = np.random.default_rng(seed)
    beside = open_tube(radius=0.3)
    surface = tube().joined(beside.moved(beside.positions + np.array([0.0, 2.0, 0.0])))
    rig = limb(bone_count=3)
    weights = np.repeat([[0.5, 0.3, 0.2]], len(surface.positions), axis=0)
    bones = np.repeat([[0, 1, 2]], len(surface.positions), axis=0).astype(np.int32)
    rig = Rig(surface, rig.parents, rig.rest_matrices, bones, weights)
    body = other_body(surface, rng)
    frame = rig.body().deform(rig.random_pose(rng, 0.5), rest_positions=body)
    wanted = surface.mesh().component_volumes(body.astype(float))
    assert frame.report.target_volumes == pytest.approx(wanted, rel=ROUNDING)
    assert surface.mesh().component_volumes(frame.positions) == pytest.approx(wanted, rel=10 * EXACT)


@settings(max_examples=20)
@given(seeds)
def test_a_body_without_any_bone_loses_what_was_added(seed: int):
    rng = np.random.default_rng(seed)
    surface = tube(rings=17, sides=12)
    count = len(surface.positions)
    still = turgor.Skinning(turgor.Skeleton([], np.zeros((0, 4, 4))), np.zeros(count + 1, np.int32), [], [])
    skin = turgor.VolumeSkin(surface.mesh(), still)
    assert len(skin.joint_bones) == 0
    body = other_body(surface, rng)
    added = (rng.normal(scale=0.1, size=3) * surface.positions).astype("f4")
    no_bones = np.zeros((0, 4, 4))
    untouched = skin.deform(no_bones, rest_positions=body)
    assert np.abs(untouched.positions - body).max() <= 1e-12
    frame = skin.deform(no_bones, rest_positions=body, added_offsets=added)
    assert np.abs(frame.skinned - body.astype(float) - added).max() <= 1e-12
    assert mean_of_fans(surface, frame.positions) == pytest.approx(
        mean_of_fans(surface, body.astype(float)), rel=10 * EXACT
    )
    many = skin.deform_many(np.zeros((2, 0, 4, 4)), rest_positions=body, added_offsets=np.stack([added, 0 * added]))
    assert np.array_equal(many[0], (frame.skinned + frame.offsets.astype(float)).astype("f4"))
    assert np.array_equal(many[1], (untouched.skinned + untouched.offsets.astype(float)).astype("f4"))


@pytest.mark.parametrize(("row", "value", "words"), [(4, np.nan, "row 4 is not finite"), (7, 3e15, "row 7 holds 3.0")])
def test_bodies_that_are_no_numbers_are_refused(row: int, value: float, words: str):
    rig = limb(bone_count=3)
    body = rig.surface.positions.astype("f4")
    body[row, 1] = value
    with pytest.raises(turgor.TurgorError, match=f"rest_positions: {words}"):
        rig.body().deform(rig.rest_pose(), rest_positions=body)


def test_bodies_of_another_shape_are_refused_by_name():
    rig = limb(bone_count=3)
    skin, body = rig.body(), rig.surface.positions.astype("f4")
    poses = np.array([rig.rest_pose()] * 2)
    with pytest.raises(turgor.TurgorError, match="rest_positions: found 3 values, need 396"):
        skin.deform(poses[0], rest_positions=body[:3])
    with pytest.raises(turgor.TurgorError, match=r"rest_positions: need float32 \(N, 3\)"):
        skin.deform(poses[0], rest_positions=body[:, :2])
    for name in ("rest_positions", "added_offsets"):
        too_many: dict[str, Any] = {name: np.stack([body] * 3)}
        too_few: dict[str, Any] = {name: body[:3]}
        with pytest.raises(turgor.TurgorError, match=rf"{name}: need float32 \(N, 3\) or \(2, N, 3\)"):
            skin.deform_many(poses, **too_many)
        with pytest.raises(turgor.TurgorError, match=f"frame 0: {name}: found 3 values"):
            skin.measure(poses, **too_few)
