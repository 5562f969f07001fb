"""Spines: curves, frames, lengths, closest points."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from spines import Method, Points, about, helix, line, poses, size, wave

METHODS: tuple[Method, ...] = ("spline", "polynomial", "b_spline")


def derivative(values, t: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Difference of the sixth order of a function of the parameter."""
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    return np.sum([w * (values(t + k * step) - values(t - k * step)) for k, w in weights.items()], axis=0) / step


@pytest.mark.parametrize("method", ["spline", "polynomial"])
def test_curves_pass_through_their_points(method):
    spine = turgor.Spine(wave(), method)
    assert np.abs(spine.evaluate(spine.station_parameters).positions - wave()).max() < 1e-14


def test_b_splines_are_steered_by_their_points():
    points = wave(9)
    spine = turgor.Spine(points, "b_spline")
    ends = spine.evaluate(spine.parameter_range).positions
    assert np.abs(ends - points[[0, -1]]).max() < 1e-14
    # Moving all points moves the curve; a line of points is a line.
    assert np.abs(turgor.Spine(line(9), "b_spline").evaluate([1.3, 2.9]).positions[:, 1:]).max() < 1e-15
    # The tangent at an end points to the next control point.
    assert spine.evaluate([0.0]).tangents[0] == pytest.approx(
        (points[1] - points[0]) / np.linalg.norm(points[1] - points[0])
    )


def test_polynomials_of_many_points_tell_their_deviation():
    assert turgor.Spine(wave(6), "polynomial").deviation < 1e-14
    assert 0 < turgor.Spine(wave(9), "polynomial").deviation < 1e-6


@pytest.mark.parametrize("method", METHODS)
@given(poses())
def test_frames_are_orthonormal_and_exact(method, stations):
    spine = turgor.Spine(stations, method)
    first, last = spine.parameter_range
    t = np.linspace(first - 0.9, last + 0.9, 97) + 1e-3
    frames = spine.evaluate(t)
    axes = np.stack([frames.tangents, frames.normals, frames.binormals], axis=1)
    assert np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max() < 1e-14
    assert np.abs(np.cross(frames.tangents, frames.normals) - frames.binormals).max() < 1e-14
    velocity = derivative(lambda t: spine.evaluate(t).positions, t, 1e-4)
    assert np.abs(frames.tangents * frames.speeds[:, None] - velocity).max() < 1e-9
    curvature = derivative(lambda t: spine.evaluate(t).tangents, t, 1e-4) / frames.speeds[:, None]
    assert np.abs(frames.curvatures - curvature).max() < 1e-7


@pytest.mark.parametrize("method", METHODS)
def test_frames_do_not_turn_about_the_tangent(method):
    """A rotation-minimising normal changes along the tangent only."""
    spine = turgor.Spine(helix(9, 1.5), method)
    first, last = spine.parameter_range
    t = np.linspace(first - 1, last + 1, 1001)
    turning = derivative(lambda t: spine.evaluate(t).normals, t, 1e-4)
    rate = np.einsum("ij,ij->i", turning, spine.evaluate(t).binormals)
    # Fourth order in cells of a sixty-fourth of the spine.
    assert np.abs(rate).max() < 2e-5, np.abs(rate).max()


def test_a_closed_walk_of_frames_turns_by_the_solid_angle():
    """On a circle frames come back untwisted; on a helix they lag by the torsion's integral."""
    count, turns, radius, rise = 201, 1.0, 1.0, 1.5
    stations = helix(count, turns, radius, rise)
    spine = turgor.Spine(stations, normal=(-1, 0, 0))
    angle = np.pi  # half a turn, far from the straight ends
    quarter, three = (spine.evaluate([spine.station_parameters[round(k * (count - 1))]]) for k in (0.25, 0.75))
    slope = rise / (2 * np.pi * turns)
    speed = np.hypot(radius, slope)
    torsion = slope / speed**2 * speed * angle

    def angle_to_centre(frames: turgor.SpineFrames) -> float:
        centre = frames.curvatures[0]
        return float(np.arctan2(centre @ frames.binormals[0], centre @ frames.normals[0]))

    turned = angle_to_centre(three) - angle_to_centre(quarter)
    assert np.cos(turned - torsion) == pytest.approx(1, abs=1e-9)


