"""Keys of one joint each: their shares cover the mesh, nothing moves beyond, and the error asked for is held."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.logic import joint_regions, local_reduction
from addon.logic.weights import BoneWeights

seeds = st.integers(0, 2**32 - 1)
tolerances = st.floats(1e-4, 1.0)
BONES, FRAMES = 5, 12
# A chain along z, a side branch, and a bone that holds nothing between the last two.
PARENTS = np.array([-1, 0, 1, 1, 3], np.int32)
HEADS = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 2], [1, 0, 1.5], [2, 0, 1.5]], np.float64)
HOLDING = (0, 1, 2, 4)


def _skin(seed: int, count: int = 60) -> tuple[np.ndarray, BoneWeights]:
    """Points about the bones; some between two of them, some that nothing holds."""
    rng = np.random.default_rng(seed)
    positions = rng.uniform([-0.3, -0.3, 0.0], [2.5, 0.3, 3.0], (count, 3))
    rows = [rng.choice(HOLDING, rng.integers(0, 3), replace=False) for _ in range(count)]
    offsets = np.cumsum([0, *map(len, rows)]).astype(np.int32)
    bones = np.concatenate([*rows, np.zeros(0)]).astype(np.int32)
    return positions, BoneWeights(offsets, bones, rng.uniform(0.1, 1.0, len(bones)).astype(np.float32))


def _regions(seed: int) -> tuple[np.ndarray, list[joint_regions.Region], BoneWeights]:
    positions, weights = _skin(seed)
    return positions, joint_regions.regions(positions, weights, PARENTS, HEADS), weights


def _samples(seed: int, count: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    shapes = rng.normal(size=(FRAMES, count, 3)) * 0.4 ** np.arange(FRAMES)[:, None, None]
    return np.tensordot(rng.normal(size=(FRAMES, FRAMES)), shapes, 1).astype(np.float32)


def _reduced(seed: int, tolerance: float) -> tuple[np.ndarray, np.ndarray, list[local_reduction.LocalKeys]]:
    _, regions, _ = _regions(seed)
    count = 60
    samples = _samples(seed, count)
    growth = np.random.default_rng(seed).uniform(0.5, 3.0, count)
    return samples, growth, list(local_reduction.reduce([samples[:5], samples[5:]], regions, tolerance, growth))


def _made(parts: list[local_reduction.LocalKeys], shape: tuple[int, ...]) -> np.ndarray:
    made = np.zeros(shape)
    for part in parts:
        made[:, part.region.vertices] += np.tensordot(part.values, part.keys.astype(np.float64), 1)
    return made


@given(seeds)
def test_shares_of_all_regions_are_one_at_every_vertex(seed: int):
    positions, regions, _ = _regions(seed)
    total = np.zeros(len(positions))
    for region in regions:
        assert (np.diff(region.vertices) > 0).all()
        assert region.shares.min() > 0.0
        total[region.vertices] += region.shares
    assert total == pytest.approx(1.0, abs=1e-12)


@given(seeds)
def test_a_region_is_held_by_the_bones_that_meet_at_its_joint(seed: int):
    """The joint of bone 4 is where it meets bone 1: what lies between holds nothing."""
    _, regions, weights = _regions(seed)
    meeting = {1: {0, 1}, 2: {1, 2}, 4: {1, 4}}
    for region in regions:
        for vertex in region.vertices:
            held = set(weights.bones[weights.offsets[vertex] : weights.offsets[vertex + 1]].tolist())
            if region.bone == joint_regions.NO_BONE:
                assert not held
            else:
                assert held & meeting[region.bone]


def test_shares_pass_from_one_end_of_a_bone_to_the_other():
    """Along bone 1: all at its head, half in the middle, nothing near its tail, without a step."""
    z = np.linspace(1.0, 2.0, 201)
    positions = np.stack([0.0 * z, 0.0 * z, z], axis=1)
    ones = np.ones(len(z), np.float32)
    weights = BoneWeights(np.arange(len(z) + 1, dtype=np.int32), np.ones(len(z), np.int32), ones)
    ends = BoneWeights(
        np.append(weights.offsets, weights.offsets[-1] + np.array([1, 2], np.int32)),
        np.append(weights.bones, np.array([0, 2], np.int32)),
        np.append(weights.weights, np.ones(2, np.float32)),
    )
    points = np.concatenate([positions, [[0.0, 0.0, 0.5], [0.0, 0.0, 2.5]]])
    first = next(region for region in joint_regions.regions(points, ends, PARENTS, HEADS) if region.bone == 1)
    shares = np.zeros(len(points))
    shares[first.vertices] = first.shares
    along = shares[: len(z)]
    assert along[0] == 1.0
    assert along[100] == pytest.approx(0.5)
    assert (along[z > 1.81] == 0.0).all()
    assert np.abs(np.diff(along)).max() < 0.05
    assert (np.diff(along) <= 1e-12).all()


@given(seeds, tolerances)
def test_the_error_is_held_where_regions_meet(seed: int, tolerance: float):
    samples, growth, parts = _reduced(seed, tolerance)
    errors = np.linalg.norm(_made(parts, samples.shape) - samples, axis=2) * growth
    assert errors.max() <= tolerance * (1.0 + 1e-5) + 1e-6


@given(seeds, tolerances)
def test_the_same_samples_give_the_same_bits_whatever_the_chunks(seed: int, tolerance: float):
    samples, growth, parts = _reduced(seed, tolerance)
    regions = [part.region for part in parts]
    for part, again in zip(parts, local_reduction.reduce([samples], regions, tolerance, growth), strict=True):
        assert part.keys.tobytes() == again.keys.tobytes()
        assert part.values.tobytes() == again.values.tobytes()


@given(seeds, tolerances, tolerances)
def test_a_larger_error_never_takes_more_keys(seed: int, one: float, other: float):
    counts = [sum(len(part.keys) for part in _reduced(seed, tolerance)[2]) for tolerance in sorted((one, other))]
    assert counts[1] <= counts[0]


@given(seeds, tolerances)
def test_values_from_0_to_1_make_the_same_displacements(seed: int, tolerance: float):
    samples, _, parts = _reduced(seed, tolerance)
    one_way = [local_reduction.within_unit(part) for part in parts]
    for part, unit in zip(parts, one_way, strict=True):
        assert len(part.keys) <= len(unit.keys) <= 2 * len(part.keys)
        assert unit.values.min(initial=0.0) >= 0.0
        assert unit.values.max(initial=0.0) <= 1.0 + 1e-12
    assert np.abs(_made(one_way, samples.shape) - _made(parts, samples.shape)).max() <= 1e-6 * np.abs(samples).max()
