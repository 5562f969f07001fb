"""What the overlay of a spine shows, and how exact its map is around it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from .flesh import Bound, Pose

LINE_POINTS = 97
FRAMES = 25
RING_POINTS = 32
# Rings are drawn so large at most, in radii of the body.
RING_MAX = 3.0
CUBES = 200
# Sides of the sample cubes, in radii of the body.
CUBE_SIDE = 0.1


class Sketch(NamedTuple):
    """Points in world space; pairs of points are lines."""

    rest: NDArray[np.float32]  # (L, 3)
    posed: NDArray[np.float32]  # (L, 3)
    normals: NDArray[np.float32]  # (2 F, 3)
    rings: NDArray[np.float32]  # pairs: the border of the valid space, where it is near
    outside: NDArray[np.float32]  # (M, 3) vertices that are held back, or whose flesh overlaps


class LocalError(NamedTuple):
    """|volume after / before - 1| of small cubes in the body."""

    mean: float
    most: float


def draw(bound: Bound, pose: Pose, offsets: NDArray[np.float32], world: NDArray[np.float64]) -> Sketch:
    """offsets: (N, 3) of the frame, object space; world: (4, 4) from there."""
    fleshing = bound.fleshing
    rest, radius = fleshing.rest_spine, body_radius(bound)
    at = np.linspace(*rest.parameter_range, FRAMES)
    frames = pose.spine.evaluate(np.linspace(*pose.spine.parameter_range, FRAMES))
    radii = fleshing.valid_radii(pose.spine, at, slide=pose.slide, stretch=pose.stretch)
    angles = np.linspace(0.0, 2.0 * np.pi, RING_POINTS + 1)
    circle = np.cos(angles)[:, None, None] * frames.normals + np.sin(angles)[:, None, None] * frames.binormals
    near = radii <= RING_MAX * radius
    rings = frames.positions[near] + circle[:, near] * radii[near, None]
    pairs = np.stack([rings[:-1], rings[1:]], axis=2).reshape(-1, 3)
    normals = np.stack([frames.positions, frames.positions + radius * frames.normals], axis=1).reshape(-1, 3)
    validity = fleshing.validity(pose.spine, twist=pose.twist, slide=pose.slide, stretch=pose.stretch)
    outside = (bound.positions + offsets)[validity.is_clamped | validity.is_overlapping]

    def line(spine: turgor.Spine) -> NDArray[np.float64]:
        return spine.evaluate(np.linspace(*spine.parameter_range, LINE_POINTS)).positions

    parts = (line(rest), line(pose.spine), normals, pairs, outside)
    return Sketch(*((part @ world[:3, :3].T + world[:3, 3]).astype(np.float32) for part in parts))


def local_error(bound: Bound, pose: Pose) -> LocalError:
    """Cubes stand between the spine and some vertices, spread over the body."""
    fleshing, positions = bound.fleshing, bound.positions
    chosen = np.unique(np.linspace(0, len(positions) - 1, CUBES).astype(np.int64))
    on_spine = fleshing.stations.positions[chosen]
    parts = np.random.default_rng(0).uniform(0.2, 0.9, (len(chosen), 1))
    centres = on_spine + parts * (positions[chosen] - on_spine)
    corners = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]) - 0.5
    cubes = centres[:, None] + CUBE_SIDE * body_radius(bound) * corners
    cloud = turgor.Fleshing(fleshing.rest_spine, cubes.reshape(-1, 3), bound.kind, match=bound.match)
    moved = cloud.deform(pose.spine, twist=pose.twist, slide=pose.slide, stretch=pose.stretch).reshape(cubes.shape)
    errors = np.abs(_volumes(moved) / _volumes(cubes) - 1.0)
    return LocalError(float(errors.mean()), float(errors.max()))


def body_radius(bound: Bound) -> float:
    """Median distance of the vertices from their spine, at rest."""
    return float(np.median(bound.fleshing.stations.distances))


def _volumes(cubes: NDArray[np.float64]) -> NDArray[np.float64]:
    """(C,) enclosed by the bilinear faces of (C, 8, 3) corners."""
    faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    total = np.zeros(len(cubes))
    for face in faces:
        a, b, c, d = (cubes[:, corner] for corner in face)
        total += np.einsum("ij,ij->i", a + b + c + d, np.cross(c - a, d - b)) / 24.0
    return total
