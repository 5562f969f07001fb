"""Laws of the enclosed volume and its gradient (MATH 1)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_volume import bilinear_patches, mean_of_fans
from rigs import applied, random_rigid_motion
from surfaces import Surface, cube, tube

seeds = st.integers(0, 2**32 - 1)


def rough_tube(seed: int) -> Surface:
    return tube().roughened(np.random.default_rng(seed), 0.1)


def test_unit_cube_holds_one():
    surface = cube()
    assert surface.mesh().volume(surface.positions) == pytest.approx(1.0, rel=1e-15)


@given(seeds)
def test_faces_of_any_size_count_as_the_mean_of_their_fans(seed: int):
    surface = rough_tube(seed)
    assert surface.mesh().volume(surface.positions) == pytest.approx(mean_of_fans(surface), rel=1e-13)


@given(seeds)
def test_quads_are_bilinear_patches(seed: int):
    surface = cube().roughened(np.random.default_rng(seed), 0.2)
    assert surface.mesh().volume(surface.positions) == pytest.approx(bilinear_patches(surface), rel=1e-13)


@given(seeds)
def test_gradient_is_the_derivative(seed: int):
    rng = np.random.default_rng(seed)
    surface = rough_tube(seed)
    mesh = surface.mesh()
    vertex, axis = rng.integers(len(surface.positions)), rng.integers(3)
    step = np.zeros_like(surface.positions)
    step[vertex, axis] = 0.5
    # Volume is linear in one coordinate, so any step gives the slope.
    slope = mesh.volume(surface.positions + step) - mesh.volume(surface.positions - step)
    assert mesh.volume_gradient(surface.positions)[vertex, axis] == pytest.approx(slope, abs=1e-13)


@given(seeds)
def test_closed_surfaces_have_no_net_push_and_no_net_turn(seed: int):
    surface = rough_tube(seed)
    gradient = surface.mesh().volume_gradient(surface.positions)
    np.testing.assert_allclose(gradient.sum(axis=0), 0.0, atol=1e-13)
    np.testing.assert_allclose(np.cross(surface.positions, gradient).sum(axis=0), 0.0, atol=1e-13)


@given(seeds)
def test_volume_is_homogeneous_of_degree_three(seed: int):
    surface = rough_tube(seed)
    mesh = surface.mesh()
    volume = mesh.volume(surface.positions)
    assert np.sum(surface.positions * mesh.volume_gradient(surface.positions)) == pytest.approx(3 * volume, rel=1e-13)
    assert mesh.volume(2.0 * surface.positions) == pytest.approx(8 * volume, rel=1e-13)


@given(seeds)
def test_rigid_motion_changes_nothing(seed: int):
    rng = np.random.default_rng(seed)
    surface = rough_tube(seed)
    mesh = surface.mesh()
    move = random_rigid_motion(rng)
    moved = applied(move, surface.positions)
    assert mesh.volume(moved) == pytest.approx(mesh.volume(surface.positions), rel=1e-13)
    turned = mesh.volume_gradient(surface.positions) @ move[:3, :3].T
    np.testing.assert_allclose(mesh.volume_gradient(moved), turned, atol=1e-13)


@given(seeds)
def test_far_from_the_origin_nothing_is_lost(seed: int):
    surface = rough_tube(seed)
    # Positions at 2²⁰ units are stored to 2⁻³³ of a unit: let the shift itself be free of rounding.
    grid = np.round(surface.positions * 2.0**30) / 2.0**30
    mesh = surface.moved(grid).mesh()
    assert mesh.volume(grid + 2.0**20) == pytest.approx(mesh.volume(grid), rel=1e-12)


@given(seeds)
def test_reversed_faces_negate_volume_and_gradient(seed: int):
    surface = rough_tube(seed)
    mesh, mirror = surface.mesh(), surface.reversed().mesh()
    assert mirror.volume(surface.positions) == pytest.approx(-mesh.volume(surface.positions), rel=1e-14)
    gradient = mesh.volume_gradient(surface.positions)
    np.testing.assert_allclose(mirror.volume_gradient(surface.positions), -gradient, atol=1e-15)


@given(seeds)
def test_float32_is_read_as_the_float64_of_the_same_values(seed: int):
    surface = rough_tube(seed)
    single = surface.positions.astype(np.float32)
    same = single.astype(np.float64)
    mesh = surface.mesh()
    assert mesh.volume(single) == mesh.volume(same)
    assert np.array_equal(mesh.volume_gradient(single), mesh.volume_gradient(same))


def test_layout_of_the_array_does_not_matter():
    surface = rough_tube(1)
    wide = np.zeros((len(surface.positions), 6))
    wide[:, ::2] = surface.positions
    mesh = surface.mesh()
    assert mesh.volume(wide[:, ::2]) == mesh.volume(surface.positions)
    assert mesh.volume(np.asfortranarray(surface.positions)) == mesh.volume(surface.positions)
    assert mesh.volume(surface.positions.tolist()) == mesh.volume(surface.positions)
