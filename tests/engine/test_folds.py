"""Folds that the correction makes are repaired: nothing new passes through anything, the volume is exact (MATH 8)."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_folds import new_pairs, triangles_of
from rigs import Rig, chain, limb, rotation, translation
from surfaces import Surface, cube, open_tube, strip, tube

EXACT = 1e-12
# All pairs of triangles are looked at twice for each example.
few = settings(max_examples=8)
seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])
presets = st.sampled_from(["isotropic", "rubber", "muscle", "folds", "belly"])


def elbow(rings: int = 25, sides: int = 12, *, softness: float = 0.25) -> Rig:
    """An open tube of two bones, so that all faces are quads."""
    return chain(open_tube(rings, sides, radius=0.4), 2, softness=softness)


def deep(rig: Rig, rng: np.random.Generator, least: float = 100.0, most: float = 150.0) -> np.ndarray:
    """The second bone bent by so many degrees about any axis across it, twisted a little."""
    angle, about = np.radians(rng.uniform(least, most)), rng.uniform(0.0, 2.0 * np.pi)
    turn = rotation([np.cos(about), 0.0, np.sin(about)], angle) @ rotation([0.0, 1.0, 0.0], rng.uniform(-0.3, 0.3))
    return rig.pose([np.eye(4), *[turn] * (rig.bone_count - 1)])


def presets_of(rig: Rig, name: turgor.presets.PresetName) -> list[turgor.Joint]:
    return [turgor.presets.joint(name, bone) for bone in range(rig.bone_count)]


def assert_repaired(surface: Surface, plain: turgor.Frame, frame: turgor.Frame):
    """By independent measures: folds, volume, and blocked vertices on their way."""
    triangles = triangles_of(surface)
    report = frame.report
    assert np.isfinite(frame.positions).all()
    assert len(new_pairs(frame.skinned, frame.positions, triangles)) <= report.folds_left
    np.testing.assert_allclose(
        surface.mesh().component_volumes(frame.positions), plain.report.target_volumes, rtol=EXACT
    )
    assert report.relative_error <= EXACT
    blocked = report.blocked_vertices
    way, gone = (each.positions[blocked] - each.skinned[blocked] for each in (plain, frame))
    share = (way * gone).sum(axis=1) / np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    assert ((share >= -1e-6) & (share <= 1.0 + 1e-6)).all()
    np.testing.assert_allclose(gone, share[:, None] * way, atol=1e-6 * np.abs(way).max(initial=1e-9))


@few
@given(seeds, modes, solvers, presets)
def test_deep_bends_are_repaired_and_the_volume_stays_exact(seed: int, mode, solver, preset):
    rng = np.random.default_rng(seed)
    rig = elbow(softness=rng.uniform(0.1, 0.35))
    body = rig.body(mode, presets_of(rig, preset), solver=solver)
    pose = deep(rig, rng)
    plain, frame = body.deform(pose), body.deform(pose, repair_folds=True)
    assert np.array_equal(plain.skinned, frame.skinned)
    found = len(new_pairs(plain.skinned, plain.positions, triangles_of(rig.surface)))
    assert found <= frame.report.folds_found
    assert frame.report.folds_left == 0
    assert_repaired(rig.surface, plain, frame)


@given(seeds, modes, presets)
def test_without_folds_no_bit_changes(seed: int, mode, preset):
    rng = np.random.default_rng(seed)
    rig = limb()
    body = rig.body(mode, presets_of(rig, preset))
    pose = rig.random_pose(rng, 0.3)
    plain, frame = body.deform(pose), body.deform(pose, repair_folds=True)
    assert frame.report.folds_found == frame.report.folds_left == len(frame.report.blocked_vertices) == 0
    assert np.array_equal(plain.positions, frame.positions)
    assert np.array_equal(plain.offsets, frame.offsets)
    assert np.array_equal(plain.report.corrected_volumes, frame.report.corrected_volumes)


@few
@given(seeds)
def test_pinned_vertices_stay_pinned(seed: int):
    rng = np.random.default_rng(seed)
    rig = elbow()
    places = rig.surface.positions
    distance = np.linalg.norm(places - places[rng.integers(len(places))], axis=1)
    mask = np.clip(distance - rng.uniform(0.0, 1.0), 0.0, 1.0).astype(np.float32)
    body = rig.body().with_mask(mask)
    pose = deep(rig, rng)
    plain, frame = body.deform(pose), body.deform(pose, repair_folds=True)
    assert np.array_equal(frame.positions[mask == 0.0], frame.skinned[mask == 0.0])
    assert not frame.offsets[mask == 0.0].any()
    assert_repaired(rig.surface, plain, frame)


@pytest.mark.parametrize("seed", [2, 4, 14, 15, 18, 21, 27, 31])
def test_the_volume_goes_before_folds_where_little_is_free(seed: int):
    """Points that back off leave volume that the few others cannot take: then folds stay, and are told."""
    rng = np.random.default_rng(seed)
    rig = elbow(softness=rng.uniform(0.1, 0.35))
    places = rig.surface.positions
    crease = np.argmin(np.abs(places[:, 0] - 2.0) + 0.3 * rng.random(len(places)))
    mask = np.clip(3.0 - 10.0 * np.linalg.norm(places - places[crease], axis=1), 0.0, 1.0).astype(np.float32)
    body = rig.body("linear", presets_of(rig, "muscle")).with_mask(mask)
    pose = deep(rig, np.random.default_rng(seed))
    plain, frame = body.deform(pose), body.deform(pose, repair_folds=True)
    assert 0 < frame.report.folds_left <= frame.report.folds_found
    assert_repaired(rig.surface, plain, frame)


@few
@given(seeds)
def test_a_sheet_in_the_way_stays_and_the_body_backs_off(seed: int):
    """Shells that are not corrected count too."""
    rng = np.random.default_rng(seed)
    body_rig, count = elbow(), 9
    pose = deep(body_rig, rng, 40.0, 60.0)
    body = body_rig.body()
    alone = body.deform(pose)
    # A small sheet across the way of the vertex that moves farthest, which follows no bone.
    moves = alone.positions - alone.skinned
    farthest = int(np.argmax(np.linalg.norm(moves, axis=1)))
    centre, normal = alone.skinned[farthest] + 0.5 * moves[farthest], moves[farthest]
    sheet = strip_across(centre, normal, 0.2, count)
    surface = body_rig.surface.joined(sheet)
    extra = len(sheet.positions)
    still = np.vstack([body_rig.bones, np.zeros((extra, body_rig.bones.shape[1]), np.int32)])
    weights = np.vstack([body_rig.weights, np.zeros((extra, body_rig.weights.shape[1]))])
    rig = Rig(surface, body_rig.parents, body_rig.rest_matrices, still, weights)
    both = rig.body()
    plain, frame = both.deform(pose), both.deform(pose, repair_folds=True)
    assert not frame.offsets[-extra:].any()
    assert frame.report.folds_found > 0
    assert frame.report.folds_left == 0
    assert (frame.report.blocked_vertices < len(body_rig.surface.positions)).all()
    triangles = triangles_of(surface)
    assert not new_pairs(frame.skinned, frame.positions, triangles)
    np.testing.assert_allclose(frame.report.corrected_volumes, plain.report.target_volumes, rtol=EXACT)


def strip_across(centre: np.ndarray, normal: np.ndarray, size: float, count: int) -> Surface:
    """A square sheet of quads about a point."""
    e0 = np.cross(normal, [0.3, 0.5, 0.8])
    e0 /= np.linalg.norm(e0)
    e1 = np.cross(normal, e0) / np.linalg.norm(normal)
    steps = np.linspace(-size, size, count)
    points = [centre + a * e0 + b * e1 for a in steps for b in steps]
    first = [i * count + j for i in range(count - 1) for j in range(count - 1)]
    return Surface(np.array(points), [[at, at + count, at + count + 1, at + 1] for at in first])


@few
@given(seeds)
def test_two_shells_and_split_seams_are_repaired(seed: int):
    """Shells that grow into each other; importers' seams are one skin."""
    rng = np.random.default_rng(seed)
    first = elbow(17, 10)
    other = first.surface.moved(first.surface.positions + np.array([0.0, 0.83, 0.07]))
    surface = first.surface.joined(other)
    split = surface.split_apart()
    bones, weights = np.tile(first.bones, (2, 1)), np.tile(first.weights, (2, 1))
    corners = surface.face_corners
    rig = Rig(split, first.parents, first.rest_matrices, bones[corners], weights[corners])
    pose = deep(first, rng, 70.0, 110.0)
    body = rig.body()
    plain, frame = body.deform(pose), body.deform(pose, repair_folds=True)
    assert_repaired(split, plain, frame)
    whole = Rig(surface, first.parents, first.rest_matrices, bones, weights).body().deform(pose, repair_folds=True)
    assert whole.report.folds_found == frame.report.folds_found
    assert whole.report.folds_left == frame.report.folds_left == 0


