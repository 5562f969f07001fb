"""A factor on every weight: what is pinned stays, what may move keeps the volume (MATH 2)."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Rig, applied, careless, chain, limb, random_rigid_motion, rotation
from surfaces import cube, open_tube, strip, tube

EXACT = 1e-12
seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])
presets = st.sampled_from(["isotropic", "rubber", "muscle", "folds", "belly"])
Mask = np.ndarray


def random_mask(rig: Rig, rng: np.random.Generator) -> Mask:
    """(N,) smooth, rough, or patches of 0 and 1; at least a fifth of the vertices may move."""
    places = rig.surface.positions
    kind = rng.integers(4)
    distance = np.linalg.norm(places - places[rng.integers(len(places))], axis=1)
    if kind == 0:
        mask = rng.random(len(places))
    elif kind == 1:
        mask = np.clip(distance / rng.uniform(0.3, 3.0), 0.0, 1.0)
    elif kind == 2:
        mask = (distance > np.quantile(distance, rng.uniform(0.0, 0.8))).astype(float)
    else:
        mask = (rng.random(len(places)) < 0.7) * rng.random(len(places))
    return mask.astype(np.float32)


def presets_of(rig: Rig, name: turgor.presets.PresetName) -> list[turgor.Joint]:
    return [turgor.presets.joint(name, bone) for bone in range(rig.bone_count)]


def vicinity(rig: Rig, body: turgor.VolumeSkin, bone: int) -> np.ndarray:
    """(N,) all that a joint may move: skin within five quarters of its length at rest."""
    length = body.joint_lengths[list(body.joint_bones).index(bone)]
    return np.linalg.norm(rig.surface.positions - rig.rest_matrices[bone][:3, 3], axis=1) <= 1.26 * length


def assert_kept(rig: Rig, mask: Mask, frame: turgor.Frame):
    """Pinned vertices exactly as skinned, the volume of all shells that may move exact by an independent measure."""
    assert np.isfinite(frame.positions).all()
    assert not frame.offsets[mask == 0.0].any()
    assert np.array_equal(frame.positions[mask == 0.0], frame.skinned[mask == 0.0])
    report = frame.report
    measured = rig.surface.mesh().component_volumes(frame.positions)
    expected = np.where(report.component_is_pinned, report.skinned_volumes, report.target_volumes)
    np.testing.assert_allclose(measured, expected, rtol=EXACT)
    np.testing.assert_allclose(report.corrected_volumes, expected, rtol=EXACT)
    assert report.relative_error <= EXACT


@given(seeds, modes, solvers, presets)
def test_random_masks_pin_and_stay_exact(seed: int, mode, solver, preset):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    mask = random_mask(rig, rng)
    body = rig.body(mode, presets_of(rig, preset), solver=solver).with_mask(mask)
    assert_kept(rig, mask, body.deform(rig.random_pose(rng, 1.0)))


@given(seeds, solvers, st.floats(0.02, 0.5))
def test_a_small_patch_alone_gives_all_back(seed: int, solver, radius: float):
    """However far it must go: fields bend over before, so the last step is along one direction."""
    rng = np.random.default_rng(seed)
    rig = limb(rings=17, sides=8)
    places = rig.surface.positions
    mask = (np.linalg.norm(places - places[rng.integers(len(places))], axis=1) < radius).astype(np.float32)
    assert_kept(rig, mask, rig.body(solver=solver).with_mask(mask).deform(rig.random_pose(rng, 1.2)))


def test_few_vertices_far_from_their_place_lose_no_digits():
    """Where the cubic of a patch has its root near its summit, Newton's iteration ends early."""
    rig = chain(tube(33, 12).roughened(np.random.default_rng(1), 0.05), 3)
    places = rig.surface.positions
    for seed in range(985, 995):
        rng = np.random.default_rng(seed)
        mask = np.linalg.norm(places - places[rng.integers(len(places))], axis=1) < rng.uniform(0.01, 0.5)
        frame = rig.body().with_mask(mask).deform(rig.random_pose(rng, 1.4), target_scale=0.5)
        assert_kept(rig, mask, frame)