def test_normals_start_where_asked_and_follow_the_pose():
    spine = turgor.Spine(line(), normal=(5, 0.6, 0.8))
    assert spine.evaluate([0.0]).normals[0] == pytest.approx([0, 0.6, 0.8])
    turned = spine.posed(line()[:, [1, 0, 2]])
    assert turned.evaluate([0.0]).normals[0] == pytest.approx([-0.6, 0, 0.8])
    for method in METHODS:
        assert turgor.Spine(wave(), method, normal=(0, 0, 1)).evaluate([0.0]).normals[0, 2] > 0.97


@given(poses())
def test_lengths_agree_with_fine_polygons(stations):
    spine = turgor.Spine(stations)
    first, last = spine.parameter_range
    t = np.linspace(first, last, 20001)
    polygon = np.linalg.norm(np.diff(spine.evaluate(t).positions, axis=0), axis=1)
    assert spine.length == pytest.approx(polygon.sum(), rel=1e-8)
    assert spine.arc_lengths_at(t[::1000]) == pytest.approx(np.concatenate([[0], np.cumsum(polygon)])[::1000], abs=1e-7)
    assert spine.station_lengths[-1] == spine.length
    lengths = np.linspace(-1, spine.length + 1, 50)
    assert np.abs(spine.arc_lengths_at(spine.parameters_at(lengths)) - lengths).max() < 1e-13 * (1 + spine.length)


def closest_by_search(spine: turgor.Spine, points: Points) -> NDArray[np.float64]:
    """(N,) distances to a fine polygon of the spine and its two rays from its ends."""
    first, last = spine.parameter_range
    t = np.linspace(first - 3, last + 3, 6001)
    positions = spine.evaluate(t).positions
    return np.linalg.norm(points[:, None] - positions[None], axis=2).min(axis=1)


@pytest.mark.parametrize("seed", range(8))
def test_no_point_of_a_wild_spine_is_nearer_than_the_closest(seed: int):
    rng = np.random.default_rng(seed)
    spine = turgor.Spine(rng.normal(size=(9, 3)))
    points = rng.normal(size=(300, 3)) * 1.5
    found = spine.closest(points)
    first, last = spine.parameter_range
    inside = (found.parameters > first) & (found.parameters < last)
    t = np.linspace(first, last, 6001)
    distances = np.linalg.norm(points[:, None] - spine.evaluate(t).positions[None], axis=2).min(axis=1)
    assert (found.distances[inside] <= distances[inside] + 1e-12).all()
    assert (found.distances[inside] >= distances[inside] - 5e-3).all()
    across = np.einsum("ij,ij->i", points - found.positions, spine.evaluate(found.parameters).tangents)
    assert np.abs(across).max() < 1e-13 * size(points)
    assert np.abs(np.linalg.norm(points - found.positions, axis=1) - found.distances).max() < 1e-15 * 10


@pytest.mark.parametrize("method", METHODS)
@given(poses(), st.integers(0, 9))
def test_points_beside_a_station_find_it(method, stations, seed: int):
    spine = turgor.Spine(stations, method)
    rng = np.random.default_rng(seed)
    first, last = spine.parameter_range
    t = np.sort(rng.uniform(first - 0.5, last + 0.5, 50))
    frames = spine.evaluate(t)
    points = frames.positions + 0.1 * frames.normals
    found = spine.closest(points)
    assert np.abs(found.parameters - t).max() < 1e-13 * (last - first) * 10
    assert np.array_equal(found.is_beyond_ends, (t < first) | (t > last))
    assert not found.is_ambiguous.any()