@few
@given(seeds)
def test_what_another_deformer_adds_is_part_of_the_skin(seed: int):
    rng = np.random.default_rng(seed)
    rig = elbow()
    added = (0.05 * rng.normal(size=3) * np.ones((len(rig.surface.positions), 3))).astype(np.float32)
    added += (0.01 * np.sin(3.0 * rig.surface.positions)).astype(np.float32)
    pose = deep(rig, rng)
    body = rig.body()
    plain = body.deform(pose, added_offsets=added)
    frame = body.deform(pose, added_offsets=added, repair_folds=True)
    assert np.array_equal(plain.skinned, frame.skinned)
    assert_repaired(rig.surface, plain, frame)


@given(seeds)
def test_many_poses_are_repaired_as_one_by_one(seed: int):
    rng = np.random.default_rng(seed)
    rig = elbow(25, 12)
    body = rig.body()
    poses = np.array([deep(rig, rng, 60.0, 140.0) for _ in range(4)])
    counts = np.full((4, 3), -1, np.int32)
    found = body.deform_many(poses, repair_folds=True, fold_counts=counts)
    for pose, positions, count in zip(poses, found, counts, strict=True):
        frame = body.deform(pose, repair_folds=True)
        assert np.array_equal(positions, (frame.skinned + frame.offsets.astype(np.float64)).astype(np.float32))
        report = frame.report
        assert count.tolist() == [report.folds_found, report.folds_left, len(report.blocked_vertices)]
    again = np.full((4, 3), -1, np.int32)
    body.deform_many(poses, fold_counts=again)
    assert not again.any()


