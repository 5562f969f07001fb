"""What fleshing keeps besides volume: the spine, its lengths, identity, rigid motions, continuity."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from spines import KINDS, Kind, Match, about, helix, line, poses, size, wave

RNG = np.random.default_rng(12)


def rotation(seed: int) -> np.ndarray:
    """(3, 3) a proper rotation."""
    q = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.sign(np.linalg.det(q))


@given(poses(), st.sampled_from(KINDS), st.booleans())
def test_rest_is_the_identity(stations, kind: Kind, as_pose: bool):
    rest = turgor.Spine(stations)
    points = about(rest, np.random.default_rng(0), 200)
    posed = rest.posed(stations) if as_pose else rest
    assert np.abs(turgor.flesh(points, rest, posed, kind) - points).max() <= 1e-15 * size(points)


@given(poses(), poses(), st.sampled_from(KINDS), st.floats(-2, 2), st.floats(-0.5, 0.5), st.booleans())
def test_inverse_comes_back(before, after, kind: Kind, twist: float, slide: float, stretch: bool):
    rest = turgor.Spine(before)
    posed = rest.posed(after)
    points = about(rest, np.random.default_rng(1), 100, 0.15)
    flesh = turgor.Fleshing(rest, points, kind)
    validity = flesh.validity(posed, twist=twist, slide=slide, stretch=stretch)
    there = flesh.deform(posed, twist=twist, slide=slide, stretch=stretch)
    back = flesh.inverse(there, posed, twist=twist, slide=slide, stretch=stretch)
    # Flesh squeezed to a tenth has a digit less.
    is_valid = ~(validity.is_overlapping | validity.is_ambiguous) & (validity.usage < 0.9)
    assert np.abs(back - points)[is_valid].max() <= 1e-12 * size(points, there)


@pytest.mark.parametrize("match", ["stations", "relative_length", "length"])
def test_inverse_comes_back_from_spines_of_other_parameters(match):
    rest, posed = turgor.Spine(wave()), turgor.Spine(helix(), parameters="centripetal")
    points = about(rest, RNG, 200)
    flesh = turgor.Fleshing(rest, points, match=match)
    there = flesh.deform(posed, twist=1.0, slide=0.3)
    assert np.abs(flesh.inverse(there, posed, twist=1.0, slide=0.3) - points).max() <= 1e-12 * size(points, there)


@given(st.integers(2, 300), st.integers(2, 300), st.sampled_from(["relative_length", "length"]), st.integers(0, 99))
def test_spines_of_any_numbers_of_stations_match_by_length(rest_count: int, posed_count: int, match: Match, seed: int):
    """An artist may delete points of the posed curve. Straight spines move rigidly, whatever they are made of."""
    turn, shift = rotation(seed), np.array([1.0, -2.0, 0.5])
    rest = turgor.Spine(line(rest_count), normal=(0, 1, 0))
    posed = turgor.Spine(line(posed_count) @ turn.T + shift, normal=turn[:, 1])
    points = np.random.default_rng(seed).uniform([-1.0, -0.4, -0.4], [6.0, 0.4, 0.4], (300, 3))
    body = turgor.Fleshing(rest, points, match=match)
    moved = points @ turn.T + shift
    assert np.abs(body.deform(posed) - moved).max() <= 1e-12 * size(moved)
    assert np.abs(body.inverse(moved, posed) - points).max() <= 1e-12 * size(moved)
    assert not body.validity(posed).is_clamped.any()
    assert body.valid_radii(posed, np.linspace(*rest.parameter_range, 7)).min() > 1.0


@given(poses(), poses(), st.sampled_from(KINDS))
def test_spine_goes_to_spine_and_stations_to_stations(before, after, kind: Kind):
    rest = turgor.Spine(before)
    posed = rest.posed(after)
    first, last = rest.parameter_range
    parameters = np.linspace(first - 0.4, last + 0.4, 101)
    fleshed = turgor.flesh(rest.evaluate(parameters).positions, rest, posed, kind, twist=1.0)
    assert np.abs(fleshed - posed.evaluate(parameters).positions).max() <= 1e-14 * size(fleshed)
    points = about(rest, np.random.default_rng(2), 100, 0.15)
    flesh = turgor.Fleshing(rest, points, kind)
    is_valid = ~(flesh.validity(posed).is_overlapping | flesh.validity(posed).is_clamped) & (
        flesh.validity(posed).usage < 0.9
    )
    again = posed.closest(flesh.deform(posed)).parameters
    assert np.abs(again - flesh.stations.parameters)[is_valid].max() <= 1e-12 * last


@given(poses(), poses(), st.integers(0, 99))
def test_rigid_motions_of_the_pose_move_the_body(before, after, seed: int):
    rest = turgor.Spine(before)
    turn, shift = rotation(seed), np.random.default_rng(seed).normal(size=3)
    posed = rest.posed(after)
    normal = posed.evaluate(posed.station_parameters[:1]).normals[0]
    moved = rest.posed(after @ turn.T + shift, normal=turn @ normal)
    points = about(rest, np.random.default_rng(3), 100)
    expected = turgor.flesh(points, rest, posed, twist=0.7) @ turn.T + shift
    assert np.abs(turgor.flesh(points, rest, moved, twist=0.7) - expected).max() <= 2e-13 * size(expected)


def test_straight_spines_move_rigidly():
    rest = turgor.Spine(line(), normal=(0, 1, 0))
    turn = rotation(5)
    posed = rest.posed(line() @ turn.T + [1, 2, 3], normal=turn @ [0, 1, 0])
    points = about(rest, RNG, 300, 1.5)
    for kind in KINDS:
        assert np.abs(turgor.flesh(points, rest, posed, kind) - (points @ turn.T + [1, 2, 3])).max() <= 5e-15 * size(
            points
        )


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_inflections_and_nearly_straight_poses_are_harmless(kind: Kind):
    rest = turgor.Spine(line())
    points = about(rest, RNG, 300)
    still = turgor.flesh(points, rest, rest, kind)
    for height in (1e-3, 1e-6, 1e-9, 1e-12, 1e-16, 1e-200):
        bent = line() + height * np.column_stack([np.zeros(7), np.cos(np.arange(7) * 2.0), np.sin(np.arange(7) * 3.0)])
        assert np.abs(turgor.flesh(points, rest, rest.posed(bent), kind) - still).max() <= 8 * height + 2e-15


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_frames_in_time_are_continuous(kind: Kind):
    """Halving the step of time halves the step of every point: nothing jumps."""
    rest = turgor.Spine(wave())
    points = about(rest, RNG, 500)
    flesh = turgor.Fleshing(rest, points, kind)

    def largest_step(count: int) -> float:
        time = np.linspace(0, 1, count + 1)
        frames = [flesh.deform(rest.posed(helix(turns=0.6 * t, radius=1 + t)), twist=3 * t, slide=t) for t in time]
        return max(np.abs(b - a).max() for a, b in pairwise(frames))

    coarse, fine = largest_step(40), largest_step(80)
    assert fine < 0.6 * coarse


@pytest.mark.parametrize("method", ["spline", "polynomial", "b_spline"])
@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_surfaces_have_no_creases(method, kind: Kind):
    """Along lines beside the spine the direction of the body turns evenly: also across knots, ends and run-outs."""
    rest = turgor.Spine(line(6), method)
    posed = rest.posed(helix(6))
    x = np.linspace(-1.5, 6.5, 8001)
    for y, z in [(0.2, 0.0), (-0.1, 0.2), (0.0, -0.25)]:
        points = np.column_stack([x, np.full_like(x, y), np.full_like(x, z)])
        steps = np.diff(turgor.flesh(points, rest, posed, kind, twist=1.0), axis=0)
        directions = steps / np.linalg.norm(steps, axis=1, keepdims=True)
        turns = np.linalg.norm(np.diff(directions, axis=0), axis=1)
        # One radian per unit of length would be 1e-3 here; a crease of a hundredth of a degree 1.7e-4 at once.
        jumps = np.abs(np.diff(turns))
        assert jumps.max() < 1.7e-4, np.degrees(jumps.max())


def test_order_of_points_does_not_matter():
    rest = turgor.Spine(wave())
    posed = rest.posed(helix())
    points = about(rest, RNG, 1003)
    shuffled = RNG.permutation(len(points))
    for kind in KINDS:
        whole = turgor.flesh(points, rest, posed, kind, twist=1.0, slide=0.2)
        assert np.array_equal(turgor.flesh(points[shuffled], rest, posed, kind, twist=1.0, slide=0.2), whole[shuffled])
        assert np.array_equal(turgor.flesh(points[:7], rest, posed, kind, twist=1.0, slide=0.2), whole[:7])


def digest() -> str:
    """What a subprocess prints."""
    rest = turgor.Spine(wave())
    points = about(rest, np.random.default_rng(9), 20_000)
    result = hashlib.sha256()
    for kind in KINDS:
        flesh = turgor.Fleshing(rest, points, kind)
        for posed in (rest.posed(helix()), rest.posed(wave(height=0.5))):
            result.update(flesh.deform(posed, twist=1.0).tobytes())
            result.update(flesh.deform(posed, slide=0.3).tobytes())
            result.update(flesh.inverse(points, posed).tobytes())
    return result.hexdigest()


def test_number_of_threads_does_not_matter():
    command = [sys.executable, "-c", "import test_spine_map as t; print(t.digest())"]
    here = Path(__file__).parent
    digests = {
        subprocess.run(
            command,
            cwd=here,
            env={**os.environ, "RAYON_NUM_THREADS": str(count)},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for count in (1, 2, 5)
    }
    assert len(digests) == 1


def test_every_way_out_gives_the_same():
    rest = turgor.Spine(wave())
    posed = rest.posed(helix())
    points = about(rest, RNG, 333)
    flesh = turgor.Fleshing(rest, points, "normal")
    positions = flesh.deform(posed, twist=0.5)
    offsets, raw = np.zeros((333, 3), np.float32), np.zeros((333, 3), np.float32)
    report = flesh.deform_into(offsets, posed, twist=0.5)
    flesh.deform_into_address(raw.ctypes.data, len(raw), posed, twist=0.5)
    assert np.array_equal(offsets, (positions - points).astype(np.float32))
    assert np.array_equal(raw, offsets)
    assert np.array_equal(turgor.flesh(points, rest, posed, "normal", twist=0.5), positions)
    assert np.array_equal(turgor.Fleshing(rest, points).with_kind("normal").deform(posed, twist=0.5), positions)
    assert report.max_offset == pytest.approx(np.linalg.norm(positions - points, axis=1).max(), rel=1e-15)
    assert report.clamped_count == flesh.validity(posed, twist=0.5).is_clamped.sum()


def test_influence_is_the_part_of_the_way():
    rest = turgor.Spine(wave())
    posed = rest.posed(helix())
    points = about(rest, RNG, 100)
    influence = RNG.uniform(0, 1, 100)
    influence[:10], influence[10:20] = 0, 1
    whole = turgor.flesh(points, rest, posed)
    mixed = turgor.flesh(points, rest, posed, influence=influence)
    assert np.array_equal(mixed[:10], points[:10])
    assert np.array_equal(mixed[10:20], whole[10:20])
    assert np.allclose(mixed, points + influence[:, None] * (whole - points), rtol=0, atol=1e-14)


def test_slide_moves_along_the_posed_spine():
    rest = turgor.Spine(line(2, 4.0))
    path = turgor.Spine(wave(15, 10.0))
    stations = np.column_stack([np.linspace(-1, 5, 50), np.zeros((50, 2))])
    for slide in (-1.0, 0.0, 2.5, 6.0):
        fleshed = turgor.flesh(stations, rest, path, match="length", slide=slide)
        expected = path.evaluate(path.parameters_at(stations[:, 0] + slide)).positions
        assert np.abs(fleshed - expected).max() < 1e-12


def test_twist_turns_about_the_tangent():
    rest = turgor.Spine(line(5, 4.0), normal=(0, 1, 0))
    points = np.array([[x, 0.3, 0.0] for x in (-1.0, 0.0, 1.0, 2.0, 4.0, 5.0)])

    def angles(twist: float | Sequence[float]) -> np.ndarray:
        fleshed = turgor.flesh(points, rest, rest, twist=twist)
        return np.arctan2(fleshed[:, 2], fleshed[:, 1])

    assert angles(1.0)[[0, 1, 3, 4, 5]] == pytest.approx([0, 0, 0.5, 1, 1], abs=1e-14)
    assert angles((-0.5, 1.0))[[0, 1, 4, 5]] == pytest.approx([-0.5, -0.5, 1, 1], abs=1e-14)
    assert angles([0.1, 0.9, -0.4, 0.2, 0.3]) == pytest.approx([0.1, 0.1, 0.9, -0.4, 0.3, 0.3], abs=1e-14)


def test_validity_tells_where_the_map_is_exact():
    rest = turgor.Spine(line(9, 4.0))
    angle = np.linspace(0, np.pi, 9)
    posed = rest.posed(4 / np.pi * np.column_stack([np.sin(angle), 1 - np.cos(angle), 0 * angle]))
    middle = posed.evaluate([2.0])
    radius = middle.speeds[0] ** 0.5 / np.linalg.norm(middle.curvatures[0])
    points = np.column_stack([np.full(40, 2.0), np.linspace(-2, 1.2, 40), np.zeros(40)])
    borders: list[tuple[Kind, float]] = [("radial", 1 / 3**0.5), ("normal", 0.5), ("binormal", 0.95)]
    for kind, border in borders:
        flesh = turgor.Fleshing(rest, points, kind)
        found = flesh.validity(posed)
        assert np.array_equal(found.is_clamped, points[:, 1] > flesh.valid_radii(posed, [2.0])[0])
        assert flesh.valid_radii(posed, [2.0])[0] == pytest.approx(border * radius, rel=1e-9)
        assert (found.usage[found.is_clamped] == 1).all()
        assert (np.diff(found.usage) >= 0).all()
        assert not found.is_overlapping[~found.is_clamped].any()
        assert found.valid_count == (~found.is_clamped).sum()
    assert np.isinf(turgor.Fleshing(rest, points).valid_radii(rest, [2.0])).all()


def test_a_body_that_reaches_into_itself_is_told():
    """Local curvature allows it, the next turn of the helix does not."""
    rest = turgor.Spine(line(41, 20.0))
    posed = rest.posed(helix(41, 3.2, 1.0, 1.2))
    flesh = turgor.Fleshing(rest, about(rest, RNG, 500, 0.45))
    found = flesh.validity(posed)
    assert found.is_overlapping.sum() > 100
    assert flesh.validity(rest).is_overlapping.sum() == 0


def test_places_without_a_station_are_told():
    """The axis of an arc, and the plane between two ends of it."""
    angle = np.linspace(-2.2, 2.2, 25)
    rest = turgor.Spine(np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]))
    found = rest.closest([[-0.6, 0.0, 0.0], [-0.6, 0.1, 0.0], [1.2, 0.0, 0.0], [np.cos(2.2) - 1, np.sin(2.2) - 0.7, 0]])
    assert found.is_ambiguous.tolist() == [True, False, False, False]
    assert found.is_beyond_ends.tolist()[:3] == [False, False, False] or found.is_beyond_ends[0]
    assert turgor.Fleshing(rest, [[-0.6, 0.0, 0.0]]).validity(rest).is_ambiguous.all()
