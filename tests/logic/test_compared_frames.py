"""Frames that stand for a bake: the ends, where joints are worst, and no long stretch without any."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from addon.logic.compared_frames import MOST_FRAMES, MOST_WORST, compared


@given(st.integers(0, 400), st.integers(0, 30), st.integers(0, 99), st.integers(2, 40))
def test_ends_worst_frames_and_spread_ones_are_compared(count: int, joints: int, seed: int, most: int):
    losses = np.random.default_rng(seed).normal(size=(count, joints))
    found = compared(count, losses, most)
    assert len(found) == min(count, most)
    assert (np.diff(found) > 0).all()
    if count == 0:
        return
    assert {0, count - 1} <= set(found.tolist())
    worst = np.abs(losses).max(axis=0, initial=0.0)
    for joint in np.argsort(-worst)[: min(most - 2, MOST_WORST)]:
        assert np.abs(losses[:, joint]).argmax() in found
    spread = max(most - 2 - min(joints, MOST_WORST), 0)
    if len(found) < count:
        assert np.diff(found).max() <= 2 * -(-count // (spread + 1))


def test_all_frames_are_compared_where_asked_for_or_few():
    assert compared(1000, None, 0).tolist() == list(range(1000))
    assert compared(MOST_FRAMES).tolist() == list(range(MOST_FRAMES))
    assert len(compared(1000)) == MOST_FRAMES
    assert len(compared(50, np.full((50, 3), np.nan))) == MOST_FRAMES
