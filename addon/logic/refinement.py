"""A mesh with more faces where levels ask for them: level by level, and what becomes of values on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import catmull_clark, refined_faces
from .catmull_clark import Creases
from .polygons import Faces
from .refined_faces import Split


class Surface(NamedTuple):
    """A mesh that is refined: N vertices, F faces, C corners."""

    faces: Faces
    points: NDArray[np.int64]  # (N,) the vertex that stands for each one, where several are at one place
    creases: Creases

    @property
    def vertex_count(self) -> int:
        """N."""
        return len(self.points)


@dataclass(frozen=True)
class Refinement:
    """Splits, one after the other; each keeps the numbers of the vertices before it."""

    surface: Surface
    levels: NDArray[np.int32]  # (F,)
    splits: tuple[Split, ...]
    points: tuple[NDArray[np.int64], ...]  # before each split
    parents: NDArray[np.intp]  # (F',) the face that each new one comes from
    is_new: NDArray[np.bool_]  # (F',) others are as they were, and come first
    corner_origins: NDArray[np.intp]  # (C',) a corner that each new one comes from

    @property
    def faces(self) -> Faces:
        """Faces of the refined mesh."""
        return self.splits[-1].after if self.splits else self.surface.faces

    @property
    def vertex_count(self) -> int:
        """Vertices of the refined mesh."""
        return self.surface.vertex_count + sum(len(split.edge_ends) + len(split.centred) for split in self.splits)

    @property
    def face_count(self) -> int:
        """Faces before that are split into quads all over."""
        return int((self.levels > 0).sum())

    def vertices(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N', ...) of values (N, ...): old vertices keep theirs, others have the mean of what they lie between."""
        found = np.asarray(values, np.float64)
        for split in self.splits:
            found = split.vertices(found)
        return found

    def smoothed(self, positions: NDArray[np.floating], *, keeps_vertices: bool) -> NDArray[np.float64]:
        """(N', 3) by Catmull-Clark: faces of n levels are where n levels of the whole mesh would have them.

        keeps_vertices: pushed back, so that vertices stay where they are.
        """
        found, creases = np.asarray(positions, np.float64), self.surface.creases
        for split, points in zip(self.splits, self.points, strict=True):
            count = len(found)
            found = catmull_clark.smoothed(split, found, points, creases, keeps_vertices=keeps_vertices)
            creases = catmull_clark.split_creases(creases, split, count)
        return found

    def corners(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(C', ...) of values (C, ...) of the faces' corners, as `vertices` within each face."""
        found = np.asarray(values, np.float64)
        for split in self.splits:
            found = split.corners(found)
        return found


def refine(surface: Surface, levels: NDArray[np.integer]) -> Refinement:
    """levels: (F,) as `refined_levels.balanced` makes them."""
    faces, points = surface.faces, surface.points
    parents, is_new = np.arange(len(faces.offsets) - 1), np.zeros(len(faces.offsets) - 1, bool)
    origins = np.arange(len(faces.corners))
    splits, kept_points = [], []
    for level in range(1, int(levels.max(initial=0)) + 1):
        split = refined_faces.split(faces, levels[parents] >= level, points)
        splits.append(split)
        kept_points.append(points)
        faces, points, parents = split.after, split.points(points), parents[split.parents]
        origins, is_new = origins[split.corner_sources], is_new[split.parents]
        is_new[len(split.kept) :] = True
    levels = np.asarray(levels, np.int32)
    return Refinement(surface, levels, tuple(splits), tuple(kept_points), parents, is_new, origins)
