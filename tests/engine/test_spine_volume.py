"""Every chunk of flesh keeps its volume."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from spines import KINDS, RADIUS, Kind, Match, Method, Twist, about, determinants, helix, line, poses, wave
from surfaces import Surface

TWISTS: tuple[Twist, ...] = (None, 2.0, (-0.5, 1.0), (0.1, 0.5, -1.0, 0.3, 0.6, 0.2, 0.0))
# Differences of the sixth order leave about 1e-10.
DETERMINANT_TOLERANCE = 1e-8


@pytest.mark.parametrize("kind", KINDS, ids=str)
@pytest.mark.parametrize("twist", TWISTS, ids=str)
def test_determinant_is_one_with_torsion_twist_and_stretch(kind: Kind, twist: Twist):
    rest = turgor.Spine(wave())
    posed = rest.posed(helix() * 1.2)
    points = about(rest, np.random.default_rng(1), 150)
    found = determinants(lambda p: turgor.flesh(p, rest, posed, kind, twist=twist), points)
    assert np.abs(found - 1).max() <= DETERMINANT_TOLERANCE


@given(poses(), poses(), st.sampled_from(KINDS), st.floats(-3, 3), st.floats(-1, 1))
def test_determinant_is_one_for_any_pose(before, after, kind: Kind, twist: float, slide: float):
    rest = turgor.Spine(before)
    posed = rest.posed(after)
    points = about(rest, np.random.default_rng(2), 20)
    flesh = turgor.Fleshing(rest, points, kind)
    is_valid = ~(flesh.validity(posed, twist=twist, slide=slide).is_clamped | flesh.stations.is_ambiguous)
    found = determinants(lambda p: turgor.flesh(p, rest, posed, kind, twist=twist, slide=slide), points[is_valid])
    # Where flesh is nearly squeezed flat differences lose digits.
    scale = 1 / (1.02 - flesh.validity(posed, twist=twist, slide=slide).usage[is_valid])
    assert (np.abs(found - 1) <= DETERMINANT_TOLERANCE * scale**3).all()


@pytest.mark.parametrize("match", ["relative_length", "length"])
@pytest.mark.parametrize("count", [5, 7, 12])
def test_determinant_is_one_for_spines_of_other_stations(match: Match, count: int):
    rest, posed = turgor.Spine(wave()), turgor.Spine(helix(count))
    points = about(rest, np.random.default_rng(3), 100)
    found = determinants(lambda p: turgor.flesh(p, rest, posed, match=match, slide=0.4, twist=1.0), points)
    assert np.abs(found - 1).max() <= DETERMINANT_TOLERANCE


def test_determinant_is_one_station_by_station():
    rest, posed = turgor.Spine(wave()), turgor.Spine(helix(), parameters="centripetal")
    points = about(rest, np.random.default_rng(3), 100)
    found = determinants(lambda p: turgor.flesh(p, rest, posed, slide=-0.3), points)
    assert np.abs(found - 1).max() <= DETERMINANT_TOLERANCE


@pytest.mark.parametrize("method", ["polynomial", "b_spline"])
def test_determinant_is_one_through_run_outs(method: Method):
    rest = turgor.Spine(wave(6), method)
    posed = rest.posed(helix(6))
    points = about(rest, np.random.default_rng(4), 150)
    found = determinants(lambda p: turgor.flesh(p, rest, posed), points)
    assert np.abs(found - 1).max() <= DETERMINANT_TOLERANCE


def test_without_stretch_volume_grows_as_the_spine():
    rest = turgor.Spine(line())
    posed = rest.posed(line(length=10.0))
    points = about(rest, np.random.default_rng(5), 50)
    found = determinants(lambda p: turgor.flesh(p, rest, posed, stretch=False), points)
    assert np.abs(found - 2).max() <= DETERMINANT_TOLERANCE


def cubes(centres: np.ndarray, edge: float) -> np.ndarray:
    """(N, 8, 3) corners."""
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij")).reshape(3, 8).T
    return centres[:, None] + 0.5 * edge * corners


CUBE_FACES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]], np.int32)


def cube_volumes(corners: np.ndarray) -> np.ndarray:
    """(N,) volume of each bilinear cube."""
    faces = (CUBE_FACES + 8 * np.arange(len(corners))[:, None, None]).reshape(-1, 4)
    points = corners.reshape(-1, 3)
    mesh = turgor.Mesh(points, np.arange(0, 4 * len(faces) + 1, 4, dtype=np.int32), faces.astype(np.int32).ravel(), 0.0)
    return mesh.component_volumes(points)


@pytest.mark.parametrize("kind", ["radial", "normal", "binormal"])
def test_local_error_of_cubes_falls_as_the_square_of_their_size(kind: Kind):
    radius = 0.5
    rest = turgor.Spine(line(9, 6.0))
    angle = np.linspace(0, 1.2 * np.pi, 9)
    posed = rest.posed(6 / (1.2 * np.pi) * np.column_stack([np.sin(angle), 1 - np.cos(angle), 0 * angle]))
    centres = about(rest, np.random.default_rng(6), 400, radius)
    errors = []
    for part in (0.2, 0.1, 0.05, 0.025):
        corners = cubes(centres, part * radius)
        fleshed = turgor.flesh(corners.reshape(-1, 3), rest, posed, kind).reshape(-1, 8, 3)
        errors.append(np.abs(cube_volumes(fleshed) / (part * radius) ** 3 - 1).mean())
    assert errors[1] <= 1e-3
    assert all(3.6 < before / after < 4.4 for before, after in pairwise(errors)), errors


def ball(level: int) -> Surface:
    """A sphere of quads: the rhombic triacontahedron, each quad cut in four per level: 32, 122, 482, 1922 vertices."""
    golden = (1 + 5**0.5) / 2
    icosahedron = np.array(
        [np.roll([0, a, b * golden], turn) for turn in range(3) for a in (-1, 1) for b in (-1, 1)], float
    )
    distance = np.linalg.norm(icosahedron[:, None] - icosahedron[None], axis=2)
    is_edge = np.abs(distance - 2) < 1e-9
    triangles = [
        (a, b, c)
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if is_edge[a, b] and is_edge[b, c] and is_edge[a, c]
    ]
    points = [*icosahedron, *(icosahedron[list(triangle)].sum(axis=0) for triangle in triangles)]
    faces = []
    for a in range(12):
        for b in range(a + 1, 12):
            if is_edge[a, b]:
                c, d = (12 + i for i, triangle in enumerate(triangles) if a in triangle and b in triangle)
                outwards = np.cross(points[b] - points[a], points[d] - points[c]) @ points[a]
                faces.append([a, c, b, d] if outwards > 0 else [a, d, b, c])
    for _ in range(level):
        middles: dict[tuple[int, ...], int] = {}
        quarters = []
        for face in faces:
            cut = []
            for corners in [*zip(face, [*face[1:], face[0]], strict=True), tuple(face)]:
                key = tuple(sorted(corners))
                if key not in middles:
                    middles[key] = len(points)
                    points.append(sum(points[corner] / np.linalg.norm(points[corner]) for corner in corners))
                cut.append(middles[key])
            quarters += [[face[i], cut[i], cut[4], cut[i - 1 if i else 3]] for i in range(4)]
        faces = quarters
    positions = np.array(points)
    return Surface(positions / np.linalg.norm(positions, axis=1, keepdims=True), faces)


@pytest.mark.parametrize("axes", [(0.8, 0.8, 0.8), (1.2, 0.6, 0.6)], ids=["ball", "spindle"])
def test_total_error_falls_as_the_square_of_the_edges(axes: tuple[float, float, float]):
    """[ZR13, figure 8]: what is left is that faces are chords of the bent body."""
    rest = turgor.Spine(line(7, 6.0))
    posed = rest.posed(helix(7, turns=0.35, radius=2.7, rise=1.0))
    errors = []
    for level, count in enumerate((32, 122, 482, 1922)):
        surface = ball(level)
        assert len(surface.positions) == count
        positions = surface.positions * axes + [3.0, 0, 0]
        mesh = turgor.Mesh(positions, surface.face_offsets, surface.face_corners)
        errors.append(abs(mesh.volume(turgor.flesh(positions, rest, posed)) / mesh.volume(positions) - 1))
    assert all(before / after > 3.4 for before, after in pairwise(errors)), errors
    assert errors[-1] <= 2e-4


@pytest.mark.parametrize("slide", np.linspace(0, 6, 13))
def test_a_body_that_slides_along_a_path_keeps_its_volume(slide: float):
    surface = ball(3)
    positions = surface.positions * [1.6, 0.35, 0.35] + [2.0, 0, 0]
    mesh = turgor.Mesh(positions, surface.face_offsets, surface.face_corners)
    rest, path = turgor.Spine(line(2, 4.0)), turgor.Spine(wave(15, 10.0, 0.3))
    fleshed = turgor.flesh(positions, rest, path, match="length", slide=slide)
    assert abs(mesh.volume(fleshed) / mesh.volume(positions) - 1) <= 1e-3


def test_cubes_of_a_tube_on_an_arc_keep_their_volume():
    """[ZR13, figure 4]: half a circle, where the inside of a plain bend loses a fifth."""
    rest = turgor.Spine(line(9, 4.0))
    angle = np.linspace(0, np.pi, 9)
    posed = rest.posed(4 / np.pi * np.column_stack([np.sin(angle), 1 - np.cos(angle), 0 * angle]))
    corners = cubes(about(rest, np.random.default_rng(8), 200, RADIUS), 0.02)
    fleshed = turgor.flesh(corners.reshape(-1, 3), rest, posed).reshape(-1, 8, 3)
    assert np.abs(cube_volumes(fleshed) / 0.02**3 - 1).max() < 1e-3