@given(seeds, modes, solvers)
def test_shells_are_masked_each_on_its_own(seed: int, mode, solver):
    """One shell wholly pinned, one half, an open one, a strip without an inside, careless weights."""
    rng = np.random.default_rng(seed)
    box = cube()
    surfaces = [
        tube(33, 12),
        tube(17, 8, radius=0.3),
        open_tube(17, 8, radius=0.2),
        box.moved(0.2 * box.positions),
        strip(),
    ]
    whole = surfaces[0]
    for surface in surfaces[1:]:
        whole = whole.joined(surface)
    rig = careless(chain(whole, 3), rng)
    mask = rng.random(len(whole.positions)).astype(np.float32)
    of_shell = whole.mesh().vertex_components
    first, second, pinned = (of_shell[index] for index in (0, len(surfaces[0].positions), -len(strip().positions) - 1))
    mask[of_shell == pinned] = 0.0
    mask[(of_shell == second) & (whole.positions[:, 0] > 2.0)] = 0.0
    report = (frame := rig.body(mode, solver=solver).with_mask(mask).deform(rig.random_pose(rng, 0.8))).report
    assert_kept(rig, mask, frame)
    assert list(np.flatnonzero(report.component_is_pinned)) == [pinned]
    assert not report.component_is_pinned[first]


@given(seeds, solvers)
def test_all_pinned_is_plain_skinning(seed: int, solver):
    rng = np.random.default_rng(seed)
    rig = limb()
    pose = rig.random_pose(rng, 1.0)
    body = rig.body(solver=solver)
    frame = body.with_mask(np.zeros(len(rig.surface.positions))).deform(pose)
    assert np.array_equal(frame.positions, frame.skinned)
    assert np.array_equal(frame.skinned, body.deform(pose).skinned)
    report = frame.report
    assert report.component_is_pinned.all()
    assert report.relative_error == 0.0
    assert report.max_displacement == 0.0
    assert not report.joint_regained.any()
    assert np.array_equal(report.joint_losses, body.deform(pose).report.joint_losses)
    np.testing.assert_allclose(report.corrected_volumes, report.skinned_volumes, rtol=1e-14)


@given(seeds, modes, solvers)
def test_coincident_vertices_move_alike_by_the_smallest_of_their_masks(seed: int, mode, solver):
    rng = np.random.default_rng(seed)
    whole = tube(33, 12)
    rig = careless(chain(whole.split_apart(), 3), rng)
    mask = np.where(rng.random(len(rig.surface.positions)) < 0.1, 0.0, rng.random(len(rig.surface.positions)))
    mask = mask.astype(np.float32)
    least = np.ones(len(whole.positions), np.float32)
    np.minimum.at(least, whole.face_corners, mask)
    pose = rig.random_pose(rng, 0.8)
    body = rig.body(mode, solver=solver)
    frame = body.with_mask(mask).deform(pose)
    first = np.unique(whole.face_corners, return_index=True)[1]
    assert np.array_equal(frame.offsets, frame.offsets[first][whole.face_corners])
    assert np.array_equal(frame.positions, body.with_mask(least[whole.face_corners]).deform(pose).positions)
    assert_kept(rig, least[whole.face_corners], frame)


@given(seeds, solvers, st.floats(1e-30, 1.0))
def test_one_number_everywhere_is_no_mask(seed: int, solver, number: float):
    rng = np.random.default_rng(seed)
    rig = limb()
    pose = rig.random_pose(rng, 1.0)
    body = rig.body(joints=presets_of(rig, "muscle"), solver=solver)
    plain = body.deform(pose)
    for mask in (None, np.full(len(rig.surface.positions), number)):
        masked = body.with_mask(np.zeros(len(rig.surface.positions))).with_mask(mask).deform(pose)
        assert np.array_equal(masked.positions, plain.positions)
        assert np.array_equal(masked.report.joint_regained, plain.report.joint_regained)
        assert not masked.report.component_is_pinned.any()


