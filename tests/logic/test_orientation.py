"""Faces are turned until every shell looks outwards, whatever way they looked before."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from addon.logic.orientation import faces_to_turn

CUBE = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], np.float64)
FACES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
OFFSETS = np.arange(0, 25, 4, dtype=np.int32)


def _corners(turned: list[bool], faces: list[list[int]] = FACES) -> np.ndarray:
    rings = (face[::-1] if turn else face for face, turn in zip(faces, turned, strict=True))
    return np.array([corner for ring in rings for corner in ring], np.int32)


def _turn(positions: np.ndarray, offsets: np.ndarray, corners: np.ndarray) -> list[bool]:
    return faces_to_turn(positions, offsets, corners, np.arange(len(positions), dtype=np.int32)).tolist()


@given(st.lists(st.booleans(), min_size=6, max_size=6), st.floats(-100.0, 100.0))
def test_exactly_the_faces_that_look_inwards_are_turned(turned, away):
    assert _turn(CUBE + away, OFFSETS, _corners(turned)) == turned


@given(st.lists(st.booleans(), min_size=5, max_size=5))
def test_an_open_box_too(turned):
    assert _turn(CUBE, OFFSETS[:-1], _corners(turned, FACES[:5])) == turned


def test_split_seams_are_one_shell():
    corners = _corners([True] * 6)
    own = np.arange(24, dtype=np.int32)
    first = np.array([np.flatnonzero(corners == corner)[0] for corner in corners], np.int32)
    assert faces_to_turn(CUBE[corners], OFFSETS, own, first).all()


def test_a_hollow_keeps_looking_inwards():
    inner = CUBE * 0.5 + 0.25
    corners = np.concatenate([_corners([False] * 6), _corners([True] * 6) + 8])
    offsets = np.arange(0, 49, 4, dtype=np.int32)
    positions = np.concatenate([CUBE, inner])
    assert _turn(positions, offsets, corners.astype(np.int32)) == [False] * 12


def test_faces_that_cannot_agree_are_left_alone():
    fin = np.concatenate([_corners([True] * 6), [0, 1, 8]]).astype(np.int32)
    positions = np.vstack([CUBE, [[0.5, -1.0, 0.0]]])
    assert not any(_turn(positions, np.append(OFFSETS, 27).astype(np.int32), fin))
