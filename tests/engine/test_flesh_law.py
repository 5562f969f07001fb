"""The law of flesh: what it leaves alone, what it keeps, and that nothing jumps."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import turgor
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from rigs import Mode, Rig, applied, chain, limb, random_rigid_motion, rotation, translation
from surfaces import Surface, tube
from test_determinism import digest_in_threads

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
PRESETS: tuple[turgor.presets.PresetName, ...] = ("isotropic", "muscle", "flesh")
# Of the tube's radius 0.5: what the law and fields add is single precision.
DIGITS = 1e-6
RADIUS = 0.5


def following(rig: Rig, preset: turgor.presets.PresetName = "flesh", **flesh) -> list[turgor.Joint]:
    """All joints follow the law."""
    return [turgor.presets.joint(preset, bone, **{"flesh": 1.0, **flesh}) for bone in range(rig.bone_count)]


def elbow(rings: int = 49, sides: int = 16) -> Rig:
    return limb(2, rings, sides)


def turned(rig: Rig, bend: float, twist: float, axis: float = 0.0) -> NDArray[np.float64]:
    """The second bone bent about an axis across it, after a twist about itself; degrees."""
    across = [np.sin(np.radians(axis)), 0.0, np.cos(np.radians(axis))]
    local = rotation(across, np.radians(bend)) @ rotation([0.0, 1.0, 0.0], np.radians(twist))
    return rig.pose([np.eye(4), local, *[np.eye(4)] * (rig.bone_count - 2)])


def added(rig: Rig, body: turgor.VolumeSkin, pose) -> NDArray[np.float64]:
    frame = body.deform(pose)
    return frame.positions - frame.skinned


def radii(rig: Rig, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance from the x axis."""
    return np.hypot(positions[:, 1], positions[:, 2])


@given(seeds, modes)
def test_none_of_it_is_the_same_to_the_last_bit(seed: int, mode: Mode):
    rig = limb()
    pose = rig.random_pose(np.random.default_rng(seed), 1.0)
    none = following(rig, flesh=0.0, outside=0.3, spread_twist=0.2, crease=0.7)
    plain = [turgor.presets.joint("flesh", bone) for bone in range(rig.bone_count)]
    frames = [rig.body(mode, joints).deform(pose) for joints in (none, plain)]
    np.testing.assert_array_equal(frames[0].offsets, frames[1].offsets)
    np.testing.assert_array_equal(frames[0].positions, frames[1].positions)


@given(seeds, modes, st.sampled_from(PRESETS), st.sampled_from(["simultaneous", "sequential"]))
def test_volume_is_exact(seed: int, mode: Mode, preset: turgor.presets.PresetName, solver):
    rng = np.random.default_rng(seed)
    rig = limb(4)
    pose = rig.random_pose(rng, 2.0, scale=0.1, shift=0.05)
    amounts = rng.uniform(0.0, 1.0, (rig.bone_count, 4))
    joints = [
        turgor.presets.joint(preset, bone, flesh=a, outside=b, spread_twist=c, crease=d)
        for bone, (a, b, c, d) in enumerate(amounts)
    ]
    frame = rig.body(mode, joints, solver=solver).deform(pose)
    found = rig.surface.mesh().component_volumes(frame.positions)
    np.testing.assert_allclose(found, frame.report.target_volumes, rtol=1e-12)
    np.testing.assert_allclose(frame.positions - frame.skinned, frame.offsets, atol=DIGITS)
    assert np.isfinite(frame.report.joint_losses).all()


@given(seeds, modes)
def test_losses_sum_to_what_is_missing(seed: int, mode: Mode):
    rig = limb(4)
    pose = rig.random_pose(np.random.default_rng(seed), 1.5)
    report = rig.body(mode, following(rig)).deform(pose).report
    missing = report.target_volumes - report.flesh_volumes
    np.testing.assert_allclose(report.joint_losses.sum(), missing.sum(), atol=1e-10)