def test_points_of_the_spine_itself_and_far_away_are_found():
    spine = turgor.Spine(wave())
    t = np.concatenate([spine.station_parameters, np.linspace(-2, 8, 41)])
    found = spine.closest(spine.evaluate(t).positions)
    assert np.abs(found.parameters - t).max() < 1e-14 * 50
    assert found.distances.max() < 1e-15 * 10
    for far in (1e3, 1e6, 1e12, 1e15):
        assert np.isfinite(spine.closest(np.eye(3) * far).parameters).all()
    with pytest.raises(turgor.TurgorError, match="points: row 0"):
        spine.closest(np.eye(3) * 1e200)


def bezier(points: Points, left: Points, right: Points, count: int = 400) -> Points:
    """Places of Blender's curve."""
    u = np.linspace(0, 1, count)[:, None]
    segments = [
        (1 - u) ** 3 * points[i]
        + 3 * u * (1 - u) ** 2 * right[i]
        + 3 * u**2 * (1 - u) * left[i + 1]
        + u**3 * points[i + 1]
        for i in range(len(points) - 1)
    ]
    return np.concatenate(segments)


def bezier_controls() -> tuple[Points, Points, Points]:
    points = helix(5, 0.8)
    along = np.gradient(points, axis=0) / 3
    return points, points - 0.8 * along, points + 1.1 * along


def test_bezier_curves_are_followed_within_the_tolerance():
    controls = bezier_controls()
    for tolerance in (1e-2, 1e-3, 1e-4):
        spine = turgor.Spine.from_bezier(*controls, tolerance=tolerance)
        found = spine.closest(bezier(*controls))
        assert found.distances.max() <= 1.5 * tolerance * spine.length
        assert spine.deviation <= tolerance * spine.length
    assert spine.station_count == 5
    assert np.abs(spine.evaluate(spine.station_parameters).positions - controls[0]).max() < 1e-14
    again = turgor.Spine.from_bezier(*controls, resolution=spine.resolution)
    assert np.array_equal(again.evaluate([0.3, 1.7]).positions, spine.evaluate([0.3, 1.7]).positions)


def test_ends_of_blender_curves_keep_their_direction():
    points, left, right = bezier_controls()
    spine = turgor.Spine.from_bezier(points, left, right)
    ends = spine.evaluate(spine.parameter_range)
    assert ends.tangents[0] == pytest.approx((right[0] - points[0]) / np.linalg.norm(right[0] - points[0]))
    assert ends.tangents[1] == pytest.approx((points[-1] - left[-1]) / np.linalg.norm(points[-1] - left[-1]))
    # And their curvature, which falls to 0 within the run-outs.
    beyond = spine.evaluate(np.array(spine.parameter_range) + np.array([-0.13, 0.13]) * spine.length)
    assert np.linalg.norm(ends.curvatures, axis=1).min() > 0.1
    assert np.abs(beyond.curvatures).max() == 0


def test_handles_in_their_points_are_no_trouble():
    points = wave(4)
    spine = turgor.Spine.from_bezier(points, points, points)
    assert np.abs(spine.evaluate(spine.station_parameters).positions - points).max() < 1e-14
    assert np.isfinite(turgor.flesh(about(spine, np.random.default_rng(0), 50), spine, spine)).all()


def test_nurbs_curves_of_equal_weights_are_b_splines():
    points = wave(8)
    for order in range(2, 7):
        spine = turgor.Spine.from_nurbs(points, order=order, resolution=8)
        ends = spine.evaluate(spine.parameter_range).positions
        assert np.abs(ends - points[[0, -1]]).max() < 1e-14
    inner = turgor.Spine.from_nurbs(points, use_endpoint=False, resolution=8)
    first = (points[0] + 4 * points[1] + points[2]) / 6
    assert inner.evaluate([0.0]).positions[0] == pytest.approx(first)


def test_nurbs_weights_make_circles():
    half = np.sqrt(0.5)
    spine = turgor.Spine.from_nurbs([[1, 0, 0], [1, 1, 0], [0, 1, 0]], [1, half, 1], order=3, tolerance=1e-7)
    first, last = spine.parameter_range
    frames = spine.evaluate(np.linspace(first, last, 33))
    assert np.abs(np.linalg.norm(frames.positions, axis=1) - 1).max() < 1e-6
    assert spine.length == pytest.approx(np.pi / 2, abs=1e-6)


