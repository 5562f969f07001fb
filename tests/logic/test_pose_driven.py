"""Pose-driven keys learn what is a polynomial of the turns, and their expressions say the same."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from addon.logic import pose_driven
from addon.logic.pose_driven import LONGEST_EXPRESSION, TERMS, adjusted, assemble, expression, learn, terms

seeds = st.integers(0, 2**32 - 1)
POINTS = 30


def _turns(rng: np.random.Generator, count: int) -> np.ndarray:
    return rng.uniform(-0.5, 0.5, (count, 3))


@given(seeds)
def test_polynomials_are_learnt_and_added_over_bones(seed: int):
    rng = np.random.default_rng(seed)
    shapes = rng.normal(size=(2, len(TERMS), POINTS, 3))
    seen = {bone: _turns(rng, 80) for bone in range(2)}
    parts = [learn(bone, seen[bone], np.tensordot(terms(seen[bone]), shapes[bone], 1), 0.0) for bone in range(2)]
    known = assemble(parts, 0.0, 1000)
    turns = np.stack([_turns(rng, 20), _turns(rng, 20)], axis=1)
    alone = [np.tensordot(terms(turns[:, bone]), shapes[bone], 1) for bone in range(2)]
    wanted = (alone[0] + alone[1]).astype(np.float32)
    size = np.abs(wanted).max()
    assert known.error(turns, [wanted[:8], wanted[8:]]).max() < 0.05 * size
    better = adjusted(known, seen, turns, [wanted])
    assert better.error(turns, [wanted]).max() < known.error(turns, [wanted]).max()


@given(seeds)
def test_nothing_moves_at_rest(seed: int):
    rng = np.random.default_rng(seed)
    turns = _turns(rng, 60)
    part = learn(0, turns, rng.normal(size=(60, POINTS, 3)), 0.0)
    known = assemble([part], 0.0, 4)
    assert len(known.keys) == 4
    assert not known.values(np.zeros((1, 1, 3))).any()
    assert np.abs(known.values(turns[:, None])).max() <= 1.01


@given(st.lists(st.floats(-50, 50), min_size=len(TERMS), max_size=len(TERMS)))
def test_an_expression_is_short_and_says_the_polynomial(numbers: list[float]):
    coefficients = pose_driven._shortened(np.array(numbers))
    text = expression(coefficients)
    assert len(text) <= LONGEST_EXPRESSION
    assert set(text) <= set("0123456789.+-*xyz")
    turns = np.random.default_rng(1).uniform(-1.0, 1.0, (5, 3))
    for (x, y, z), value in zip(turns, terms(turns) @ coefficients, strict=True):
        found = eval(text, {}, {"x": x, "y": y, "z": z})
        assert abs(found - value) <= 1e-9 * max(np.abs(coefficients).max(), 1.0)


@given(seeds)
def test_keys_that_matter_most_are_kept(seed: int):
    rng = np.random.default_rng(seed)
    turns = _turns(rng, 60)
    part = learn(3, turns, np.tensordot(terms(turns), rng.normal(size=(len(TERMS), POINTS, 3)), 1), 0.0)
    counts = [len(assemble([part], least, 1000).keys) for least in np.linspace(0.0, part.sizes.max() * 1.1, 6)]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] == 0
    assert len(assemble([part], 0.0, 3).keys) == 3
