"""How a joint's volume is shared among its axes and the least displacement (MATH 2)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Rig, limb
from surfaces import tube

EXACT = 1e-12
seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])
curves = st.sampled_from([None, "rubber", "muscle", "folds"])
parts = st.floats(0.0, 1.0).map(lambda x: round(x, 3))
mixes = st.tuples(parts, parts, parts, parts).filter(any)


def joints(rig: Rig, shares: turgor.presets.Shares, preset=None, **settings) -> list[turgor.Joint]:
    tables = None if preset is None else turgor.presets.profiles(preset)
    return [turgor.Joint(bone, shares, tables, **settings) for bone in range(rig.bone_count)]


@given(seeds, modes, solvers, curves, mixes)
def test_any_mix_is_exact(seed: int, mode, solver, preset, shares):
    rig = limb()
    body = rig.body(mode, joints(rig, shares, preset), solver=solver)
    frame = body.deform(rig.random_pose(np.random.default_rng(seed), 1.0))
    assert frame.report.relative_error <= EXACT
    assert rig.surface.mesh().volume(frame.positions) == pytest.approx(frame.report.target_volumes.sum(), rel=EXACT)


@given(seeds, solvers, curves, mixes)
def test_four_numbers_are_the_three_or_auto(seed: int, solver, preset, shares):
    rig = limb()
    pose = rig.random_pose(np.random.default_rng(seed), 1.0)
    along = shares[:3] if any(shares[:3]) else (1.0, 1.0, 1.0)
    for short, long in [(along, (*along, 0.0)), ("auto", (0.0, 0.0, 0.0, 0.7)), (None, (0.0, 0.0, 0.0, 1.0))]:
        results = [rig.body(joints=joints(rig, s, preset), solver=solver).deform(pose).positions for s in (short, long)]
        assert np.array_equal(results[0], results[1])


@given(seeds, solvers, curves, mixes, st.floats(0.1, 10.0))
def test_only_ratios_count(seed: int, solver, preset, shares, factor: float):
    rig = limb()
    pose = rig.random_pose(np.random.default_rng(seed), 1.0)
    longer = tuple(share * factor for share in shares)
    results = [rig.body(joints=joints(rig, s, preset), solver=solver).deform(pose).positions for s in (shares, longer)]
    np.testing.assert_allclose(results[0], results[1], atol=1e-6)


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
@pytest.mark.parametrize("preset", [None, "muscle", "folds"])
@pytest.mark.parametrize("size", [1.0, 0.3])
def test_half_the_step_of_the_shares_is_half_the_step_of_the_vertices(solver, preset, size: float):
    """From auto through mixes to a single axis and on to another; small joints meet the cap on displacements."""
    rig = limb(rings=65, sides=12)
    pose = rig.bent(0.7, twist=0.4)
    ends = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.5, 0.5, 0.0], [0.0, 0.0, 0.0, 1.0]])

    def largest_step(count: int) -> float:
        times = np.linspace(0.0, 3.0, 3 * count + 1)
        mix = np.stack([np.interp(times, range(4), ends[:, part]) for part in range(4)], axis=1)
        bodies = [rig.body(joints=joints(rig, tuple(shares), preset, size=size), solver=solver) for shares in mix]
        return max(np.abs(b - a).max() for a, b in pairwise(body.deform(pose).positions for body in bodies))

    coarse, middle, fine = (largest_step(count) for count in (16, 32, 64))
    assert middle <= 0.6 * coarse
    assert fine <= 0.6 * middle


def test_a_mix_lies_between_its_parts():
    """Half automatic is half of each displacement, to first order."""
    rig = limb(rings=65, sides=12)
    pose = rig.bent(0.1)
    axis, mix, automatic = (
        rig.body(joints=joints(rig, shares, "rubber")).deform(pose).offsets
        for shares in ((0.0, 1.0, 0.0), (0.0, 0.5, 0.0, 0.5), "auto")
    )
    np.testing.assert_allclose(mix, (axis + automatic) / 2.0, atol=0.01 * np.abs(axis).max())


@pytest.mark.parametrize(
    ("shares", "kept"),
    [
        ("auto", "auto"),
        ((0.0, 0.0, 0.0, 2.0), "auto"),
        ((1.0, 1.0, 2.0), (0.25, 0.25, 0.5)),
        ((1.0, 1.0, 2.0, 0.0), (0.25, 0.25, 0.5)),
        ((1.0, 0.0, 2.0, 1.0), (0.25, 0.0, 0.5, 0.25)),
    ],
)
def test_shares_come_back_normalised(shares, kept):
    assert turgor.Joint(0, shares).shares == kept
    assert turgor.presets.joint("belly", 0, shares=shares).shares == kept


@pytest.mark.parametrize(
    ("shares", "message"),
    [
        ((0.0, 0.0, 0.0, 0.0), "sum of shares is 0, need at least one share above 0"),
        ((0.0, 0.0, 1.0, -0.5), "shares is -0.5, need numbers from 0 to 1e15"),
        ((1.0, 2.0), 'shares: need "auto", three numbers or four'),
        ((1.0, 2.0, 3.0, 4.0, 5.0), 'shares: need "auto", three numbers or four'),
        ((1.0, 1.0, 1.0, np.nan), "shares is NaN"),
    ],
)
def test_shares_that_are_none(shares, message: str):
    with pytest.raises(turgor.TurgorError, match=message):
        turgor.Joint(0, shares)


@given(seeds, mixes)
def test_the_bare_formula_takes_mixes_too(seed: int, shares):
    rng = np.random.default_rng(seed)
    surface = tube().roughened(rng, 0.05)
    mesh, axes = surface.mesh(), np.linalg.qr(rng.normal(size=(3, 3)))[0]
    gamma = rng.uniform(0.0, 1.0, len(surface.positions))
    target = mesh.volume(surface.positions) * rng.uniform(0.8, 1.2)
    corrected = turgor.correct(mesh, surface.positions, target, gamma, axes, shares)
    assert mesh.volume(corrected) == pytest.approx(target, rel=EXACT)
    along = shares[:3]
    if any(along):
        three, four = (turgor.correct(mesh, surface.positions, target, gamma, axes, s) for s in (along, (*along, 0.0)))
        assert np.array_equal(three, four)