def test_smallest_numbers_count_against_each_other():
    """Masks as small as single precision goes, and factors that differ by thirty orders."""
    rig = limb(bone_count=4)
    rng = np.random.default_rng(2)
    mask = rng.random(len(rig.surface.positions)).astype(np.float32)
    pose = rig.bent(0.8)
    full, tiny = (rig.body().with_mask(mask * factor).deform(pose).positions for factor in (1.0, np.float32(2.0**-100)))
    np.testing.assert_allclose(tiny, full, atol=1e-6)
    wild = (10.0 ** rng.uniform(-40.0, 0.0, len(mask))).astype(np.float32)
    assert_kept(rig, wild, rig.body().with_mask(wild).deform(pose))


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
def test_a_pinned_vicinity_gives_its_volume_to_the_shell(solver):
    rig = chain(tube(rings=121, sides=12, length=12.0), 6, length=12.0)
    local = [np.eye(4)] * 6
    local[2] = rotation([0.0, 0.0, 1.0], 0.9)
    local[4] = rotation([0.0, 0.0, 1.0], 0.9)
    pose = rig.pose(local)
    body = rig.body(solver=solver)
    mask = np.where(vicinity(rig, body, 2), 0.0, 1.0).astype(np.float32)
    frame = body.with_mask(mask).deform(pose)
    assert_kept(rig, mask, frame)
    place = list(body.joint_bones)
    regained, capped, losses = (
        {bone: values[place.index(bone)] for bone in (2, 4)}
        for values in (frame.report.joint_regained, frame.report.joint_is_capped, frame.report.joint_losses)
    )
    assert losses[2] > 0.01
    assert regained[2] == 0.0
    assert capped[2]
    assert regained[4] == pytest.approx(losses[4], rel=1e-3)
    assert not capped[4]
    # Joints that lost nothing are not accused.
    others = [index for index, bone in enumerate(place) if bone not in (2, 4)]
    assert not frame.report.joint_is_capped[others].any()


def test_vertices_move_by_their_factors():
    """Half of an elbow at a quarter: it moves a quarter as much as before against the other half."""
    rig = limb(bone_count=2, rings=65, sides=24)
    pose = rig.bent(0.3)
    lower = rig.surface.positions[:, 1] < 0.0
    mask = np.where(lower, 0.25, 1.0).astype(np.float32)
    plain, masked = (np.linalg.norm(rig.body().with_mask(m).deform(pose).offsets, axis=1) for m in (None, mask))
    moves = plain > 0.1 * plain.max()
    factors = masked / np.maximum(plain, 1e-9)
    np.testing.assert_allclose(factors[moves & ~lower], np.median(factors[moves & ~lower]), rtol=0.01)
    np.testing.assert_allclose(factors[moves & lower], 0.25 * np.median(factors[moves & ~lower]), rtol=0.01)


def test_a_joint_whose_own_shape_is_pinned_is_reported():
    """Its volume stays near, but where its bell leaves off."""
    rig = chain(tube(rings=121, sides=12, length=12.0), 6, length=12.0)
    local = [np.eye(4)] * 6
    local[3] = rotation([0.0, 0.0, 1.0], 0.2)
    pose = rig.pose(local)
    body = rig.body()
    near = body.joint_field(3, pose).gamma > 0.0
    mask = np.where(near, 0.0, 1.0).astype(np.float32)
    frame = body.with_mask(mask).deform(pose)
    assert_kept(rig, mask, frame)
    assert list(body.joint_bones[frame.report.joint_is_capped]) == [3]
    moved = np.linalg.norm(frame.offsets, axis=1)
    assert moved[vicinity(rig, body, 3)].max() > 100.0 * moved[~vicinity(rig, body, 3)].max()


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
@pytest.mark.parametrize("preset", ["isotropic", "muscle", "belly"])
def test_half_the_step_of_the_mask_is_half_the_step_of_the_vertices(preset, solver):
    """From one mask to another, through patches that come loose and others that are pinned."""
    rig = limb(rings=33, sides=12)
    body = rig.body(joints=presets_of(rig, preset), solver=solver)
    pose = rig.bent(0.6, twist=0.3)
    x, y, _ = rig.surface.positions.T

    def mask(time: float) -> Mask:
        return np.clip(np.sin(2.0 * x + 3.0 * time) + 0.5 * y + 0.6, 0.0, 1.0).astype(np.float32)

    def largest_step(count: int) -> float:
        positions = [body.with_mask(mask(time)).deform(pose).positions for time in np.linspace(-1.0, 1.0, count + 1)]
        return max(np.abs(after - before).max() for before, after in pairwise(positions))

    coarse, middle, fine = (largest_step(count) for count in (64, 128, 256))
    assert middle <= 0.6 * coarse
    assert fine <= 0.6 * middle


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
def test_pinning_a_joint_slowly_is_smooth(solver):
    """Its vicinity fades to 0 by itself: its volume goes over to the shell without a jump, the last step too."""
    rig = chain(tube(rings=121, sides=12, length=12.0), 6, length=12.0)
    local = [np.eye(4)] * 6
    local[3] = rotation([0.0, 0.0, 1.0], 0.7)
    pose = rig.pose(local)
    body = rig.body(solver=solver)
    near = vicinity(rig, body, 3)
    factors = [1.0, *10.0 ** np.linspace(0.0, -6.0, 241), 0.0]
    results = [body.with_mask(np.where(near, factor, 1.0)).deform(pose) for factor in factors]
    moves = [np.abs(after.offsets - before.offsets).max() for before, after in pairwise(results)]
    assert moves[-1] < 1e-3 * max(result.report.max_displacement for result in results)
    assert max(moves) < 0.05 * results[0].report.max_displacement
    assert results[-1].report.joint_is_capped.sum() == 1


