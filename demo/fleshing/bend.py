"""A bend from a straight spine along X to a posed one, by the engine and by Blender's Curve modifier."""

from __future__ import annotations

from typing import Literal

import numpy as np
import turgor

from ..enclosed_volume import Points
from .bodies import Body
from .curve_modifier import CurveModifier

Kind = Literal["radial", "normal", "binormal"]
KINDS: tuple[Kind, ...] = ("radial", "normal", "binormal")
CURVE = "Curve modifier"
WAYS = (CURVE, *KINDS)

UP = (0.0, 0.0, 1.0)


class Bend:
    """Both spines; first axis of the frames: Z at rest, the posed spine's normal in the bend."""

    def __init__(self, posed: turgor.Spine) -> None:
        self.posed = posed
        self.rest = turgor.Spine([(0.0, 0.0, 0.0), (posed.length, 0.0, 0.0)], normal=UP)
        self.curve_modifier = CurveModifier(posed)

    def fleshed(self, points: Points, kind: Kind, twist: float = 0.0) -> Points:
        """(N, 3) by the engine, double precision."""
        return turgor.flesh(points, self.rest, self.posed, kind, match="length", twist=twist)

    def bent(self, body: Body, way: str) -> Points:
        """(N, 3) by one of `WAYS`."""
        return self.curve_modifier.bent(body) if way == CURVE else self.fleshed(body.points, KINDS[WAYS.index(way) - 1])

    def tightest_radius(self) -> float:
        """Least radius of curvature along the posed spine."""
        start, end = self.posed.parameter_range
        curvatures = self.posed.evaluate(np.linspace(start, end, 2001)).curvatures
        return float(1.0 / np.linalg.norm(curvatures, axis=1).max())


def arc(length: float, angle: float) -> turgor.Spine:
    """An arch in the XZ plane, from left to right, turned by `angle` radians in all; its frames' normals look outwards.

    One polynomial through 13 points of the circle: its radius is that of the circle to 1e-6 up to half a turn.
    """
    places = np.linspace(0.0, length, 13)
    if angle == 0.0:
        points = np.stack([places, 0.0 * places, 0.0 * places], axis=1)
        return turgor.Spine(points, "polynomial", parameters=places, normal=UP)
    radius, turn = length / angle, places / length * angle - angle / 2.0
    points = radius * np.stack([np.sin(turn), 0.0 * turn, np.cos(turn)], axis=1)
    return turgor.Spine(points, "polynomial", parameters=places, normal=points[0])


def coil() -> turgor.Spine:
    """A turn and a half of a helix, of bending radius 2.3; straight at its very ends."""
    turn = np.linspace(-1.5 * np.pi, 1.5 * np.pi, 37)
    points = np.stack([0.8 * turn, 2.0 * np.sin(turn), 2.0 * np.cos(turn)], axis=1)
    return turgor.Spine(points, normal=UP)
