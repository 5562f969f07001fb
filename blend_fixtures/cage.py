"""Control cages of quads: a body lofted along the animal, limbs drawn out of patches of its faces.

An animal looks along -Y and stands on z = 0. A left limb is given; `side` = -1 makes its mirror image.
Every face belongs to a named part, by which it later finds its bones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, radians, sin

import numpy as np

from .quads import fill_loop, grid_boundary, grid_quads
from .subdivision import fit_limit, limit_points, subdivide

Loop = list[int]
Square = tuple[float, float]
COLUMNS = 10
"""Faces around a lofted body: number 9 lies on top, 4 below, 0 to 3 left from top to bottom, 5 to 8 right."""


@dataclass(frozen=True)
class Station:
    """A cross-section of a body in metres: centre, heights above and below it, half-width; pitch in degrees."""

    forward: float
    height: float
    up: float
    down: float
    width: float
    pitch: float = 0.0

    def ring(self) -> np.ndarray:
        """COLUMNS points, from the top over the left side and back."""
        angles = 2 * np.pi * (np.arange(COLUMNS) + 0.5) / COLUMNS
        rise = np.where(np.cos(angles) > 0, self.up, self.down) * np.cos(angles)
        forward = self.forward - rise * sin(radians(self.pitch))
        return np.stack([self.width * np.sin(angles), -forward, self.height + rise * cos(radians(self.pitch))], axis=1)


@dataclass(frozen=True)
class Surface:
    """A finished mesh: points (N, 3), quads (F, 4), part of each quad."""

    points: np.ndarray
    quads: np.ndarray
    parts: list[str]

    def joined(self, other: Surface) -> Surface:
        """Both as one mesh; nothing is welded."""
        quads = np.concatenate([self.quads, other.quads + len(self.points)])
        return Surface(np.concatenate([self.points, other.points]), quads, self.parts + other.parts)

    def vertices_of(self, *parts: str) -> np.ndarray:
        """Mask (N,) of the vertices that touch one of the parts."""
        mask = np.zeros(len(self.points), dtype=bool)
        mask[self.quads[np.isin(self.parts, parts)]] = True
        return mask

    def mirrored(self) -> Surface:
        """The other side's twin, still wound outward."""
        return Surface(self.points * [-1, 1, 1], self.quads[:, ::-1], self.parts)


class Cage:
    """Points and faces under construction."""

    def __init__(self) -> None:
        self.points: list[np.ndarray] = []
        self.faces: dict[Loop | tuple[int, ...], str] = {}

    def add_points(self, points: np.ndarray) -> Loop:
        """Indices of the new points (K, 3)."""
        first = len(self.points)
        self.points.extend(np.asarray(points, dtype=float))
        return list(range(first, len(self.points)))

    def add_face(self, face: Sequence[int], part: str) -> None:
        """A quad, counter-clockwise seen from outside."""
        self.faces[tuple(face)] = part

    def remove_face(self, corners: set[int]) -> None:
        """Open the face with these corners."""
        face = next(face for face in self.faces if set(face) == corners)
        del self.faces[face]

    def fill(self, loop: Loop, width: int, height: int, part: str, bulge: Sequence[float] = (0, 0, 0)) -> list[Loop]:
        """Close a loop that starts at a corner with width x height quads; the grid of vertices, row by row."""
        inside = fill_loop(np.array([self.points[index] for index in loop]), width, height)
        grid = [[-1] * (width + 1) for _ in range(height + 1)]
        for (row, column), index in zip(grid_boundary(width, height), loop, strict=True):
            grid[row][column] = index
        for row in range(1, height):
            for column in range(1, width):
                grid[row][column] = self.add_points(inside[None, row, column] + np.asarray(bulge))[0]
        for quad in grid_quads(grid):
            self.add_face(quad, part)
        return grid

    def draw_out(self, loop: Loop, rings: Sequence[np.ndarray], part: str, side: int = 1) -> Loop:
        """A tube from a loop through rings of points of the left limb; the last ring's loop."""
        for ring in rings:
            new = self.add_points(np.asarray(ring) * [side, 1, 1])
            for here in range(len(loop)):
                there = (here + 1) % len(loop)
                quad = (loop[here], loop[there], new[there], new[here])
                self.add_face(quad if side > 0 else quad[::-1], part)
            loop = new
        return loop

    def fill_side(self, loop: Loop, width: int, height: int, part: str, side: int) -> list[Loop]:
        """`fill`, for a loop that runs the other way round on the right side."""
        if side > 0:
            return self.fill(loop, width, height, part)
        mirrored = [loop[0], *reversed(loop[1:])]
        return self.fill(mirrored, height, width, part)

    def surface(self, levels: int, fit: int = 4) -> Surface:
        """The cage, fitted so that its limit surface passes by its points, subdivided, moved to the limit."""
        quads = np.array(list(self.faces))
        used, compact = np.unique(quads, return_inverse=True)
        quads = compact.reshape(quads.shape)
        parts = list(self.faces.values())
        points = fit_limit(np.array(self.points)[used], quads, fit)
        for _ in range(levels):
            points, quads, parents = subdivide(points, quads)
            parts = [parts[parent] for parent in parents]
        return Surface(limit_points(points, quads), quads, parts)


