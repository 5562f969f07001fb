"""What must not change the correction: place, orientation, scale, winding, storage."""

from __future__ import annotations

import numpy as np
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Mode, Rig, applied, limb, random_rigid_motion

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])
fields_kinds = st.sampled_from(["plain", "even"])

# Of the tube's radius 0.5. Fields are single precision (what they add is measured in double): where sums are taken in
# another order or at another place, displacements differ in their seventh digit.
FIELD_DIGITS = 1e-6


def muscles(rig: Rig) -> list[turgor.Joint]:
    return [turgor.presets.muscle(bone) for bone in range(rig.bone_count)]


@given(seeds, modes, solvers, fields_kinds)
def test_deform_commutes_with_rigid_motion_of_the_pose(seed: int, mode: Mode, solver, fields):
    rng = np.random.default_rng(seed)
    rig = limb()
    body = rig.body(mode, muscles(rig), solver=solver, fields=fields)
    pose = rig.random_pose(rng, 1.0)
    move = random_rigid_motion(rng)
    moved = body.deform(move @ pose).positions
    np.testing.assert_allclose(moved, applied(move, body.deform(pose).positions), atol=FIELD_DIGITS)


@given(seeds, modes)
def test_deform_commutes_with_the_place_and_size_of_the_object(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    size = rng.uniform(0.1, 10.0)
    object_from_armature = random_rigid_motion(rng) @ np.diag([size, size, size, 1.0])
    placed = rig.with_surface(rig.surface.moved(applied(object_from_armature, rig.surface.positions)))
    pose = rig.random_pose(rng, 1.0)
    body = placed.body(mode, muscles(rig), object_from_armature=object_from_armature)
    result = body.deform(pose, object_from_armature=object_from_armature)
    expected = applied(object_from_armature, rig.body(mode, muscles(rig)).deform(pose).positions)
    np.testing.assert_allclose(result.positions, expected, atol=FIELD_DIGITS * size)


@given(seeds, modes, solvers, fields_kinds)
def test_reversed_faces_are_corrected_alike(seed: int, mode: Mode, solver, fields):
    rig = limb()
    pose = rig.random_pose(np.random.default_rng(seed), 1.0)
    mirror = rig.with_surface(rig.surface.reversed())
    frame, reversed_frame = (
        one.body(mode, muscles(rig), solver=solver, fields=fields).deform(pose) for one in (rig, mirror)
    )
    np.testing.assert_allclose(reversed_frame.positions, frame.positions, atol=FIELD_DIGITS)
    np.testing.assert_allclose(reversed_frame.report.target_volumes, -frame.report.target_volumes, rtol=1e-14)


@given(seeds)
def test_float32_poses_are_read_as_the_float64_of_the_same_values(seed: int):
    rig = limb()
    single = rig.random_pose(np.random.default_rng(seed), 1.0).astype(np.float32)
    body = rig.body()
    assert np.array_equal(body.deform(single).positions, body.deform(single.astype(np.float64)).positions)


def test_float32_rest_positions_are_read_as_the_float64_of_the_same_values():
    rig = limb()
    single = rig.surface.positions.astype(np.float32)
    rounded = rig.with_surface(rig.surface.moved(single.astype(np.float64)))
    pose = rig.bent(0.7)
    mesh = turgor.Mesh(single, rig.surface.face_offsets, rig.surface.face_corners)
    result = turgor.VolumeSkin(mesh, rig.skinning()).deform(pose)
    assert np.array_equal(result.positions, rounded.body().deform(pose).positions)


@given(seeds)
def test_numbering_of_the_bones_does_not_matter(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    pose = rig.random_pose(rng, 1.0)
    order = rng.permutation(4)
    place = np.argsort(order)
    parents = np.array([place[parent] if parent >= 0 else -1 for parent in rig.parents[order]], dtype=np.int32)
    renumbered = Rig(rig.surface, parents, rig.rest_matrices[order], place[rig.bones].astype(np.int32), rig.weights)
    result = renumbered.body().deform(pose[order]).positions
    np.testing.assert_allclose(result, rig.body().deform(pose).positions, atol=FIELD_DIGITS)