@given(seeds, modes)
def test_rest_is_rest(seed: int, mode: Mode):
    rig = limb(4)
    move = random_rigid_motion(np.random.default_rng(seed))
    assert not rig.body(mode, following(rig)).deform(rig.rest_pose()).offsets.any()
    whole = rig.body(mode, following(rig)).deform(move @ rig.rest_pose())
    assert np.abs(whole.offsets).max() < DIGITS


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
@pytest.mark.parametrize("spread", [0.0, 1.0])
@pytest.mark.parametrize("bones", [2, 3])
def test_a_twist_keeps_every_section(mode: Mode, spread: float, bones: int):
    rig = limb(bones, 49, 16)
    # Without the correction, which gives back what faces that are sheared lose between the sections.
    body = rig.body(mode, following(rig, spread_twist=spread, strength=0.0))
    for twist in (20.0, 60.0, 120.0, 150.0):
        found = body.deform(turned(rig, 0.0, twist)).positions
        np.testing.assert_allclose(radii(rig, found), radii(rig, rig.surface.positions), atol=DIGITS)


@pytest.mark.parametrize(("least", "tolerance"), [(0.0, 6.0), (0.05, 1e-3)])
def test_a_spread_twist_is_straight_along_the_bone(least: float, tolerance: float):
    """Also where skin is of the bone and the one above alone, a path of its own: without weights below `least`."""
    rig = limb(3, 97, 16)
    kept = np.where(rig.weights < least, 0.0, rig.weights)
    rig = replace(rig, weights=kept / kept.sum(1, keepdims=True))
    found = rig.body(joints=following(rig)).deform(turned(rig, 0.0, 90.0)).positions
    rest = rig.surface.positions
    angle = np.degrees(np.unwrap(np.arctan2(found[:, 2], found[:, 1]) - np.arctan2(rest[:, 2], rest[:, 1])))
    angle = (angle + 180.0) % 360.0 - 180.0
    length = 4.0 / 3.0
    along = (rest[:, 0] - length) / length
    inner = (along > 0.6) & (along < 0.95) & (radii(rig, rest) > 0.1)
    np.testing.assert_allclose(np.abs(angle[inner]), 90.0 * along[inner], atol=tolerance)


def test_a_bone_no_longer_than_its_skin_reaches_spreads_no_twist():
    """A mitten hand, as broad as its bone is long: spread along that, its rim would be torn."""
    rig = limb(3)
    rig = rig.with_surface(rig.surface.moved(rig.surface.positions * [1.0, 1.0, 3.0]))
    pose = turned(rig, 0.0, 90.0)
    spread, blended = (rig.body(joints=following(rig, spread_twist=part)).deform(pose) for part in (1.0, 0.0))
    np.testing.assert_array_equal(spread.positions, blended.positions)


@pytest.mark.parametrize("bend", [30.0, 60.0, 90.0])
def test_the_section_of_a_bend_widens_across(bend: float):
    """By half of 1 − cos of half the bend at the sides, which the blend leaves as wide as they were."""
    rig = elbow(97, 24)
    frame = rig.body(joints=following(rig, strength=0.0)).deform(turned(rig, bend, 0.0))
    side = np.argmin(np.linalg.norm(rig.surface.positions - [2.0, 0.0, RADIUS], axis=1))
    wider = 0.5 * (1.0 - np.cos(np.radians(bend) / 2.0)) * RADIUS
    np.testing.assert_allclose(frame.skinned[side, 2], RADIUS, atol=DIGITS)
    np.testing.assert_allclose(frame.positions[side, 2] - frame.skinned[side, 2], wider, atol=DIGITS)


