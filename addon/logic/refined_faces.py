"""Faces split once, those beside them joined to the new vertices: no cracks, and four corners wherever it can be.

A chosen face of n corners becomes n quads about its centre. A triangle or quad beside it is cut to the new centres of
its edges; larger faces beside it are chosen too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .polygons import Edges, Faces, edges_of

# What a corner of a new face was: a corner of the old one, the centre of its edge to the next corner, its centre.
CORNER, EDGE, CENTRE = 0, 1, 2

_Token = tuple[int, int]
_Polygons = tuple[tuple[_Token, ...], ...]
_C = tuple((CORNER, i) for i in range(4))
_E = tuple((EDGE, i) for i in range(4))
_O = (CENTRE, 0)

# Corners and edges count from the first split edge on.
_BESIDE: dict[tuple[int, tuple[bool, ...]], _Polygons] = {
    (3, (True, False, False)): ((_C[0], _E[0], _C[2]), (_E[0], _C[1], _C[2])),
    (3, (True, True, False)): ((_E[0], _C[1], _E[1]), (_C[0], _E[0], _E[1], _C[2])),
    (4, (True, False, False, False)): (
        (_C[0], _E[0], _O, _C[3]),
        (_E[0], _C[1], _C[2], _O),
        (_O, _C[2], _C[3]),
    ),
    (4, (True, True, False, False)): (
        (_E[0], _C[1], _E[1], _O),
        (_E[1], _C[2], _C[3], _O),
        (_C[3], _C[0], _E[0], _O),
    ),
    (4, (True, False, True, False)): ((_C[0], _E[0], _E[2], _C[3]), (_E[0], _C[1], _C[2], _E[2])),
}


@dataclass(frozen=True)
class Split:
    """One level. Old vertices keep their numbers, edge centres follow, then centres of faces."""

    before: Faces
    after: Faces
    kept: NDArray[np.intp]  # (K,) old faces that stay as they are: the first K new ones
    parents: NDArray[np.intp]  # (F',) old face of each new one
    edge_ends: NDArray[np.int64]  # (M, 2) old vertices that each edge centre lies between
    centred: NDArray[np.intp]  # (P,) old faces that have a centre
    is_chosen: NDArray[np.bool_]  # (F,)
    corner_kinds: NDArray[np.int8]  # (C',) CORNER, EDGE or CENTRE
    corner_sources: NDArray[np.intp]  # (C',) old corner, of a centre any of the face

    def vertices(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N', ...) of the new vertices, from (N, ...): those between have the mean of what they are between."""
        values = np.asarray(values, np.float64)
        between = values[self.edge_ends].mean(axis=1)
        return np.concatenate([values, between, self.before.means(values[self.before.corners])[self.centred]])

    def corners(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(C', ...) of the new faces' corners, from (C, ...), within each face as `vertices`."""
        values = np.asarray(values, np.float64)
        found = values[self.corner_sources]
        is_edge, is_centre = self.corner_kinds == EDGE, self.corner_kinds == CENTRE
        found[is_edge] = 0.5 * (found[is_edge] + values[self.before.following[self.corner_sources[is_edge]]])
        found[is_centre] = self.before.means(values)[self.before.of_corners[self.corner_sources[is_centre]]]
        return found

    def points(self, points: NDArray[np.integer]) -> NDArray[np.int64]:
        """(N',) the vertex that stands for each new one, from that of each old one (N,)."""
        points = np.asarray(points, np.int64)
        count = len(points)
        ends = np.sort(points[self.edge_ends], axis=1)
        _, first, same = np.unique(ends, axis=0, return_index=True, return_inverse=True)
        centres = count + len(ends) + np.arange(len(self.centred))
        return np.concatenate([points, count + first[same.ravel()], centres]).astype(np.int64)


def split(faces: Faces, is_chosen: NDArray[np.bool_], points: NDArray[np.integer]) -> Split:
    """The chosen faces split, all others that share their edges cut to fit.

    is_chosen: (F,) as levels that are `balanced` choose them. points: (N,) the vertex that stands for each one.
    """
    own, welded = edges_of(faces), edges_of(faces, points)
    is_split_welded = np.zeros(len(welded.ends), bool)
    is_split_welded[welded.of_corners[is_chosen[faces.of_corners]]] = True
    is_split = is_split_welded[welded.of_corners]  # per corner: its edge to the next
    pieces = _Pieces(faces)
    counts = faces.counts
    for count in np.unique(counts[is_chosen]).tolist():
        quads = tuple(((CORNER, i), (EDGE, i), (CENTRE, 0), (EDGE, i - 1)) for i in range(count))
        pieces.add(np.flatnonzero(is_chosen & (counts == count)), 0, quads)
    split_edges = np.add.reduceat(is_split.astype(np.int32), faces.offsets[:-1]) if len(counts) else counts
    is_beside = ~is_chosen & (split_edges > 0)
    for count in (3, 4):
        of_count = np.flatnonzero(is_beside & (counts == count))
        flags = is_split[faces.offsets[of_count, None] + np.arange(count)]
        for turn in range(count):
            turned = np.roll(flags, -turn, axis=1)
            for (corners, pattern), polygons in _BESIDE.items():
                # Opposite edges look the same from both.
                if corners == count and not (sum(pattern) == 2 and pattern[2 % count] and turn > 1):
                    pieces.add(of_count[(turned == pattern).all(axis=1)], turn, polygons)
    return _joined(faces, is_chosen, is_split, own, pieces, len(points))


class _Pieces:
    """New faces, block by block."""

    def __init__(self, faces: Faces) -> None:
        self._faces = faces
        self.parents: list[NDArray[np.intp]] = []
        self.kinds: list[NDArray[np.int8]] = []
        self.sources: list[NDArray[np.intp]] = []
        self.lengths: list[NDArray[np.intp]] = []

    def add(self, chosen: NDArray[np.intp], turn: int, polygons: _Polygons) -> None:
        """Cut each of these faces, which have equal numbers of corners, into these polygons."""
        if not len(chosen):
            return
        starts, count = self._faces.offsets[chosen].astype(np.intp), int(self._faces.counts[chosen[0]])
        for polygon in polygons:
            places = np.array([0 if kind == CENTRE else (place + turn) % count for kind, place in polygon])
            self.parents.append(chosen)
            self.lengths.append(np.full(len(chosen), len(polygon)))
            self.kinds.append(np.tile(np.array([kind for kind, _ in polygon], np.int8), len(chosen)))
            self.sources.append((starts[:, None] + places).ravel())


def _joined(
    faces: Faces,
    is_chosen: NDArray[np.bool_],
    is_split: NDArray[np.bool_],
    own: Edges,
    pieces: _Pieces,
    vertex_count: int,
) -> Split:
    none = np.zeros(0, np.intp)
    parents, lengths = (np.concatenate([none, *rows]) for rows in (pieces.parents, pieces.lengths))
    kinds, sources = np.concatenate([none, *pieces.kinds]), np.concatenate([none, *pieces.sources])
    replaced = np.zeros(len(is_chosen), bool)
    replaced[parents] = True
    kept = np.flatnonzero(~replaced)
    kept_corners = np.flatnonzero(~replaced[faces.of_corners])
    # Children of a face stand together, in the order of their parents.
    order = np.argsort(parents, kind="stable")
    starts = np.cumsum(lengths) - lengths
    gather = _ranges(starts[order], lengths[order])
    kinds = np.concatenate([np.zeros(len(kept_corners), np.intp), kinds[gather]]).astype(np.int8)
    sources = np.concatenate([kept_corners, sources[gather]])
    counts = np.concatenate([faces.counts[kept], lengths[order]])

    is_own_split = np.zeros(len(own.ends), bool)
    is_own_split[own.of_corners[is_split]] = True
    edge_vertices = vertex_count + np.cumsum(is_own_split) - 1
    of_corners = faces.of_corners
    has_centre = np.zeros(len(is_chosen), bool)
    has_centre[of_corners[sources[kinds == CENTRE]]] = True
    centre_vertices = vertex_count + int(is_own_split.sum()) + np.cumsum(has_centre) - 1
    corners = faces.corners[sources].astype(np.int64)
    corners[kinds == EDGE] = edge_vertices[own.of_corners[sources[kinds == EDGE]]]
    corners[kinds == CENTRE] = centre_vertices[of_corners[sources[kinds == CENTRE]]]
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    return Split(
        before=faces,
        after=Faces(offsets, corners.astype(np.int32)),
        kept=kept,
        parents=np.concatenate([kept, parents[order]]),
        edge_ends=own.ends[is_own_split],
        centred=np.flatnonzero(has_centre),
        is_chosen=np.asarray(is_chosen),
        corner_kinds=kinds,
        corner_sources=sources,
    )


def _ranges(starts: NDArray[np.intp], lengths: NDArray[np.intp]) -> NDArray[np.intp]:
    """start, start + 1, … of each range, one after the other."""
    ends = np.cumsum(lengths)
    return np.repeat(starts - (ends - lengths), lengths) + np.arange(int(lengths.sum()))