class Loft:
    """A body through stations from the rump to the tip of the nose, in a cage."""

    def __init__(self, cage: Cage, stations: Sequence[Station], part_of: Callable[[int], str]) -> None:
        """part_of(segment) names the part of a ring of faces."""
        self.cage = cage
        self.rings = [cage.add_points(station.ring()) for station in stations]
        for segment, (rear, front) in enumerate(pairwise(self.rings)):
            for column in range(COLUMNS):
                following = (column + 1) % COLUMNS
                quad = (rear[column], front[column], front[following], rear[following])
                cage.add_face(quad, part_of(segment))

    def close_rear(self, part: str, bulge: float = 0.0) -> list[Loop]:
        """The grid, 3 wide and 2 high, of the rear cap; row 0 is on top."""
        ring = self.rings[0]
        return self.cage.fill(ring[8:] + ring[:8], 3, 2, part, (0, bulge, 0))

    def close_front(self, part: str, bulge: Sequence[float] = (0, 0, 0)) -> list[Loop]:
        """The grid of the front cap, wound outward."""
        ring = self.rings[-1]
        loop = [ring[(1 - step) % COLUMNS] for step in range(COLUMNS)]
        return self.cage.fill(loop, 3, 2, part, bulge)

    def open_patch(self, segments: range, columns: range, side: int = 1) -> tuple[Loop, list[Square]]:
        """Remove a patch of left faces, or its mirror image; its loop, and each loop vertex on [-1, 1]².

        The first coordinate goes from rear to front, the second from top to bottom.
        """
        first, last, top, bottom = segments.start, segments.stop, columns.start, columns.stop

        def vertex(ring: int, column: int) -> int:
            return self.rings[ring][column % COLUMNS if side > 0 else (COLUMNS - 1 - column) % COLUMNS]

        for segment in segments:
            for column in columns:
                corners = {vertex(segment + i, column + j) for i in (0, 1) for j in (0, 1)}
                self.cage.remove_face(corners)
        steps = [(ring, top) for ring in range(first, last)]
        steps += [(last, column) for column in range(top, bottom)]
        steps += [(ring, bottom) for ring in range(last, first, -1)]
        steps += [(first, column) for column in range(bottom, top, -1)]
        squares = [
            (2 * (ring - first) / (last - first) - 1, 2 * (column - top) / (bottom - top) - 1) for ring, column in steps
        ]
        return [vertex(ring, column) for ring, column in steps], squares


def ellipse(
    squares: Sequence[Square], centre: Sequence[float], u: Sequence[float] | np.ndarray, v: Sequence[float] | np.ndarray
) -> np.ndarray:
    """A limb's ring: loop vertices moved from the square to the ellipse of half-axes u and v."""
    disc = np.array(squares)
    disc = disc / np.linalg.norm(disc, axis=1, keepdims=True)
    return np.asarray(centre) + disc[:, :1] * np.asarray(u) + disc[:, 1:] * np.asarray(v)