@pytest.mark.parametrize("bones", [8, 16, 32])
def test_bends_that_overlap_count_as_one(bones: int):
    """However short the bones of a spine are: it is shifted no farther by all of them than by one."""
    rig = limb(bones, 97, 16)
    body = rig.body(joints=following(rig, outside=1.0, crease=0.0, strength=0.0))
    bent = rotation([0.0, 0.0, 1.0], np.radians(120.0 / (bones - 1)))
    farthest = lambda pose: np.linalg.norm(added(rig, body, pose), axis=1).max()  # noqa: E731
    alone = rig.pose([bent if bone == bones // 2 else np.eye(4) for bone in range(bones)])
    everywhere = rig.pose([np.eye(4), *[bent] * (bones - 1)])
    assert farthest(everywhere) <= 1.01 * farthest(alone)


def above_the_plane(rig: Rig, positions: NDArray[np.float64], bend: float) -> NDArray[np.float64]:
    """How far skin near an elbow stands on its own bone's side of the plane that halves the bend."""
    from_joint = rig.surface.positions[:, 0] - 2.0
    near = (np.abs(from_joint) > 0.05) & (np.abs(from_joint) < 1.4 * RADIUS)
    half = rotation([0.0, 0.0, 1.0], np.radians(bend) / 2.0)[:3, 0]
    return ((positions - [2.0, 0.0, 0.0]) @ half * np.sign(from_joint))[near]


@pytest.mark.parametrize("strength", [0.0, 1.0])
@pytest.mark.parametrize("bend", [95.0, 110.0, 130.0])
def test_the_inside_of_a_bend_closes_on_its_plane(bend: float, strength: float):
    rig = elbow(97, 24)
    crossing, closed = (
        above_the_plane(rig, rig.body(joints=joints).deform(turned(rig, bend, 0.0)).positions, bend).min()
        for joints in (following(rig, strength=strength, crease=crease) for crease in (0.0, 1.0))
    )
    assert crossing < -0.01 * RADIUS
    assert closed > 0.01 * RADIUS


def test_skin_in_a_closed_crease_has_no_part_in_the_correction():
    """There is no room for it there: swollen, the limb grows elsewhere."""
    rig = elbow(97, 24)
    body = rig.body(joints=following(rig))
    plain, swollen = (body.deform(turned(rig, 120.0, 0.0), target_scale=scale).positions for scale in (1.0, 1.1))
    heights = [above_the_plane(rig, positions, 120.0) for positions in (plain, swollen)]
    touching = heights[0] < 0.03 * RADIUS
    assert touching.any()
    np.testing.assert_allclose(heights[1][touching], heights[0][touching], atol=DIGITS)
    assert np.abs(swollen - plain).max() > 0.01 * RADIUS


@given(seeds, modes)
def test_the_law_moves_with_the_pose(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    body = rig.body(mode, following(rig))
    pose, move = rig.random_pose(rng, 1.0), random_rigid_motion(rng)
    np.testing.assert_allclose(
        body.deform(move @ pose).positions, applied(move, body.deform(pose).positions), atol=3 * DIGITS
    )


@given(seeds, modes)
def test_place_and_size_do_not_matter(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    size = rng.uniform(0.1, 10.0)
    place = random_rigid_motion(rng) @ np.diag([size, size, size, 1.0])
    placed = rig.with_surface(rig.surface.moved(applied(place, rig.surface.positions)))
    pose = rig.random_pose(rng, 1.0)
    body = placed.body(mode, following(rig), object_from_armature=place)
    expected = applied(place, rig.body(mode, following(rig)).deform(pose).positions)
    np.testing.assert_allclose(
        body.deform(pose, object_from_armature=place).positions, expected, atol=3 * DIGITS * size
    )


@given(seeds)
def test_the_order_of_bones_does_not_matter(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb(4)
    order = rng.permutation(rig.bone_count)
    place = np.argsort(order).astype(np.int32)
    parents = np.array([-1 if rig.parents[old] < 0 else place[rig.parents[old]] for old in order], dtype=np.int32)
    other = replace(rig, parents=parents, rest_matrices=rig.rest_matrices[order], bones=place[rig.bones])
    pose = rig.random_pose(rng, 1.0)
    found = other.body(joints=following(other)).deform(pose[order]).positions
    np.testing.assert_allclose(found, rig.body(joints=following(rig)).deform(pose).positions, atol=3 * DIGITS)


@given(seeds, modes)
def test_many_frames_are_the_same_bits(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    body = rig.body(mode, following(rig))
    poses = np.array([rig.random_pose(rng, 1.0) for _ in range(4)])
    many = body.deform_many(poses)
    positions = many[0] if isinstance(many, tuple) else many
    for pose, found in zip(poses, np.asarray(positions), strict=True):
        frame = body.deform(pose)
        np.testing.assert_array_equal(found, (frame.skinned + frame.offsets).astype(np.float32))


def digest_of_frames() -> str:
    """What a process prints: the digest of frames of more vertices than one thread takes."""
    rig = chain(tube(rings=401, sides=24, length=12.0), 12, length=12.0)
    digest = hashlib.sha256()
    for mode in ("linear", "dual_quaternion"):
        body = rig.body(mode, following(rig))
        for seed in range(3):
            digest.update(body.deform(rig.random_pose(np.random.default_rng(seed), 0.9)).offsets.tobytes())
    return digest.hexdigest()


def test_number_of_threads_does_not_matter():
    digests = [digest_in_threads(count, "test_flesh_law.digest_of_frames") for count in (1, 2, 3)]
    assert digests[0] == digests[1] == digests[2]


@given(seeds, modes)
def test_the_order_of_vertices_and_faces_does_not_matter(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb(4)
    order = rng.permutation(len(rig.surface.positions))
    place = np.argsort(order)
    faces = [place[rig.surface.faces[face]].tolist() for face in rng.permutation(len(rig.surface.faces))]
    surface = Surface(rig.surface.positions[order], faces)
    other = replace(rig, surface=surface, bones=rig.bones[order], weights=rig.weights[order])
    pose = rig.random_pose(rng, 1.0)
    found = other.body(mode, following(other)).deform(pose).positions
    expected = rig.body(mode, following(rig)).deform(pose).positions[order]
    np.testing.assert_allclose(found, expected, atol=3 * DIGITS)


@given(seeds, modes, st.floats(1e-3, 1e3))
def test_a_body_so_many_times_as_large_moves_so_many_times_as_far(seed: int, mode: Mode, size: float):
    rig = limb(4)
    pose = rig.random_pose(np.random.default_rng(seed), 1.0)
    rest, large_pose = rig.rest_matrices.copy(), pose.copy()
    for matrices in (rest, large_pose):
        matrices[:, :3, 3] *= size
    large = replace(rig, surface=rig.surface.moved(size * rig.surface.positions), rest_matrices=rest)
    found = large.body(mode, following(large)).deform(large_pose).positions
    expected = rig.body(mode, following(rig)).deform(pose).positions
    np.testing.assert_allclose(found / size, expected, atol=3 * DIGITS)


SWEEPS = {
    "through straight": lambda t: (40.0 * t - 20.0, 0.0, 0.0),
    "through a half turn": lambda t: (170.0 + 20.0 * t, 0.0, 0.0),
    "twist through a half turn": lambda t: (30.0, 170.0 + 20.0 * t, 0.0),
    "to a deep bend": lambda t: (150.0 * t, 0.0, 0.0),
    "axis": lambda t: (75.0, 0.0, 180.0 * t),
    "axis of a small bend": lambda t: (2.0, 0.0, 180.0 * t),
    "all": lambda t: (120.0 * t, -150.0 + 300.0 * t, 90.0 * t),
}


# At a half turn dual quaternions themselves jump.
SMOOTH: list[tuple[str, Mode]] = [
    *((sweep, "linear") for sweep in SWEEPS),
    *((sweep, "dual_quaternion") for sweep in SWEEPS if "half turn" not in sweep),
]


@pytest.mark.parametrize(("sweep", "mode"), SMOOTH)
def test_nothing_jumps(sweep: str, mode: Mode):
    rig = elbow()
    body = rig.body(mode, following(rig))
    largest = []
    for steps in (600, 1200):
        frames = [added(rig, body, turned(rig, *SWEEPS[sweep](t))) for t in np.linspace(0.0, 1.0, steps + 1)]
        largest.append(max(np.abs(b - a).max() for a, b in pairwise(frames)))
    assert largest[1] <= 0.62 * largest[0] + 2e-6, largest


@given(seeds)
def test_a_vertex_that_is_masked_stays(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb()
    mask = (rng.random(rig.surface.positions.shape[0]) > 0.3).astype(np.float32)
    frame = rig.body(joints=following(rig)).with_mask(mask).deform(rig.random_pose(rng, 1.0))
    assert not frame.offsets[mask == 0.0].any()


@given(seeds, modes)
def test_a_body_of_the_frame_is_followed(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb()
    pose = rig.random_pose(rng, 1.0)
    body = rig.body(mode, following(rig))
    rest = rig.surface.positions.astype(np.float32)
    same = body.deform(pose, rest_positions=rest).positions
    np.testing.assert_allclose(same, body.deform(pose).positions, atol=2e-3 * RADIUS)
    other = (rest * [1.0, 1.2, 0.9]).astype(np.float32)
    frame = body.deform(pose, rest_positions=other)
    found = rig.surface.mesh().component_volumes(frame.positions)
    np.testing.assert_allclose(found, frame.report.target_volumes, rtol=1e-12)


@given(seeds)
def test_offsets_of_others_are_added_to(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb()
    pose = rig.random_pose(rng, 1.0)
    others = (0.02 * rng.normal(size=rig.surface.positions.shape)).astype(np.float32)
    frame = rig.body(joints=following(rig)).deform(pose, added_offsets=others)
    found = rig.surface.mesh().component_volumes(frame.positions)
    np.testing.assert_allclose(found, frame.report.target_volumes, rtol=1e-12)


@given(seeds)
def test_fleshed_bones_are_left_alone(seed: int):
    rig = elbow()
    rng = np.random.default_rng(seed)
    pose = rig.random_pose(rng, 1.0)
    nothing = np.zeros(rig.surface.positions.shape, dtype=np.float32)
    all_fleshed = [True] * rig.bone_count
    frames = [
        rig.body(joints=following(rig, flesh=amount)).deform(pose, added_offsets=nothing, fleshed=all_fleshed)
        for amount in (0.0, 1.0)
    ]
    np.testing.assert_array_equal(frames[0].offsets, frames[1].offsets)


def test_an_elbow_keeps_its_inside_where_flesh_is():
    rig = elbow(97, 24)
    body = rig.body(joints=following(rig, outside=1.0))
    frame = body.deform(turned(rig, 70.0, 0.0))
    middle = np.abs(rig.surface.positions[:, 0] - 2.0) < 0.03
    from_joint = np.linalg.norm(frame.positions[middle] - [2.0, 0.0, 0.0], axis=1) / RADIUS
    linear = np.linalg.norm(frame.skinned[middle] - [2.0, 0.0, 0.0], axis=1) / RADIUS
    assert linear.max() < 1.01
    assert from_joint.max() > 1.2
    assert from_joint.min() < 0.8


@pytest.mark.parametrize("setting", ["flesh", "outside", "spread_twist", "crease"])
@pytest.mark.parametrize("value", [-0.1, 1.1, np.nan])
def test_settings_out_of_range_are_refused(setting: str, value: float):
    with pytest.raises(turgor.TurgorError, match=setting):
        turgor.presets.joint("isotropic", 0, shares=None, **{setting: value})


@settings(deadline=None)
@given(seeds)
def test_bones_that_are_flattened_or_mirrored_follow_no_law(seed: int):
    rng = np.random.default_rng(seed)
    rig = elbow()
    scale = np.diag([1.0, 1.0, float(rng.choice([-1.0, 1e-9, 1e-3])), 1.0])
    pose = rig.pose([np.eye(4), translation(rng.uniform(-0.1, 0.1, 3)) @ rotation([0.0, 0.0, 1.0], 1.0) @ scale])
    frames = [rig.body(joints=following(rig, flesh=amount)).deform(pose) for amount in (0.0, 1.0)]
    np.testing.assert_allclose(frames[0].positions, frames[1].positions, atol=DIGITS)


@given(seeds, modes)
def test_bones_that_skin_does_not_blend_with_say_nothing_of_it(seed: int, mode: Mode):
    """A flat skeleton, or a foot that a control carries: the bone above has skin of its own, elsewhere."""
    rng = np.random.default_rng(seed)
    rig = limb(3)
    is_end = rig.surface.positions[:, 0] <= rig.surface.positions[:, 0].min() + DIGITS
    bones, weights = rig.bones + 1, rig.weights.copy()
    bones[is_end], weights[is_end] = [0, 1, 2], [1.0, 0.0, 0.0]
    flat = replace(
        rig,
        parents=np.array([-1, 0, 0, 0], np.int32),
        rest_matrices=np.concatenate([rig.rest_matrices[:1], rig.rest_matrices]),
        bones=bones.astype(np.int32),
        weights=weights,
    )
    carried = rotation(rng.normal(size=3), rng.uniform(1.5, 2.5)) @ translation([1.0, 1.0, 0.0])
    pose = np.concatenate([np.eye(4)[None], carried @ rig.random_pose(rng, 0.4)])
    none, law = (flat.body(mode, following(flat, flesh=amount)).deform(pose) for amount in (0.0, 1.0))
    # The first bone's skin does blend with the root's.
    is_far = rig.surface.positions[:, 0] > 1.0
    np.testing.assert_allclose(law.offsets[is_far], none.offsets[is_far], atol=0.02 * RADIUS)
