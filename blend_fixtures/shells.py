"""Small closed shells worn by an animal: eyes and horns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .cage import Cage, Surface, ellipse
from .character import Point
from .subdivision import subdivide

CORNERS = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]


def ball(centre: Point, radius: float, part: str, levels: int = 1) -> Surface:
    """A cube, subdivided and blown up to a ball: 26 vertices at one level, 98 at two."""
    points = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    for _ in range(levels):
        points, quads, _ = subdivide(points, quads)
    points = np.array(centre) + radius * points / np.linalg.norm(points, axis=1, keepdims=True)
    return Surface(points, quads, [part] * len(quads))


def horn(path: Sequence[Point], radii: Sequence[float], part: str, levels: int = 1) -> Surface:
    """A tapered tube of four sides along a path, subdivided."""
    cage = Cage()
    centres = np.array(path)
    tangents = np.gradient(centres, axis=0)
    rings = []
    for centre, tangent, radius in zip(centres, tangents, radii, strict=True):
        across = np.cross(tangent, (0, 0, 1) if abs(tangent[2]) < 0.9 * np.linalg.norm(tangent) else (1, 0, 0))
        across = across / np.linalg.norm(across)
        above = np.cross(across, tangent) / np.linalg.norm(tangent)
        rings.append(ellipse(CORNERS, centre, radius * across, radius * above))
    root = cage.add_points(rings[0])
    cage.add_face(root, part)
    tip = cage.draw_out(root[::-1], [ring[::-1] for ring in rings[1:]], part)
    cage.add_face(tip, part)
    surface = cage.surface(levels)
    return Surface(surface.points, surface.quads[:, ::-1], surface.parts) if _volume(surface) < 0 else surface


def _volume(surface: Surface) -> float:
    a, b, c, d = np.moveaxis(surface.points[surface.quads], 1, 0)
    return float((np.einsum("ij,ij->i", np.cross(c - a, d - b), a + b + c + d)).sum())
