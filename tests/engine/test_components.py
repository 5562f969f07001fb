"""Shells, seams and openings (MATH 1)."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from reference_volume import mean_of_fans
from rigs import chain
from surfaces import Surface, cube, open_tube, strip, tube

seeds = st.integers(0, 2**32 - 1)


def statuses(surface: Surface) -> list[str]:
    return [component.status for component in surface.mesh().components]


@given(seeds)
def test_split_seams_are_welded(seed: int):
    whole = tube().roughened(np.random.default_rng(seed), 0.1)
    split = whole.split_apart()
    mesh = split.mesh()
    assert mesh.welded_count == len(whole.positions)
    assert [component.status for component in mesh.components] == ["closed"]
    assert mesh.volume(split.positions) == pytest.approx(whole.mesh().volume(whole.positions), rel=1e-13)


def test_coincident_vertices_share_the_gradient_of_their_point():
    whole = tube()
    split = whole.split_apart()
    gradient = split.mesh().volume_gradient(split.positions)
    counts = np.bincount(whole.face_corners)
    shared = whole.mesh().volume_gradient(whole.positions) / counts[:, None]
    np.testing.assert_allclose(gradient, shared[whole.face_corners], atol=1e-14)


def test_surface_passes_through_the_mean_of_coincident_vertices():
    whole, split = tube(), tube().split_apart()
    rng = np.random.default_rng(7)
    torn = split.positions + rng.uniform(-0.05, 0.05, split.positions.shape)
    count = np.bincount(whole.face_corners)
    means = np.stack([np.bincount(whole.face_corners, torn[:, axis]) / count for axis in range(3)], axis=1)
    assert split.mesh().volume(torn) == pytest.approx(mean_of_fans(whole, means), rel=1e-13)


@given(seeds)
def test_capped_volume_does_not_depend_on_the_origin(seed: int):
    rng = np.random.default_rng(seed)
    surface = open_tube().roughened(rng, 0.1)
    mesh = surface.mesh()
    assert [component.status for component in mesh.components] == ["capped"]
    shifted = surface.positions + rng.uniform(-10.0, 10.0, 3)
    assert mesh.volume(shifted) == pytest.approx(mesh.volume(surface.positions), rel=1e-12)
    np.testing.assert_allclose(mesh.volume_gradient(shifted).sum(axis=0), 0.0, atol=1e-12)


def test_cap_is_a_fan_to_the_mean_of_its_rim():
    surface = open_tube(rings=9, sides=8)
    closed = tube(rings=9, sides=8)
    # Both rims are flat and regular: a fan and an n-gon enclose the same.
    assert surface.mesh().volume(surface.positions) == pytest.approx(closed.mesh().volume(closed.positions), rel=1e-13)


def test_shells_count_on_their_own():
    small = cube()
    both = tube().joined(small.moved(0.1 * small.positions + 9.0))
    mesh = both.mesh()
    volumes = mesh.component_volumes(both.positions)
    parts = sorted([tube().mesh().volume(tube().positions), 1e-3])
    np.testing.assert_allclose(sorted(volumes), parts, rtol=1e-12)
    assert mesh.volume(both.positions) == pytest.approx(volumes.sum(), rel=1e-14)
    assert sorted(component.vertex_count for component in mesh.components) == [8, len(tube().positions)]
    assert len(set(mesh.vertex_components[-8:])) == 1


def test_one_turned_face_is_turned_back():
    surface = tube()
    faces = [list(face) for face in surface.faces]
    faces[5] = faces[5][::-1]
    mesh = Surface(surface.positions, faces).mesh()
    (component,) = mesh.components
    assert component.status == "closed"
    assert component.flipped_face_count == 1
    assert mesh.volume(surface.positions) == pytest.approx(surface.mesh().volume(surface.positions), rel=1e-14)


def test_inward_shell_has_negative_volume():
    (component,) = cube().reversed().mesh().components
    assert component.rest_volume == pytest.approx(-1.0)
    assert component.is_sound


def test_a_strip_has_no_inside():
    (component,) = strip().mesh().components
    assert component.status in ("sheet", "flat")
    assert not component.is_sound
    assert strip().mesh().volume(strip().positions) == 0.0


def test_a_squashed_cube_encloses_nothing():
    surface = cube()
    assert statuses(surface.moved(surface.positions * [1.0, 1.0, 0.0])) == ["flat"]


def test_an_edge_of_three_faces_is_not_manifold():
    surface = cube()
    fin = np.array([[2.0, 0.0, 0.5], [2.0, 1.0, 0.5]])
    edge = [4, 6]
    finned = Surface(np.vstack([surface.positions, fin]), [*surface.faces, [*edge, 9, 8]])
    assert statuses(finned) == ["non_manifold"]


def test_a_moebius_strip_is_not_orientable():
    count = 12
    turn = np.arange(count) * 2 * np.pi / count
    rim = np.stack([np.cos(turn), np.sin(turn), np.zeros(count)], axis=1)
    across = 0.3 * np.stack(
        [np.cos(turn) * np.cos(turn / 2), np.sin(turn) * np.cos(turn / 2), np.sin(turn / 2)], axis=1
    )
    positions = np.concatenate([rim - across, rim + across])
    faces = [[i, i + 1, i + 1 + count, i + count] for i in range(count - 1)]
    faces.append([count - 1, count, 0, 2 * count - 1])
    assert statuses(Surface(positions, faces)) == ["not_orientable"]


def test_loose_vertices_belong_to_nothing():
    surface = cube()
    mesh = surface.moved(np.vstack([surface.positions, [[5.0, 5.0, 5.0]]])).mesh()
    assert mesh.vertex_components[-1] == -1
    assert mesh.volume(mesh.rest_positions) == pytest.approx(1.0)


def test_nothing_is_a_mesh_too():
    empty = turgor.Mesh(np.zeros((0, 3)), np.zeros(1, np.int32), np.zeros(0, np.int32))
    assert empty.components == []
    assert empty.volume(np.zeros((0, 3))) == 0.0


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
def test_shells_that_share_a_point_are_both_exact(solver: Literal["simultaneous", "sequential"]):
    below, above = tube(17, 8), tube(17, 8)
    lifted = above.positions + np.array([0.0, 1.0, 0.0])
    touching = [2.0, 0.5, 0.0]
    kept = int(np.argmin(np.abs(below.positions - touching).sum(axis=1)))
    dropped = int(np.argmin(np.abs(lifted - touching).sum(axis=1)))
    index = np.arange(len(lifted)) + len(below.positions)
    index[dropped:] -= 1
    index[dropped] = kept
    faces = [*below.faces, *[[int(index[corner]) for corner in face] for face in above.faces]]
    surface = Surface(np.vstack([below.positions, np.delete(lifted, dropped, axis=0)]), faces)
    rig = chain(surface, 3)
    frame = rig.body(solver=solver).deform(rig.bent(0.7))
    found = surface.mesh().component_volumes(frame.positions)
    np.testing.assert_allclose(found, frame.report.target_volumes, rtol=1e-12)


def test_rims_that_share_points_are_capped_each_on_its_own():
    """A prism stands on an open box: two opposite corners of their rims are the same points."""
    box = cube()
    rim = [(0.0, 0.0), (0.8, 0.2), (1.0, 1.0), (0.2, 0.8)]
    prism = np.array([(x, y, z) for z in (1.0, 2.0) for x, y in rim])
    walls = [[i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i] for i in range(4)]
    index = [1, 8, 7, 9, 10, 11, 12, 13]  # corners of `prism` after those of the box; 1 and 7 are the box's
    positions = np.vstack([box.positions, prism[[1, 3, 4, 5, 6, 7]]])
    open_box = [face for face in box.faces if face != [1, 5, 7, 3]]
    faces = [*open_box, *[[index[corner] for corner in face] for face in [*walls, [4, 5, 6, 7]]]]
    parts = Surface(positions, faces).mesh().components
    assert [part.status for part in parts] == ["capped", "capped"]
    np.testing.assert_allclose([part.rest_volume for part in parts], [1.0, 0.6], rtol=1e-12)
