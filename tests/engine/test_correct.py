"""The bare formula of MATH 2: any weights, any axes, exact in one step per axis."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from surfaces import Surface, cube, tube

seeds = st.integers(0, 2**32 - 1)


def random_case(seed: int) -> tuple[Surface, np.ndarray, np.ndarray, float, np.random.Generator]:
    """A rough tube, dented positions, weights >= 0 and a target within a fifth."""
    rng = np.random.default_rng(seed)
    surface = tube().roughened(rng, 0.05)
    positions = surface.roughened(rng, 0.05).positions
    gamma = rng.uniform(0.0, 1.0, len(positions)) ** 4
    target = surface.mesh().volume(surface.positions) * rng.uniform(0.8, 1.2)
    return surface, positions, gamma, target, rng


def one_axis(mesh: turgor.Mesh, positions: np.ndarray, loss: float, gamma: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """MATH 2 as printed: the displacement that adds `loss` along one axis."""
    slope = mesh.volume_gradient(positions) @ axis
    return np.outer(loss * gamma * slope / np.sum(gamma * slope**2), axis)


@given(seeds)
def test_any_weights_and_axes_are_exact(seed: int):
    surface, positions, gamma, target, rng = random_case(seed)
    mesh = surface.mesh()
    axes = rng.normal(size=(3, 3))
    shares = rng.dirichlet([1.0, 1.0, 1.0])
    for given_shares in (tuple(shares), "auto"):
        corrected = turgor.correct(mesh, positions, target, gamma, axes, given_shares)
        assert mesh.volume(corrected) == pytest.approx(target, rel=1e-12)


@given(seeds)
def test_three_axes_follow_the_formula(seed: int):
    surface, positions, gamma, target, rng = random_case(seed)
    mesh = surface.mesh()
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    shares = rng.dirichlet([1.0, 1.0, 1.0])
    loss = target - mesh.volume(positions)
    expected = positions
    for share, axis in zip(shares, axes, strict=True):
        expected = expected + one_axis(mesh, expected, share * loss, gamma, axis)
    corrected = turgor.correct(mesh, positions, target, gamma, axes, tuple(shares))
    np.testing.assert_allclose(corrected, expected, atol=1e-12)


@given(seeds)
def test_length_of_an_axis_does_not_matter(seed: int):
    surface, positions, gamma, target, rng = random_case(seed)
    mesh = surface.mesh()
    axes = rng.normal(size=(3, 3))
    longer = axes * rng.uniform(0.1, 10.0, (3, 1))
    shares = (0.2, 0.3, 0.5)
    results = [turgor.correct(mesh, positions, target, gamma, frame, shares) for frame in (axes, longer)]
    np.testing.assert_allclose(results[0], results[1], atol=1e-12)


@given(seeds)
def test_without_a_frame_it_is_exact_too(seed: int):
    surface, positions, gamma, target, _ = random_case(seed)
    mesh = surface.mesh()
    assert mesh.volume(turgor.correct(mesh, positions, target, gamma)) == pytest.approx(target, rel=1e-12)


@given(seeds)
def test_no_weight_is_no_movement(seed: int):
    surface, positions, gamma, target, rng = random_case(seed)
    gamma[rng.random(len(gamma)) < 0.5] = 0.0
    for frame in (None, np.eye(3)):
        corrected = turgor.correct(surface.mesh(), positions, target, gamma, frame)
        assert np.array_equal(corrected[gamma == 0.0], positions[gamma == 0.0])


@given(seeds)
def test_right_volume_is_left_alone(seed: int):
    surface, positions, gamma, _, _ = random_case(seed)
    mesh = surface.mesh()
    same = turgor.correct(mesh, positions, mesh.volume(positions), gamma, np.eye(3))
    np.testing.assert_allclose(same, positions, atol=1e-13)


def test_auto_shares_move_less_than_equal_ones():
    surface, positions, gamma, target, _ = random_case(3)
    mesh = surface.mesh()
    moves = [
        np.linalg.norm(turgor.correct(mesh, positions, target, gamma, np.eye(3), shares) - positions)
        for shares in ("auto", (1 / 3, 1 / 3, 1 / 3))
    ]
    assert moves[0] <= moves[1] * (1 + 1e-9)


def test_each_component_has_its_target():
    big, small = tube(), cube()
    both = big.joined(small.moved(small.positions + 5.0))
    mesh = both.mesh()
    targets = mesh.component_volumes(both.positions) * [1.1, 0.9]
    corrected = turgor.correct(mesh, both.positions, targets, np.ones(len(both.positions)))
    np.testing.assert_allclose(mesh.component_volumes(corrected), targets, rtol=1e-12)


def test_share_of_one_axis_moves_along_that_axis():
    surface = cube()
    mesh = surface.mesh()
    corrected = turgor.correct(mesh, surface.positions, 1.5, np.ones(8), np.eye(3), (1.0, 0.0, 0.0))
    assert mesh.volume(corrected) == pytest.approx(1.5, rel=1e-12)
    assert np.array_equal(corrected[:, 1:], surface.positions[:, 1:])


def test_nothing_to_move_is_an_error():
    surface = cube()
    with pytest.raises(turgor.TurgorError):
        turgor.correct(surface.mesh(), surface.positions, 1.5, np.zeros(8))
