"""What a refinement would be like, before it is made: faces, counts, and lines to draw."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import refined_levels
from .catmull_clark import Creases, sharpness
from .polygons import Faces, edges_of
from .refinement import Refinement, Surface, refine


class Options(NamedTuple):
    """What the artist chooses. is_automatic: no more levels than folds need; is_smooth: else linear."""

    threshold: float
    levels: int
    is_automatic: bool
    is_smooth: bool


class Need(NamedTuple):
    """A mesh, what modifiers made of it before it was bound, and what joints ask for there."""

    surface: Surface
    bound_faces: Faces
    bound_positions: NDArray[np.float32]  # (N, 3) at rest
    origins: NDArray[np.int32]  # of each bound face the face of the mesh, -1 for none
    gamma: NDArray[np.float32]  # (N,) of bound vertices
    edge_lengths: NDArray[np.float32]  # (N,)


def surface(
    face_offsets: NDArray[np.int32],
    face_corners: NDArray[np.int32],
    points: NDArray[np.integer],
    creased_edges: NDArray[np.integer],
    edge_creases: NDArray[np.floating],
    creased_vertices: NDArray[np.integer],
    vertex_creases: NDArray[np.floating],
) -> Surface:
    """A surface from arrays as in the fields of `scene.refined_mesh.MeshSurface`."""
    creases = Creases(
        np.asarray(creased_edges, np.int64),
        sharpness(edge_creases),
        np.asarray(creased_vertices, np.int64),
        sharpness(vertex_creases),
    )
    return Surface(Faces(face_offsets, face_corners), np.asarray(points, np.int64), creases)


def asked_levels(need: Need, options: Options) -> NDArray[np.int32]:
    """(F,) of the mesh's faces: the most that any of the faces made of one asks for."""
    asked = refined_levels.wanted_levels(
        need.bound_faces,
        need.bound_positions,
        need.gamma,
        need.edge_lengths,
        options.threshold,
        options.levels,
        is_automatic=options.is_automatic,
    )
    found = np.zeros(len(need.surface.faces.counts), np.int32)
    is_from = need.origins >= 0
    np.maximum.at(found, need.origins[is_from], asked[is_from])
    return found


class Region:
    """One choice of options. Worked out when it is looked at."""

    def __init__(self, need: Need, options: Options, used: NDArray[np.integer] | int = 0) -> None:
        """used: (F,) levels that faces have already, of those in the options."""
        self._need = need
        asked, left = asked_levels(need, options), options.levels - used
        # Faces that ask for more levels than they may have.
        self.short_count = int((asked > left).sum())
        levels = refined_levels.balanced(need.surface.faces, np.minimum(asked, left), need.surface.points)
        self.refinement: Refinement = refine(need.surface, levels)

    @property
    def face_count(self) -> int:
        """Faces that are split into quads all over."""
        return self.refinement.face_count

    @property
    def all_face_count(self) -> int:
        """Faces of the mesh before it is refined."""
        return len(self.refinement.levels)

    @property
    def vertex_count(self) -> int:
        """Vertices of the refined mesh."""
        return self.refinement.vertex_count

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """(T, 3) bound vertices: fans of the faces with levels."""
        faces, is_chosen = self._need.bound_faces, self._bound_levels > 0
        counts = np.where(is_chosen, np.maximum(faces.counts - 2, 0), 0)
        first = np.repeat(faces.offsets[:-1], counts)
        within = np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)
        corners = faces.corners
        return np.stack([corners[first], corners[first + within + 1], corners[first + within + 2]], axis=1)

    def lines(self, positions: NDArray[np.floating]) -> NDArray[np.float32]:
        """(2 L, 3) ends of the edges that there would be, on the mesh at these positions (N, 3) of bound vertices."""
        shown, ends = self._shown
        return shown.vertices(positions)[ends].reshape(-1, 3).astype(np.float32)

    @cached_property
    def _bound_levels(self) -> NDArray[np.int32]:
        """(F,) of the bound faces."""
        found, origins = self.refinement.levels, self._need.origins
        return np.where(origins >= 0, found[origins], 0) if len(found) else np.zeros(len(origins), np.int32)

    @cached_property
    def _shown(self) -> tuple[Refinement, NDArray[np.int64]]:
        """The bound mesh with the same levels, and the ends of its new edges."""
        need = self._need
        points = np.arange(len(need.bound_positions), dtype=np.int64)
        made = refine(Surface(need.bound_faces, points, need.surface.creases), self._bound_levels)
        edges = edges_of(made.faces)
        is_new = np.zeros(len(edges.ends), bool)
        is_new[edges.of_corners[made.is_new[made.faces.of_corners]]] = True
        return made, edges.ends[is_new]


class MotionNeed(NamedTuple):
    """What a motion asks for, kept with the character."""

    state: object  # of what it depends on, but for the motion
    motion: str  # fingerprint of the poses
    need: Need
    regions: dict[Options, Region]  # the last that was looked at

    def region(self, options: Options) -> Region:
        """The region under these options, the same object for the same options."""
        if options not in self.regions:
            self.regions.clear()
            self.regions[options] = Region(self.need, options)
        return self.regions[options]