@given(seeds, solvers)
def test_masks_move_with_the_whole(seed: int, solver):
    rng = np.random.default_rng(seed)
    rig = limb()
    mask = random_mask(rig, rng)
    pose, move = rig.random_pose(rng, 0.8), random_rigid_motion(rng)
    body = rig.body(solver=solver).with_mask(mask)
    still, moved = body.deform(pose).positions, body.deform(move @ pose).positions
    np.testing.assert_allclose(moved, applied(move, still), atol=1e-5)


@given(seeds, st.permutations(range(4)))
def test_masks_of_other_calls_do_not_matter(seed: int, order: list[int]):
    """Buffers are shared between masks: nothing of one is left for the next."""
    rng = np.random.default_rng(seed)
    rig = limb()
    body = rig.body()
    masks = [None, *(random_mask(rig, rng) for _ in range(3))]
    pose = rig.random_pose(rng, 1.0)
    alone = [rig.body().with_mask(mask).deform(pose).positions for mask in masks]
    masked = [body.with_mask(mask) for mask in masks]
    for index in order:
        assert np.array_equal(masked[index].deform(pose).positions, alone[index])
        assert np.array_equal(body.with_mask(masks[index]).deform(pose).positions, alone[index])


@given(seeds)
def test_settings_and_masks_commute(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb()
    mask, pose = random_mask(rig, rng), rig.random_pose(rng, 1.0)
    muscles = presets_of(rig, "muscle")
    one = rig.body().with_mask(mask).with_joints(muscles, solver="sequential")
    other = rig.body(joints=muscles, solver="sequential").with_mask(mask)
    assert np.array_equal(one.deform(pose).positions, other.deform(pose).positions)
    poses = np.array([pose])
    assert np.array_equal(one.measure(poses).joint_regained[0], other.deform(pose).report.joint_regained)


def test_gamma_of_a_joint_is_masked():
    rig = limb()
    rng = np.random.default_rng(3)
    mask = random_mask(rig, rng)
    mask /= mask.max()
    pose = rig.bent(0.8)
    body = rig.body(joints=presets_of(rig, "belly"))
    free, masked = (skin.joint_field(1, pose).gamma for skin in (body, body.with_mask(mask)))
    np.testing.assert_allclose(masked, free * mask, rtol=1e-6)


def test_breathing_under_a_mask():
    rig = limb()
    mask = np.clip(rig.surface.positions[:, 0] - 1.0, 0.0, 1.0).astype(np.float32)
    frame = rig.body().with_mask(mask).deform(rig.bent(0.4), target_scale=1.1)
    assert_kept(rig, mask, frame)


def test_a_mask_is_changed_at_every_dab_of_a_brush():
    rig = chain(tube(4167, sides=24, length=17.0), 17, length=17.0)
    body = rig.body()
    mask = np.random.default_rng(0).random(len(rig.surface.positions)).astype(np.float32)
    offsets = np.zeros((len(mask), 3), np.float32)
    pose = rig.bent(0.1)
    body.with_mask(mask).deform_into(offsets, pose)

    def seconds() -> float:
        start = time.perf_counter()
        body.with_mask(mask)
        return time.perf_counter() - start

    assert min(seconds() for _ in range(10)) < 0.005


@pytest.mark.parametrize(
    ("mask", "message"),
    [
        (np.ones(3), "mask: found 3 values, need 396"),
        (np.ones((396, 1)), r"mask: need float32 \(N,\), got float64 \(396, 1\)"),
        (np.full(396, 1.5), "mask is 1.5, need numbers from 0 to 1"),
        (np.full(396, -0.1), "mask is -0.1"),
        (np.full(396, np.nan), "mask is NaN"),
    ],
)
def test_masks_that_are_none(mask: np.ndarray, message: str):
    with pytest.raises(turgor.TurgorError, match=message):
        limb().body().with_mask(mask)