def test_a_repair_is_the_same_into_an_array():
    rig = elbow()
    pose = deep(rig, np.random.default_rng(3))
    body = rig.body()
    offsets = np.full((len(rig.surface.positions), 3), np.nan, np.float32)
    report = body.deform_into(offsets, pose, repair_folds=True)
    frame = body.deform(pose, repair_folds=True)
    assert np.array_equal(offsets, frame.offsets)
    assert report.folds_found == frame.report.folds_found > 0


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_the_unit_of_length_does_not_matter(scale: float):
    rig = elbow()
    pose = deep(rig, np.random.default_rng(5))
    place = np.diag([scale, scale, scale, 1.0])
    large = rig.with_surface(rig.surface.moved(scale * rig.surface.positions))
    report = rig.body().deform(pose, repair_folds=True).report
    body = large.body(object_from_armature=place)
    scaled = body.deform(pose, object_from_armature=place, repair_folds=True).report
    assert report.folds_found > 0
    assert scaled.folds_found == report.folds_found
    assert scaled.folds_left == report.folds_left == 0
    assert scaled.relative_error <= EXACT


def test_bodies_without_skin_to_repair_are_accepted():
    empty = Surface(np.zeros((0, 3)), [])
    for surface in (empty, cube(), strip(), tube(5, 300)):
        count = len(surface.positions)
        weights = np.zeros((count, 1), np.int32), np.ones((count, 1))
        rig = Rig(surface, np.array([-1], np.int32), np.eye(4)[None], *weights)
        report = rig.body().deform(rig.pose([translation([1.0, 2.0, 3.0])]), repair_folds=True).report
        assert report.folds_found == report.folds_left == 0


def test_a_wrong_array_of_counts_is_refused():
    rig = elbow(9, 8)
    with pytest.raises(turgor.TurgorError, match="fold_counts"):
        rig.body().deform_many(np.array([rig.rest_pose()]), repair_folds=True, fold_counts=np.zeros((2, 3), np.int32))
