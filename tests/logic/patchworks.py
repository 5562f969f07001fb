"""Closed meshes to be refined: quads, triangles, faces of many corners, seams, several shells; rough on demand."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from addon.logic.catmull_clark import Creases
from addon.logic.polygons import Faces, edges_of
from addon.logic.refinement import Surface

NO_CREASES = Creases(np.zeros((0, 2), np.int64), np.zeros(0), np.zeros(0, np.int64), np.zeros(0))

TUBE_RADIUS = 0.4
seeds = st.integers(0, 2**32 - 1)


class Patchwork:
    """positions: (N, 3) and the surface."""

    def __init__(self, positions: np.ndarray, faces: list[list[int]]) -> None:
        self.positions = positions
        self.faces = Faces(
            np.cumsum([0, *map(len, faces)]).astype(np.int32), np.array([c for f in faces for c in f], np.int32)
        )

    @property
    def points(self) -> np.ndarray:
        """Vertices at one place stand for each other."""
        _, first, same = np.unique(self.positions.round(9), axis=0, return_index=True, return_inverse=True)
        return first[same.ravel()].astype(np.int64)

    @property
    def surface(self) -> Surface:
        return Surface(self.faces, self.points, NO_CREASES)


def patchwork(seed: int, *, roughness: float = 0.05, has_seam: bool = True) -> Patchwork:
    """A tube of quads and triangles, closed by faces of many corners, with a seam along it; and a cube beside it."""
    rng = np.random.default_rng(seed)
    rings, sides = int(rng.integers(3, 7)), int(rng.integers(3, 9))
    angles = 2.0 * np.pi * np.arange(sides) / sides
    points = np.array([(np.cos(a), np.sin(a), 0.5 * z) for z in range(rings) for a in angles])
    points += rng.uniform(-roughness, roughness, points.shape)
    faces = []
    for ring in range(rings - 1):
        for side in range(sides):
            a, b = ring * sides + side, ring * sides + (side + 1) % sides
            quad = [a, b, b + sides, a + sides]
            faces += [quad] if rng.random() < 0.7 else [quad[:3], [quad[0], *quad[2:]]]
    faces += [list(range(sides))[::-1], list(range(sides * (rings - 1), sides * rings))]
    if has_seam:
        # Some faces have vertices of their own, as importers leave them.
        for face in rng.choice(len(faces), len(faces) // 3, replace=False):
            start = len(points)
            points = np.concatenate([points, points[faces[face]]])
            faces[face] = list(range(start, len(points)))
    cube = np.array([(x, y, z) for x in (3, 4) for y in (0, 1) for z in (0, 1)], float)
    sides_of_cube = ([0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3])
    faces += [[corner + len(points) for corner in face] for face in sides_of_cube]
    return Patchwork(np.concatenate([points, cube]), faces)


def torus(rings: int, sides: int) -> Patchwork:
    """Of radius 1, quads all over."""
    around, along = np.meshgrid(*(2.0 * np.pi * np.arange(n) / n for n in (rings, sides)), indexing="ij")
    out = 1.0 + TUBE_RADIUS * np.cos(along)
    points = np.stack([out * np.cos(around), out * np.sin(around), TUBE_RADIUS * np.sin(along)], axis=-1)
    numbers = np.arange(rings * sides).reshape(rings, sides)
    beside, above = np.roll(numbers, -1, axis=0), np.roll(numbers, -1, axis=1)
    faces = np.stack([numbers, beside, np.roll(beside, -1, axis=1), above], axis=-1)
    return Patchwork(points.reshape(-1, 3), faces.reshape(-1, 4).tolist())


def distance_to_torus(points: np.ndarray) -> np.ndarray:
    """Outside of it is positive."""
    return np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1.0, points[:, 2]) - TUBE_RADIUS


def bend_at_edges(positions: np.ndarray, faces: Faces) -> np.ndarray:
    """(E,) angle between the two faces of each edge of a closed mesh."""
    around = positions[faces.corners]
    areas = faces.means(np.cross(around, around[faces.following]))
    normals = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    order = np.argsort(edges_of(faces).of_corners, kind="stable")
    one, other = faces.of_corners[order].reshape(-1, 2).T
    return np.arccos(np.clip((normals[one] * normals[other]).sum(axis=1), -1.0, 1.0))


def volume(positions: np.ndarray, faces: Faces) -> float:
    """1/6 Σ det(centre, a, b)."""
    around = positions[faces.corners]
    centres = faces.means(around)[faces.of_corners]
    return float(np.einsum("ij,ij->", centres, np.cross(around, around[faces.following]))) / 6.0


def edge_balance(faces: Faces, points: np.ndarray) -> dict[tuple[int, int], int]:
    """Faces along each edge, one way as +1, the other as -1: all 0 on closed surfaces whose faces agree."""
    corners = points[faces.corners]
    found: dict[tuple[int, int], int] = {}
    for a, b in zip(corners.tolist(), corners[faces.following].tolist(), strict=True):
        found[min(a, b), max(a, b)] = found.get((min(a, b), max(a, b)), 0) + (1 if a < b else -1)
    return found
