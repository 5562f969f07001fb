"""Which faces to turn so that every shell looks outwards."""

from __future__ import annotations

from collections import defaultdict, deque

import numpy as np
from numpy.typing import NDArray

from .shells import boxes


def faces_to_turn(
    positions: NDArray[np.float64],
    face_offsets: NDArray[np.int32],
    face_corners: NDArray[np.int32],
    welded: NDArray[np.int32],
) -> NDArray[np.bool_]:
    """(F,) welded: (N,) the vertex that stands for each at its place.

    Faces of a shell are made to agree, then all are turned when the shell encloses less than nothing. A shell in the
    box of another looks where most of its faces do: it may be a hollow. One that cannot agree is left alone.
    """
    corners = welded[face_corners]
    shells, turns, agrees = _agree(face_offsets, corners)
    count = int(shells.max(initial=-1)) + 1
    volumes = _volumes(positions, face_offsets, corners, np.where(turns, -1.0, 1.0), shells, count)
    of_vertex = np.full(len(positions), -1, np.int32)
    of_vertex[corners] = np.repeat(shells, np.diff(face_offsets))
    low, high = boxes(positions, of_vertex, count)
    for shell in range(count):
        mine = shells == shell
        if not agrees[shell]:
            turns[mine] = False
            continue
        inside = (low <= low[shell]).all(1) & (high >= high[shell]).all(1)
        inside[shell] = False
        is_wrong = 2 * turns[mine].sum() > mine.sum() if inside.any() else volumes[shell] < 0.0
        if is_wrong:
            turns[mine] = ~turns[mine]
    return turns


def _agree(
    offsets: NDArray[np.int32], corners: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.bool_], list[bool]]:
    """Shell of each face, whether it must turn to agree with the shell's first, and which shells can agree."""
    edges: dict[tuple[int, int], list[tuple[int, bool]]] = defaultdict(list)
    faces = [corners[offsets[face] : offsets[face + 1]].tolist() for face in range(len(offsets) - 1)]
    for face, ring in enumerate(faces):
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            if a != b:
                edges[min(a, b), max(a, b)].append((face, a < b))
    shells, turns = np.full(len(faces), -1, np.int32), np.zeros(len(faces), bool)
    agrees: list[bool] = []
    for first in range(len(faces)):
        if shells[first] >= 0:
            continue
        shells[first] = len(agrees)
        agrees.append(True)
        queue = deque([first])
        while queue:
            face = queue.popleft()
            ring = faces[face]
            for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
                users = edges.get((min(a, b), max(a, b)), [])
                agrees[-1] &= len(users) <= 2
                for other, is_forward in users:
                    if other == face:
                        continue
                    turn = bool(turns[face]) ^ (is_forward == (a < b))
                    if shells[other] < 0:
                        shells[other], turns[other] = shells[first], turn
                        queue.append(other)
                    elif turns[other] != turn:
                        agrees[-1] = False
    return shells, turns, agrees


def _volumes(
    positions: NDArray[np.float64],
    offsets: NDArray[np.int32],
    corners: NDArray[np.int32],
    signs: NDArray[np.float64],
    shells: NDArray[np.int32],
    count: int,
) -> NDArray[np.float64]:
    """(K,) enclosed by each shell about its own middle, in thirds of a unit; of an open one by the fan to it."""
    sizes = np.diff(offsets)
    faces = np.repeat(np.arange(len(sizes)), sizes)
    of_corner = shells[faces]
    middles = np.stack([np.bincount(of_corner, positions[corners, axis], count) for axis in range(3)], 1)
    middles /= np.maximum(np.bincount(of_corner, minlength=count), 1)[:, None]
    here = positions[corners] - middles[of_corner]
    following = np.arange(len(corners)) + 1
    following[offsets[1:][sizes > 0] - 1] = offsets[:-1][sizes > 0]
    centres = np.stack([np.bincount(faces, here[:, axis], len(sizes)) for axis in range(3)], 1)
    centres /= np.maximum(sizes, 1)[:, None]
    parts = np.einsum("ij,ij->i", centres[faces], np.cross(here, here[following]))
    return np.bincount(of_corner, parts * signs[faces], count).astype(np.float64)
