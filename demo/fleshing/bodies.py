"""Bodies to bend, lying along the X axis, and their volume, measured without the engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
import turgor

from blend_fixtures.tube import Tube, tube_mesh

from ..enclosed_volume import Indices, Points, Shells, shells
from .determinants import points_in_tube

# Corners of the unit cube, and its faces counter-clockwise seen from outside.
CUBE_CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
CUBE_FACES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


@dataclass(frozen=True)
class Body:
    """A closed surface, or several: points (N, 3), faces with corners counter-clockwise seen from outside."""

    points: Points
    faces: Sequence[Sequence[int]]

    @cached_property
    def shells(self) -> Shells:
        """What is needed to measure it in any shape."""
        sizes = np.array([len(face) for face in self.faces])
        return shells(self.points, sizes, np.concatenate([np.asarray(face) for face in self.faces]))

    def moved(self, points: Points) -> Body:
        """The same faces about other points."""
        return Body(points, self.faces)

    def local_errors(self, positions: Points) -> Points:
        """(K,) relative change of each shell's volume."""
        return self.shells.volumes(positions) / self.shells.volumes(self.points) - 1.0

    def total_error(self, positions: Points) -> float:
        """Relative change of the volume of all shells together."""
        return float(self.shells.volumes(positions).sum() / self.shells.volumes(self.points).sum()) - 1.0


def tube(start: float, end: float, radius: float, spacing: float, beside: float = 0.0) -> Body:
    """A round tube; beside: how far its axis lies from the X axis, along Z."""
    points, faces, _ = tube_mesh(Tube([(start, 0.0, beside), (end, 0.0, beside)], radius, spacing, blend=0.0))
    return Body(points, faces)


def extrusion(profile: Points, start: float, end: float, spacing: float) -> Body:
    """A polygon (M, 2) of Y and Z, counter-clockwise, drawn out along X; its ends are polygons."""
    places = np.linspace(start, end, round((end - start) / spacing) + 1)
    count = len(profile)
    rings = np.concatenate([np.repeat(places, count)[:, None], np.tile(profile, (len(places), 1))], axis=1)
    around = np.arange(count)
    sides = np.concatenate([_ring_quads(first, around) for first in range(0, count * (len(places) - 1), count)])
    last = count * (len(places) - 1)
    return Body(rings, [*sides.tolist(), around[::-1].tolist(), (last + around).tolist()])


def _ring_quads(first: int, around: Indices) -> Indices:
    """Quads between two rings of points, the first of which begins at `first`."""
    following = np.roll(around, -1)
    return first + np.stack([around, following, len(around) + following, len(around) + around], axis=1)


def bar_of_cells(count: int) -> Body:
    """A bar of unit cells in a row along X, about the X axis: 4 (count + 1) points, 4 count + 2 quads."""
    square = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    return extrusion(square, 0.0, float(count), 1.0)


def swept(frames: turgor.SpineFrames, profile: Points) -> Body:
    """A polygon (M, 2) of normal and binormal, drawn out along frames: a ribbon, or the spine itself to look at."""
    flat = extrusion(profile, 0.0, len(frames.positions) - 1.0, 1.0)
    station = np.rint(flat.points[:, 0]).astype(int)
    across = flat.points[:, 1:2] * frames.normals[station] + flat.points[:, 2:] * frames.binormals[station]
    return flat.moved(frames.positions[station] + across)


def circle(radius: float, count: int = 32) -> Points:
    """A round profile."""
    angles = 2.0 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def cubes(corners: Points, size: float) -> Body:
    """Cubes from their lowest corners (K, 3), each a shell of its own."""
    points = (corners[:, None] + size * CUBE_CORNERS).reshape(-1, 3)
    faces = (8 * np.arange(len(corners))[:, None, None] + CUBE_FACES).reshape(-1, 4)
    return Body(points, faces.tolist())


def sample_cubes(start: float, end: float, radius: float, size: float, count: int) -> Body:
    """Cubes with their middles anywhere in a round tube about the X axis; the same middles for every size."""
    return cubes(points_in_tube(start, end, radius, count) - size / 2.0, size)
