"""Spines, bodies about them, and how much a map changes volume."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
import turgor
from hypothesis import strategies as st
from numpy.typing import NDArray

Points = NDArray[np.float64]
Method = Literal["spline", "polynomial", "b_spline"]
Match = Literal["stations", "relative_length", "length"]
Twist = float | tuple[float, ...] | None
Kind = Literal["radial", "normal", "binormal"] | tuple[float, float, float]

KINDS: tuple[Kind, ...] = ("radial", "normal", "binormal", (1, 1, 1), (0.2, 0.5, 0.3), (1, 0, 2), (0, 3, 1))
RADIUS = 0.25


def helix(count: int = 7, turns: float = 0.6, radius: float = 1.6, rise: float = 2.0) -> Points:
    """Stations on a helix, which has torsion."""
    angle = np.linspace(0, 2 * np.pi * turns, count)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rise * np.linspace(0, 1, count)])


def wave(count: int = 7, length: float = 5.0, height: float = 0.3) -> Points:
    """Stations on a wave that leaves its plane and has inflections."""
    x = np.linspace(0, length, count)
    return np.column_stack([x, height * np.sin(1.1 * x), 0.7 * height * np.cos(1.7 * x)])


def line(count: int = 7, length: float = 5.0) -> Points:
    """Stations on the x axis."""
    return np.column_stack([np.linspace(0, length, count), np.zeros((count, 2))])


@st.composite
def poses(draw: st.DrawFn, count: int = 7) -> Points:
    """Stations of gently bent chains with torsion and stretch: a tube of `RADIUS` is valid about them."""
    angles = st.floats(-0.11, 0.11)
    heading, pitch = draw(st.floats(-3, 3)), draw(st.floats(-1, 1))
    turns = [draw(angles) for _ in range(2 * count)]
    stretch = draw(st.floats(0.8, 1.5))
    rates = np.array([[heading + turns[i] * i, pitch + turns[count + i] * i] for i in range(count - 1)])
    steps = np.column_stack(
        [np.cos(rates[:, 0]) * np.cos(rates[:, 1]), np.sin(rates[:, 0]) * np.cos(rates[:, 1]), np.sin(rates[:, 1])]
    )
    return np.vstack([np.zeros(3), np.cumsum(0.9 * stretch * steps, axis=0)]) + draw(st.floats(-2, 2))


def about(spine: turgor.Spine, rng: np.random.Generator, count: int, radius: float = RADIUS) -> Points:
    """Points within a radius of a spine, some beyond its ends."""
    first, last = spine.parameter_range
    frames = spine.evaluate(rng.uniform(first - 0.5, last + 0.5, count))
    angle, distance = rng.uniform(0, 2 * np.pi, count), radius * np.sqrt(rng.uniform(0, 1, count))
    offsets = frames.normals * np.cos(angle)[:, None] + frames.binormals * np.sin(angle)[:, None]
    return frames.positions + offsets * distance[:, None]


def determinants(flesh: Callable[[Points], Points], points: Points, step: float = 3e-5) -> NDArray[np.float64]:
    """(N,) determinant of the derivative of a map, by differences of the sixth order."""
    weights = {-3: -1 / 60, -2: 3 / 20, -1: -3 / 4, 1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    derivative = np.zeros((len(points), 3, 3))
    for axis in range(3):
        for offset, weight in weights.items():
            moved = points.copy()
            moved[:, axis] += offset * step
            derivative[:, :, axis] += weight / step * flesh(moved)
    return np.linalg.det(derivative)


def size(*clouds: Points) -> float:
    """Largest coordinate of several clouds."""
    return max(float(np.abs(cloud).max()) for cloud in clouds)
