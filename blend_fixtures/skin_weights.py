"""Blend weights by heat diffusion over the surface [BP07], each part of the body warmed by its own bones only.

Solves (L + H) w = H p: L the surface Laplacian, H = area / distance² to the nearest allowed bone, p = 1 there.
Transitions are as wide as the limb is thick. Written out, because Blender's own bone heat leaks between legs, fails on
small closed shells and may change between versions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .cage import Surface
from .character import Bone

MAX_INFLUENCES = 4
SMALLEST_WEIGHT = 5e-3
"""Less is not visible and only costs influences."""
TIE = 1e-4
"""Bones this much farther (relative) than the nearest share its heat: keeps mirror symmetry on the midline."""
RESIDUAL = 1e-11


def heat_weights(
    surface: Surface,
    bones: Sequence[Bone],
    part_bones: Mapping[str, Sequence[str]],
    narrowest: float,
    widest: float,
    midline: float,
) -> np.ndarray:
    """Weights (N, bone count), rows summing to one, four influences at most.

    narrowest, widest: bounds in metres on the width of a transition, which is else the distance to the bone.
    midline: width in metres of the strip on either side of x = 0 in which the bones of that side fade out.
    """
    allowed = _allowed_bones(surface, bones, part_bones)
    distances = np.stack([_segment_distance(surface.points, bone) for bone in bones], axis=1)
    distances = np.where(allowed, distances, np.inf)
    nearest = distances.min(axis=1, keepdims=True)
    sources = (distances <= nearest * (1 + TIE)).astype(float)
    sources /= sources.sum(axis=1, keepdims=True)
    areas, edges, conductances = _surface_laplacian(surface)
    heating = areas / np.clip(nearest[:, 0], narrowest, widest) ** 2
    weights = _diffuse(edges, conductances, heating, sources)
    return _limited(weights * _side_share(surface.points, bones, midline))


def _allowed_bones(surface: Surface, bones: Sequence[Bone], part_bones: Mapping[str, Sequence[str]]) -> np.ndarray:
    column = {bone.name: index for index, bone in enumerate(bones)}
    allowed = np.zeros((len(surface.points), len(bones)), dtype=bool)
    parts = np.array(surface.parts)
    for part in sorted(set(surface.parts)):
        vertices = np.unique(surface.quads[parts == part])
        allowed[np.ix_(vertices, [column[name] for name in part_bones[part]])] = True
    return allowed


def _segment_distance(points: np.ndarray, bone: Bone) -> np.ndarray:
    head, tail = np.array(bone.head), np.array(bone.tail)
    along = tail - head
    t = np.clip((points - head) @ along / (along @ along), 0.0, 1.0)
    return np.linalg.norm(points - head - t[:, None] * along, axis=1)


def _surface_laplacian(surface: Surface) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertex areas (N,), edges (E, 2) and their conductances: mean face area / length², exact on rectangles."""
    corners = surface.points[surface.quads]
    quad_areas = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1) / 2
    areas = np.bincount(surface.quads.ravel(), np.repeat(quad_areas / 4, 4), len(surface.points))
    directed = np.stack([surface.quads, np.roll(surface.quads, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, inverse = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    edge_areas = np.bincount(inverse.ravel(), np.repeat(quad_areas / 2, 4), len(edges))
    lengths = np.linalg.norm(surface.points[edges[:, 0]] - surface.points[edges[:, 1]], axis=1)
    return areas, edges, edge_areas / lengths**2


def _diffuse(edges: np.ndarray, conductances: np.ndarray, heating: np.ndarray, sources: np.ndarray) -> np.ndarray:
    """Solve (L + H) w = H p by conjugate gradients, preconditioned by the diagonal, all bones at once."""
    start, end = np.concatenate([edges, edges[:, ::-1]]).T
    order = np.argsort(start, kind="stable")
    end, flow = end[order], np.concatenate([conductances, conductances])[order, None]
    first = np.searchsorted(start[order], np.arange(len(heating)))
    diagonal = np.add.reduceat(flow, first) + heating[:, None]

    def apply(w: np.ndarray) -> np.ndarray:
        return diagonal * w - np.add.reduceat(flow * w[end], first)

    w = sources.copy()
    residual = heating[:, None] * sources - apply(w)
    preconditioned = residual / diagonal
    direction = preconditioned.copy()
    energy = (residual * preconditioned).sum(axis=0)
    target = RESIDUAL**2 * max(float(energy.max()), 1e-30)
    for _ in range(2000):
        moved = apply(direction)
        step = energy / np.maximum((direction * moved).sum(axis=0), 1e-300)
        w += step * direction
        residual -= step * moved
        preconditioned = residual / diagonal
        new_energy = (residual * preconditioned).sum(axis=0)
        if new_energy.max() <= target:
            return w
        direction = preconditioned + new_energy / np.maximum(energy, 1e-300) * direction
        energy = new_energy
    raise ArithmeticError("heat diffusion did not converge: is part of the surface without bones?")


def _side_share(points: np.ndarray, bones: Sequence[Bone], midline: float) -> np.ndarray:
    """One for central bones; those of one side reach neither the midline nor the other side: (N, bone count)."""
    share = np.ones((len(points), len(bones)))
    for index, bone in enumerate(bones):
        if bone.name.endswith((".L", ".R")):
            t = np.clip(points[:, 0] * (1 if bone.name.endswith(".L") else -1) / midline, 0.0, 1.0)
            share[:, index] = t * t * (3 - 2 * t)
    return share


def _limited(weights: np.ndarray) -> np.ndarray:
    """At most MAX_INFLUENCES per vertex, sums one.

    The next largest weight is subtracted from all, so that an influence fades out and never breaks off. Rounded to six
    digits: the last bits of a machine do not show.
    """
    surplus = np.sort(weights, axis=1)[:, -MAX_INFLUENCES - 1, None] if weights.shape[1] > MAX_INFLUENCES else 0.0
    kept = np.round(np.maximum(weights - np.maximum(surplus, SMALLEST_WEIGHT), 0.0), 6)
    return kept / kept.sum(axis=1, keepdims=True)
