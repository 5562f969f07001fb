"""Catmull-Clark subdivision of closed quad meshes [CC78], and its limit surface.

Written out, because a modifier's vertex order may change between versions of Blender and a fixture's must not.
"""

from __future__ import annotations

import numpy as np


def subdivide(points: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One level: points (N', 3), quads (4F, 4) and the parent (4F,) of each quad."""
    edges, quad_edges = _edges(quads)
    vertex_count, edge_count = len(points), len(edges)
    face_points = points[quads].mean(axis=1)
    edge_faces = np.zeros((edge_count, 3))
    np.add.at(edge_faces, quad_edges.ravel(), np.repeat(face_points, 4, axis=0))
    edge_points = (points[edges].sum(axis=1) + edge_faces) / 4

    valence = np.bincount(quads.ravel(), minlength=vertex_count)[:, None]
    around_faces = np.zeros((vertex_count, 3))
    np.add.at(around_faces, quads.ravel(), np.repeat(face_points, 4, axis=0))
    around_edges = np.zeros((vertex_count, 3))
    np.add.at(around_edges, edges.ravel(), np.repeat(points[edges].mean(axis=1), 2, axis=0))
    vertex_points = around_faces / valence**2 + 2 * around_edges / valence**2 + points * (valence - 3) / valence

    face_index = vertex_count + edge_count + np.arange(len(quads))
    edge_index = vertex_count + quad_edges
    children = [np.stack([quads[:, c], edge_index[:, c], face_index, edge_index[:, c - 1]], axis=1) for c in range(4)]
    fine = np.stack(children, axis=1).reshape(-1, 4)
    return np.concatenate([vertex_points, edge_points, face_points]), fine, np.repeat(np.arange(len(quads)), 4)


def limit_points(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Where subdivision for ever takes each vertex: (n² v + 4 Σ edge neighbours + Σ opposite corners) / (n (n + 5))."""
    valence = np.bincount(quads.ravel(), minlength=len(points))[:, None]
    neighbours = np.zeros_like(points)
    opposite = np.zeros_like(points)
    for corner in range(4):
        np.add.at(neighbours, quads[:, corner], points[quads[:, (corner + 1) % 4]])
        np.add.at(opposite, quads[:, corner], points[quads[:, (corner + 2) % 4]])
    return (valence**2 * points + 4 * neighbours + opposite) / (valence * (valence + 5))


def fit_limit(targets: np.ndarray, quads: np.ndarray, iterations: int) -> np.ndarray:
    """Control points whose limit surface passes near `targets`; few iterations leave it smoother than exact."""
    points = targets.copy()
    for _ in range(iterations):
        points += targets - limit_points(points, quads)
    return points


def _edges(quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unique edges (E, 2), and the edge (F, 4) that leaves each corner."""
    directed = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, inverse = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    return edges, inverse.reshape(quads.shape)
