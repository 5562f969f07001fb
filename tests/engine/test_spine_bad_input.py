"""Wrong spines and points are answered by a TurgorError that says what was found and what is needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import turgor
from spines import helix, line, wave

REST = turgor.Spine(line())
POINTS = np.zeros((4, 3))
FLESH = turgor.Fleshing(REST, POINTS)
NAN = np.full((3, 3), np.nan)


def other(value: object) -> Any:
    """What the stubs forbid."""
    return value


HUGE = np.array([[0, 0, 0], [1e300, 0, 0], [0, 1e300, 0]])

CASES: dict[str, tuple[Callable[[], object], str]] = {
    "one point": (lambda: turgor.Spine([[0, 0, 0]]), "found 1, a spine needs at least 2"),
    "no point": (lambda: turgor.Spine(np.zeros((0, 3))), "found 0, a spine needs at least 2"),
    "coincident points": (lambda: turgor.Spine([[0, 0, 0], [1, 0, 0], [1, 0, 0]]), "row 2 lies where"),
    "no length": (lambda: turgor.Spine(np.ones((3, 3))), "row 1 lies where"),
    "not a number": (lambda: turgor.Spine(NAN), "row 0 is not finite"),
    "two columns": (lambda: turgor.Spine(np.zeros((3, 2))), r"need float64 \(N, 3\)"),
    "unknown method": (lambda: turgor.Spine(line(), other("cubic")), "need .*b_spline"),
    "beyond all numbers": (lambda: turgor.Spine(HUGE), "points: row 1 holds 1e300, need numbers up to 1e15"),
    "next to no size": (lambda: turgor.Spine(line() * 1e-160), r"points: all of it is within 5(\.\d+)?e-160"),
    "nurbs of next to no size": (
        lambda: turgor.Spine.from_nurbs(line() * 1e-160),
        r"within 5(\.\d+)?e-160",
    ),
    "negative order": (lambda: turgor.Spine.from_nurbs(line(), order=-4), "order: need a whole number of 0 or more"),
    "negative resolution": (lambda: turgor.Spine.from_poly(line(), resolution=-1), "resolution: need a whole number"),
    "points beyond all numbers": (lambda: turgor.Fleshing(REST, HUGE), "points: row 1 holds 1e300"),
    "slide beyond all numbers": (lambda: FLESH.deform(REST, slide=1e300), "slide: row 0 holds 1e300"),
    "twist beyond all numbers": (lambda: FLESH.deform(REST, twist=1e300), "twist: row 1 holds 1e300"),
    "evaluate beyond all numbers": (lambda: REST.evaluate([1e300]), "parameters: row 0 holds 1e300"),
    "parameters that fall": (lambda: turgor.Spine(line(3), parameters=[0, 2, 1]), "row 2 is not above"),
    "parameters too few": (lambda: turgor.Spine(line(3), parameters=[0, 2]), "found 2 values, need 3"),
    "unknown parameters": (lambda: turgor.Spine(line(3), parameters="even"), "centripetal"),
    "normal of two numbers": (lambda: turgor.Spine(line(), normal=(1, 2)), r"normal: need float64 \(3,\)"),
    "normal not a number": (lambda: turgor.Spine(line(), normal=(np.nan, 0, 0)), "normal: row 0 is not finite"),
    "cyclic": (lambda: turgor.Spine.from_poly(line(), cyclic=True), "cyclic, need an open one"),
    "cyclic nurbs": (lambda: turgor.Spine.from_nurbs(line(), cyclic=True), "cyclic, need an open one"),
    "cyclic bezier": (lambda: turgor.Spine.from_bezier(line(), line(), line(), cyclic=True), "cyclic"),
    "handles too few": (
        lambda: turgor.Spine.from_bezier(line(), line(3), line()),
        "left_handles: found 3 values, need 7",
    ),
    "bezier without length": (lambda: turgor.Spine.from_bezier(*[np.ones((3, 3))] * 3), "lies where"),
    "order too high": (lambda: turgor.Spine.from_nurbs(line(3), order=4), "order is 4"),
    "no span": (lambda: turgor.Spine.from_nurbs(line(4), order=4, use_endpoint=False, use_bezier=True), "has no span"),
    "weights of 0": (lambda: turgor.Spine.from_nurbs(line(5), np.zeros(5)), "weights is 0"),
    "resolution of 0": (lambda: turgor.Spine.from_poly(line(), resolution=0), "resolution is 0"),
    "tolerance of 0": (lambda: turgor.Spine.from_nurbs(line(), tolerance=0.0), "tolerance is 0"),
    "pose of other points": (lambda: REST.posed(line(5)), "found 5 values, need 7"),
    "pose of a curve": (lambda: turgor.Spine.from_poly(line()).posed(line()), "not made from points"),
    "trim turned round": (lambda: REST.trimmed(2.0, 1.0), "cannot trim to 2 … 1"),
    "trim beyond the ends": (lambda: REST.trimmed(-1.0, 1.0), "both within 0 … 5"),
    "evaluate nowhere": (lambda: REST.evaluate([np.nan]), "parameters: row 0 is not finite"),
    "closest to nothing": (lambda: REST.closest(NAN), "points: row 0 is not finite"),
    "points not a number": (lambda: turgor.Fleshing(REST, NAN), "points: row 0 is not finite"),
    "unknown kind": (lambda: turgor.Fleshing(REST, POINTS, other("oval")), "kind: need"),
    "kind of two weights": (lambda: turgor.Fleshing(REST, POINTS, other((1, 2))), "got 2 numbers"),
    "kind of no weight": (lambda: turgor.Fleshing(REST, POINTS, (0, 0, 0)), "not all 0"),
    "kind of negative weight": (lambda: turgor.Fleshing(REST, POINTS, (1, -1, 0)), "kind is -1"),
    "unknown match": (lambda: turgor.Fleshing(REST, POINTS, match=other("name")), "match: need"),
    "influence too short": (lambda: turgor.Fleshing(REST, POINTS, influence=[1]), "influence: found 1 values, need 4"),
    "influence above 1": (lambda: turgor.Fleshing(REST, POINTS, influence=[0, 1, 2, 0]), "influence is 2"),
    "stations that do not match": (lambda: FLESH.deform(turgor.Spine(wave(5))), "5 stations, rest spine has 7"),
    "twist of three angles": (lambda: FLESH.deform(REST, twist=[1, 2, 3]), "twist: found 3 values, need 7"),
    "twist not a number": (lambda: FLESH.deform(REST, twist=np.nan), "twist: row 1 is not finite"),
    "slide not a number": (lambda: FLESH.deform(REST, slide=np.inf), "slide: row 0 is not finite"),
    "offsets of float64": (lambda: FLESH.deform_into(other(POINTS), REST), "need a writable C-contiguous float32"),
    "offsets too few": (lambda: FLESH.deform_into(np.zeros((3, 3), np.float32), REST), "found 3 values, need 4"),
    "no address": (lambda: FLESH.deform_into_address(0, 4, REST), "need the address"),
}


@pytest.mark.parametrize("name", CASES)
def test_refused_with_what_was_found(name: str):
    call, message = CASES[name]
    with pytest.raises(turgor.TurgorError, match=message):
        call()


def test_refused_calls_leave_the_offsets():
    offsets = np.full((4, 3), 7, np.float32)
    with pytest.raises(turgor.TurgorError):
        FLESH.deform_into(offsets, REST, slide=np.nan)
    assert (offsets == 7).all()


def test_no_points_are_no_trouble():
    flesh = turgor.Fleshing(REST, np.zeros((0, 3)))
    assert flesh.deform(REST).shape == (0, 3)
    assert flesh.deform_into(np.zeros((0, 3), np.float32), REST).max_offset == 0
    assert flesh.inverse(np.zeros((0, 3)), REST).shape == (0, 3)
    assert flesh.validity(REST).valid_count == 0


def test_numbers_far_beyond_use_stay_finite():
    points = np.concatenate([np.eye(3) * far for far in (1e3, 1e9, 1e12, 1e15)])
    posed = REST.posed(helix())
    flesh = turgor.Fleshing(REST, points)
    assert np.isfinite(flesh.deform(posed)).all()
    assert np.isfinite(flesh.inverse(points, posed)).all()