def test_poly_curves_round_their_corners():
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [2, 2, 0]], float)
    smooth, close = (turgor.Spine.from_poly(points, resolution=count) for count in (1, 6))
    assert np.abs(smooth.evaluate(smooth.station_parameters).positions - points).max() < 1e-15
    assert 0 < close.deviation < 0.25 * smooth.deviation < 0.1


def test_trimmed_spines_follow_the_whole_and_end_straight():
    spine = turgor.Spine(helix(9, 0.7))
    part = spine.trimmed(1.0, 3.5)
    assert part.parameter_range == (1.0, 3.5)
    ends = part.evaluate([1.0, 3.5])
    assert np.abs(ends.positions - spine.evaluate([1.0, 3.5]).positions).max() < 1e-14
    assert np.abs(ends.curvatures).max() < 1e-12
    assert part.deviation < 0.02 * part.length
    points = about(part, np.random.default_rng(1), 200)
    posed = spine.posed(wave(9)).trimmed(1.0, 3.5)
    fleshed = turgor.flesh(points, part, posed)
    far = part.closest(points).is_beyond_ends
    # Beyond the limits the body moves as one: stretched along the tangent, else rigidly.
    one_end = far & (part.closest(points).parameters < 2)
    assert one_end.sum() > 5
    affine = np.column_stack([points[one_end], np.ones(one_end.sum())])
    assert np.abs(affine @ np.linalg.lstsq(affine, fleshed[one_end], rcond=None)[0] - fleshed[one_end]).max() < 1e-12


@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-7, 1e-4])
def test_trimming_next_to_a_station_leaves_one_of_the_two(gap):
    """Twist given at stations a hair's breadth apart would swing between all others."""
    spine = turgor.Spine(line(7), parameters=np.arange(7.0))
    part = spine.trimmed(1.0, 4.0 + gap)
    assert part.station_parameters.tolist() == [1.0, 2.0, 3.0, 4.0 + gap]
    points = np.array([[s, 0.3, 0.0] for s in np.linspace(1.0, 3.2, 40)])
    angles = 0.3 * part.station_parameters + 1e-4 * np.cos(7 * part.station_parameters)
    turned = turgor.flesh(points, part, part, twist=angles)
    found = np.arctan2(turned[:, 2], turned[:, 1])
    assert (found >= angles.min() - 0.1).all()
    assert (found <= angles.max() + 0.1).all()


def test_folded_spines_are_told_and_finite():
    back = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 0, 0], [0, 0, 0]], float)
    rest = turgor.Spine(line(5))
    posed = rest.posed(back)
    assert rest.fold_count == 0
    assert posed.fold_count > 0
    points = about(rest, np.random.default_rng(2), 500)
    flesh = turgor.Fleshing(rest, points)
    fleshed = flesh.deform(posed, twist=1.0)
    assert np.isfinite(fleshed).all()
    assert np.abs(fleshed).max() < 20
    assert flesh.validity(posed).valid_count < 500


@given(st.lists(st.tuples(*[st.floats(-5, 5)] * 3), min_size=2, max_size=8, unique=True), st.integers(0, 99))
def test_any_points_make_a_finite_body(stations, seed: int):
    # Points closer than numbers can tell are refused; test_spine_bad_input asks for the message.
    assume(np.linalg.norm(np.diff(stations, axis=0), axis=1).min() > 1e-9 * max(1.0, np.abs(stations).max()))
    rest = turgor.Spine(stations)
    rng = np.random.default_rng(seed)
    points = np.concatenate([rng.normal(size=(50, 3)) * 3, rng.normal(size=(5, 3)) * 1e6, stations])
    posed = rest.posed(rng.normal(size=(len(stations), 3)))
    for kind in ("radial", "normal", "binormal", (1, 1, 1)):
        flesh = turgor.Fleshing(rest, points, kind)
        assert np.isfinite(flesh.deform(posed, twist=5.0, slide=1.0)).all()
        assert np.isfinite(flesh.inverse(points, posed, slide=1.0)).all()
        assert np.isfinite(flesh.validity(posed).usage).all()
