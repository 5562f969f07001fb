"""Local volume strain: nothing under rigid motion, the cube of the scale under scale, and sums that mean something."""

from __future__ import annotations

import numpy as np
import pytest

from addon.logic import strain

RINGS, SIDES = 9, 12


def _tube(*, with_quads: bool = True) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A closed tube along z from 0 to 4: positions, face offsets, face corners."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    points = [(np.cos(a), np.sin(a), z) for z in np.linspace(0.0, 4.0, RINGS) for a in angles]
    faces = []
    for ring in range(RINGS - 1):
        for side in range(SIDES):
            a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
            quad = [a, b, b + SIDES, a + SIDES]
            faces += [quad] if with_quads else [quad[:3], [quad[0], *quad[2:]]]
    faces += [list(range(SIDES))[::-1], list(range(SIDES * (RINGS - 1), SIDES * RINGS))]
    offsets = np.concatenate([[0], np.cumsum([len(face) for face in faces])]).astype(np.int32)
    return np.array(points), offsets, np.concatenate(faces).astype(np.int32)


def _rotation(seed: int) -> np.ndarray:
    found, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return found * np.sign(np.linalg.det(found))


def _on_axis(points: np.ndarray) -> np.ndarray:
    return points * [0.0, 0.0, 1.0]


@pytest.mark.parametrize("with_quads", [True, False])
@pytest.mark.parametrize("scale", [1.0, 0.5, 1.7])
def test_similar_flesh_has_the_cube_of_its_scale(with_quads, scale):
    points, *faces = _tube(with_quads=with_quads)
    fans = strain.Fans(len(points), *faces)
    turn, move = scale * _rotation(1).T, np.array([30.0, -2.0, 5.0])
    apexes = _on_axis(points)
    found = strain.strain(fans, points, apexes, points @ turn + move, apexes @ turn + move)
    assert np.isfinite(found[SIDES:-SIDES]).all()
    assert np.allclose(found[np.isfinite(found)], scale**3 - 1.0, atol=1e-10)


def test_faces_that_look_inwards_tell_the_same():
    points, offsets, corners = _tube(with_quads=False)
    bent = points * [1.0, 0.7, 1.1]
    apexes = _on_axis(points)
    outwards = strain.strain(strain.Fans(len(points), offsets, corners), points, apexes, bent, apexes * [1, 1, 1.1])
    inside_out = np.concatenate([face[::-1] for face in np.split(corners, offsets[1:-1])])
    inwards = strain.strain(strain.Fans(len(points), offsets, inside_out), points, apexes, bent, apexes * [1, 1, 1.1])
    assert np.allclose(outwards, inwards, equal_nan=True)


@pytest.mark.parametrize("with_quads", [True, False])
def test_mean_over_one_apex_is_the_change_of_the_whole(with_quads):
    """Each face counts at each of its corners: by their cones at rest the strains average to the volume's own."""
    points, offsets, corners = _tube(with_quads=with_quads)
    walls = np.flatnonzero(np.diff(offsets) == (4 if with_quads else 3))
    offsets = offsets[: len(walls) + 1]
    corners = corners[: offsets[-1]]
    fans = strain.Fans(len(points), offsets, corners)
    random = np.random.default_rng(2)
    posed = points + 0.1 * random.normal(size=points.shape)
    apexes = np.broadcast_to([0.1, 0.0, 2.0], points.shape)
    rest = fans.cones(points, apexes)
    change = fans.cones(posed, apexes) / rest - 1.0
    of_all = fans.cones(posed, apexes).sum() / rest.sum() - 1.0
    assert np.isclose((rest * change).sum() / rest.sum(), of_all, atol=1e-12)
    # Cones of a quad are those of the surface that the engine measures, whatever the apex.
    whole = fans.cones(points, apexes).sum() / (4 if with_quads else 3)
    assert whole > 0.0


def test_thin_cones_and_loose_vertices_have_none():
    points, *faces = _tube()
    loose = np.concatenate([points, [[9.0, 9.0, 9.0]]])
    fans = strain.Fans(len(loose), *faces)
    apexes = _on_axis(loose)
    apexes[0] = loose[0]
    found = strain.strain(fans, loose, apexes, 1.1 * loose, 1.1 * apexes)
    assert np.isnan(found[[0, -1]]).all()
    assert np.isfinite(found[SIDES : -SIDES - 1]).all()


def test_mesh_without_faces():
    points = np.zeros((3, 3))
    fans = strain.Fans(3, np.zeros(1, np.int32), np.zeros(0, np.int32))
    assert np.isnan(strain.strain(fans, points, points, points, points)).all()


def test_apexes_are_the_closest_points_of_the_own_bone():
    heads = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [3.0, 0.0, 0.0]])
    tails = np.array([[0.0, 5.0, 0.0], [0.0, 0.0, 4.0], [5.0, 0.0, 0.0]])
    parents = np.array([-1, 0, 0], np.int32)
    points = np.array([[1.0, 0, 1], [2, 1, 0], [1, 0, 3], [1, 0, 9], [4, 1, 1], [7, 7, 7]], float)
    bones = np.array([0, 0, 1, 1, 2, -1], np.int32)
    found = strain.closest_on_bones(points, bones, parents, heads, tails)
    wanted = [[0, 0, 1], [2, 0, 0], [0, 0, 3], [0, 0, 4], [4, 0, 0]]
    assert np.allclose(found[:5], wanted)
    assert np.isnan(found[5]).all()
