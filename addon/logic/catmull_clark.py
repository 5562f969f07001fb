"""Catmull-Clark positions of a mesh that is split once, with creases, as Blender's Subdivision Surface makes them.

Or pushed back so that vertices stay where they are, [MS01] Maillot, Stam: *A unified subdivision scheme for polygonal
modeling*, 2001: new ones are moved back by the mean of what the rule would move the vertices they lie between. Along a
line of quads that is the four-point scheme. Then all vertices lie on one smooth surface, also those that were there.

Sharpness falls by one with each level, infinity stays; openings, and edges of more than two faces, are sharp.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .polygons import Edges, Faces, edges_of
from .refined_faces import Split

# Sharpness of a crease of one: from ten on Blender means infinity.
FULL_SHARPNESS = 10.0


class Creases(NamedTuple):
    """How sharp edges and vertices are; those not named are smooth."""

    ends: NDArray[np.int64]  # (K, 2)
    sharpness: NDArray[np.float64]  # (K,)
    corners: NDArray[np.int64]  # (J,)
    corner_sharpness: NDArray[np.float64]  # (J,)


def sharpness(creases: NDArray[np.floating]) -> NDArray[np.float64]:
    """Sharpness, infinite from 1 on, of creases from 0 to 1 as Blender stores them."""
    found = FULL_SHARPNESS * np.square(np.clip(np.asarray(creases, np.float64), 0.0, 1.0))
    return np.where(found >= FULL_SHARPNESS, np.inf, found)


def split_creases(creases: Creases, split: Split, vertex_count: int) -> Creases:
    """Creases of the mesh after a split, one level less sharp. vertex_count: before the split."""
    pairs = np.sort(creases.ends, axis=1)
    places = Edges(split.edge_ends, np.zeros(0, np.intp)).places(pairs)
    middles, is_split = vertex_count + places, places >= 0
    halves = [np.stack([pairs[is_split, end], middles[is_split]], axis=1) for end in (0, 1)]
    left = np.maximum(creases.sharpness - 1.0, 0.0)
    ends = np.concatenate([pairs[~is_split], *halves])
    values = np.concatenate([left[~is_split], left[is_split], left[is_split]])
    return Creases(ends, values, creases.corners, np.maximum(creases.corner_sharpness - 1.0, 0.0))


def smoothed(
    split: Split,
    positions: NDArray[np.floating],
    points: NDArray[np.integer],
    creases: Creases,
    *,
    keeps_vertices: bool,
) -> NDArray[np.float64]:
    """(N', 3) after the split, of (N, 3) before it.

    points: (N,) the vertex that stands for each one: surfaces run on across seams. keeps_vertices: pushed back; else
    corners, edge centres and centres of chosen faces are where they would be if the whole mesh was split.
    """
    places = np.asarray(positions, np.float64)
    points = np.asarray(points, np.int64)
    faces = Faces(split.before.offsets, points[split.before.corners].astype(np.int32))
    edges = edges_of(faces)
    sharp = _Sharpness(faces, edges, points, creases)
    face_points = faces.means(places[faces.corners])
    edge_points = _edge_points(faces, edges, places, face_points, sharp.edges)
    vertex_points = _vertex_points(faces, edges, places, face_points, sharp)
    is_smooth = np.ones(len(split.centred), bool)
    moved = places.copy()
    if keeps_vertices:
        back = places - vertex_points
        edge_points += back[edges.ends].mean(axis=1)
        face_points += faces.means(back[faces.corners])
    else:
        is_smooth = split.is_chosen[split.centred]
        moves = np.zeros(len(places), bool)
        moves[faces.corners[split.is_chosen[faces.of_corners]]] = True
        moved[moves[points]] = vertex_points[points[moves[points]]]

    found = split.vertices(moved)
    count = len(places)
    found[count : count + len(split.edge_ends)] = edge_points[edges.places(points[split.edge_ends])]
    centres = found[count + len(split.edge_ends) :]
    centres[is_smooth] = face_points[split.centred[is_smooth]]
    return found


class _Sharpness:
    """Per edge, per edge after this level, per vertex before and after it."""

    def __init__(self, faces: Faces, edges: Edges, points: NDArray[np.int64], creases: Creases) -> None:
        self.edges = np.zeros(len(edges.ends))
        places = edges.places(points[creases.ends])
        np.maximum.at(self.edges, places[places >= 0], creases.sharpness[places >= 0])
        self.edges[np.bincount(edges.of_corners, minlength=len(edges.ends)) != 2] = np.inf
        self.vertices = np.zeros(len(points))
        np.maximum.at(self.vertices, points[creases.corners], creases.corner_sharpness)


def _edge_points(
    faces: Faces,
    edges: Edges,
    places: NDArray[np.float64],
    face_points: NDArray[np.float64],
    sharp: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(E, 3)"""
    middles = places[edges.ends].mean(axis=1)
    around = np.zeros_like(middles)
    np.add.at(around, edges.of_corners, face_points[faces.of_corners])
    # Of edges with two faces; others are sharp.
    smooth = 0.5 * middles + 0.25 * around
    part = np.minimum(sharp, 1.0)[:, None]
    return part * middles + (1.0 - part) * smooth


def _vertex_points(
    faces: Faces, edges: Edges, places: NDArray[np.float64], face_points: NDArray[np.float64], sharp: _Sharpness
) -> NDArray[np.float64]:
    """(N, 3)"""
    before = _by_rule(faces, edges, places, face_points, sharp.edges, sharp.vertices)
    edges_after, vertices_after = np.maximum(sharp.edges - 1.0, 0.0), np.maximum(sharp.vertices - 1.0, 0.0)
    rules_before, rules_after = (
        _rules(edges, len(places), *values) for values in ((sharp.edges, sharp.vertices), (edges_after, vertices_after))
    )
    changes = rules_before != rules_after
    if not changes.any():
        return before
    # Where the rule is another on the next level: by how sharp, on average, that is which ends at this one.
    after = _by_rule(faces, edges, places, face_points, edges_after, vertices_after)
    sums, counts = np.zeros(len(places)), np.zeros(len(places))
    ends_now = (sharp.edges > 0.0) & (edges_after == 0.0)
    for end in (0, 1):
        np.add.at(sums, edges.ends[ends_now, end], sharp.edges[ends_now])
        np.add.at(counts, edges.ends[ends_now, end], 1.0)
    is_corner_now = (sharp.vertices > 0.0) & (vertices_after == 0.0)
    sums[is_corner_now] += sharp.vertices[is_corner_now]
    counts[is_corner_now] += 1.0
    part = np.where(changes, np.minimum(sums / np.maximum(counts, 1.0), 1.0), 1.0)[:, None]
    return part * before + (1.0 - part) * after


def _rules(
    edges: Edges, vertex_count: int, edge_sharpness: NDArray[np.float64], vertex_sharpness: NDArray[np.float64]
) -> NDArray[np.intp]:
    """(N,) 0 smooth, 1 crease, 2 corner."""
    counts = np.bincount(edges.ends[edge_sharpness > 0.0].ravel(), minlength=vertex_count)
    return np.where((vertex_sharpness > 0.0) | (counts > 2), 2, (counts == 2).astype(np.intp))


def _by_rule(
    faces: Faces,
    edges: Edges,
    places: NDArray[np.float64],
    face_points: NDArray[np.float64],
    edge_sharpness: NDArray[np.float64],
    vertex_sharpness: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(N, 3) each by its own."""
    count = len(places)
    rules = _rules(edges, count, edge_sharpness, vertex_sharpness)
    around_faces, around_edges, along_crease = np.zeros((3, count, 3))
    np.add.at(around_faces, faces.corners, face_points[faces.of_corners])
    middles = places[edges.ends].mean(axis=1)
    is_sharp = edge_sharpness > 0.0
    for end in (0, 1):
        np.add.at(around_edges, edges.ends[:, end], middles)
        np.add.at(along_crease, edges.ends[is_sharp, end], places[edges.ends[is_sharp, 1 - end]])
    valence = np.maximum(np.bincount(faces.corners, minlength=count), 1)[:, None]
    edge_count = np.maximum(np.bincount(edges.ends.ravel(), minlength=count), 1)[:, None]
    smooth = (around_faces / valence + 2.0 * around_edges / edge_count + (valence - 3.0) * places) / valence
    crease = 0.125 * along_crease + 0.75 * places
    return np.where(rules[:, None] == 2, places, np.where(rules[:, None] == 1, crease, smooth))
