"""Fewer keys: the error asked for is held, and more of it never takes more keys."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.logic import reduction
from addon.logic.reduction import reduce, within_unit

seeds = st.integers(0, 2**32 - 1)
tolerances = st.floats(1e-6, 1.0)


def _samples(seed: int, frames: int = 14, vertices: int = 40, rank: int = 14) -> np.ndarray:
    """Displacements of falling size in random directions."""
    rng = np.random.default_rng(seed)
    sizes = 0.4 ** np.arange(rank)
    shapes = rng.normal(size=(rank, vertices, 3)) * sizes[:, None, None]
    return np.tensordot(rng.normal(size=(frames, rank)), shapes, 1).astype(np.float32)


def _errors(found: reduction.Reduction, samples: np.ndarray) -> np.ndarray:
    made = np.tensordot(found.values, found.keys.astype(np.float64), 1)
    return np.linalg.norm(made - samples, axis=2)


@given(seeds, tolerances)
def test_the_error_is_held_and_told(seed: int, tolerance: float):
    samples = _samples(seed)
    found = reduce([samples], tolerance)
    errors = _errors(found, samples)
    assert errors.max() <= tolerance * (1.0 + 1e-9)
    assert found.worst == pytest.approx(errors.max(axis=1), abs=1e-12)
    assert found.rms == pytest.approx(np.sqrt((errors**2).mean(axis=1)), abs=1e-12)
    assert np.abs(found.values).max(initial=0.0) <= 1.0 + 1e-12


@given(seeds, tolerances, tolerances)
def test_a_larger_error_never_takes_more_keys(seed: int, one: float, other: float):
    samples = _samples(seed)
    strict, loose = (len(reduce([samples], tolerance).keys) for tolerance in sorted((one, other)))
    assert loose <= strict


@given(seeds, tolerances)
def test_chunks_do_not_matter_and_bits_are_the_same(seed: int, tolerance: float):
    samples = _samples(seed)
    whole, again, cut = (reduce(parts, tolerance) for parts in ([samples], [samples], [samples[:5], samples[5:]]))
    assert whole.keys.tobytes() == again.keys.tobytes() == cut.keys.tobytes()
    assert whole.values.tobytes() == again.values.tobytes() == cut.values.tobytes()


@given(seeds)
def test_blocks_of_vertices_do_not_matter(seed: int):
    samples = _samples(seed)
    before = reduction.BLOCK_NUMBERS
    whole = reduce([samples], 0.05)
    try:
        reduction.BLOCK_NUMBERS = 14 * 3 * 7
        cut = reduce([samples], 0.05)
    finally:
        reduction.BLOCK_NUMBERS = before
    assert len(cut.keys) == len(whole.keys)
    assert _errors(cut, samples).max() <= 0.05


@given(seeds, tolerances)
def test_values_from_0_to_1_make_the_same_displacements(seed: int, tolerance: float):
    samples = _samples(seed)
    found = reduce([samples], tolerance)
    unit = within_unit(found)
    assert unit.values.min(initial=0.0) >= 0.0
    assert unit.values.max(initial=0.0) <= 1.0 + 1e-12
    assert len(unit.keys) <= len(found.keys) + 1
    scale = np.abs(samples).max()
    assert np.abs(_errors(unit, samples) - _errors(found, samples)).max() <= 1e-5 * scale


def test_few_shapes_need_few_keys():
    for rank in (0, 1, 3):
        samples = _samples(7, frames=20, rank=3) if rank == 3 else _samples(7, frames=20, rank=max(rank, 1)) * rank
        assert len(reduce([samples], 1e-4).keys) == rank


def test_what_cannot_be_reduced_keeps_every_frame():
    samples = np.random.default_rng(3).normal(size=(6, 30, 3)).astype(np.float32)
    found = reduce([samples], 1e-12)
    assert np.array_equal(found.keys, samples)
    assert found.error == 0.0


def test_stretched_vertices_count_by_their_growth():
    samples = _samples(11)
    factor = np.where(np.arange(40) < 5, 10.0, 1.0)
    found = reduce([samples], 0.1, factor)
    assert (_errors(found, samples) * factor).max() <= 0.1 * (1.0 + 1e-9)


def test_weights_for_what_is_worst_off_save_keys():
    """A few vertices move alone on single frames: the mean square overlooks them."""
    rng = np.random.default_rng(5)
    samples = np.tensordot(rng.normal(size=(30, 5)), rng.normal(size=(5, 400, 3)), 1)
    samples[rng.integers(30, size=3), rng.integers(400, size=3)] += 0.4
    before = reduction.ROUNDS
    balanced = len(reduce([samples.astype(np.float32)], 0.3).keys)
    try:
        reduction.ROUNDS = 0
        plain = len(reduce([samples.astype(np.float32)], 0.3).keys)
    finally:
        reduction.ROUNDS = before
    assert balanced <= plain
