"""The demonstration's own measure of volume, against volumes known by heart."""

from __future__ import annotations

import numpy as np
import pytest

from demo.enclosed_volume import Shells, shells

CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
FOURS = np.full(6, 4)


def cube() -> Shells:
    return shells(CORNERS, FOURS, QUADS.ravel())


def test_cube():
    assert cube().volumes(CORNERS) == pytest.approx([1.0], rel=1e-15)
    assert cube().volumes(2.0 * CORNERS + 100.0) == pytest.approx([8.0], rel=1e-13)
    assert not cube().is_open.any()


def test_split_seams_are_welded():
    split = CORNERS[QUADS.ravel()]
    measured = shells(split, FOURS, np.arange(24))
    assert measured.count == 1
    assert measured.volumes(split) == pytest.approx([1.0], rel=1e-15)


def test_nearly_equal_points_are_welded():
    rng = np.random.default_rng(2)
    split = CORNERS[QUADS.ravel()] + rng.uniform(-2e-7, 2e-7, (24, 3))
    assert shells(split, FOURS, np.arange(24)).volumes(split) == pytest.approx([1.0], rel=1e-5)


def test_an_opening_is_closed_by_a_fan():
    measured = shells(CORNERS, FOURS[:5], QUADS[:5].ravel())
    assert measured.is_open.all()
    assert measured.volumes(CORNERS + 7.0) == pytest.approx([1.0], rel=1e-13)


def test_shells_are_measured_apart():
    points = np.concatenate([CORNERS, 2.0 * CORNERS + 5.0, [[50.0, 0.0, 0.0]]])
    measured = shells(points, np.full(12, 4), np.concatenate([QUADS, QUADS + 8]).ravel())
    assert measured.volumes(points) == pytest.approx([1.0, 8.0], rel=1e-13)
    assert list(measured.vertex_shells) == [0] * 8 + [1] * 8 + [-1]


def test_quads_are_bilinear():
    """A bent quad counts as the mean of its two triangulations."""
    lifted = CORNERS.copy()
    lifted[7, 2] += 0.4
    faces = list(QUADS)
    triangles = [[face[0], face[1], face[2]] for face in faces] + [[face[0], face[2], face[3]] for face in faces]
    others = [np.roll(face, 1) for face in faces]
    crossing = [[face[0], face[1], face[2]] for face in others] + [[face[0], face[2], face[3]] for face in others]
    halves = [
        shells(CORNERS, np.full(12, 3), np.array(cut).ravel()).volumes(lifted)[0] for cut in (triangles, crossing)
    ]
    assert cube().volumes(lifted)[0] == pytest.approx(np.mean(halves), rel=1e-13)
