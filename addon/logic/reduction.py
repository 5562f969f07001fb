"""As few shape keys as hold a given error over all frames.

The displacements of all frames, a matrix of frames by coordinates, are split into singular vectors. So many of them as
keep every vertex on every frame within the tolerance become keys, weighted by frame: the largest error counts, not the
mean, so frames and vertices that are worst off are given more weight in a few rounds, which saves keys.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Frames of displacements, (S, N, 3) each, in order; perhaps mapped from files.
Samples = Sequence[NDArray[np.float32]]

# Coordinates that are looked at in one go: memory stays bounded whatever the mesh.
BLOCK_NUMBERS = 1 << 24
# Counts of keys that are tried in one go, at first.
FIRST_BATCH = 16
# Rounds of giving weight to what is worst off.
ROUNDS = 8
# How fast: powers of the part that the error of a vertex, or a frame, is of the worst.
VERTEX_POWER, FRAME_POWER = 0.5, 0.25
# No vertex and no frame is forgotten.
LEAST_WEIGHT = 1e-3
# Singular vectors of less than this part of the largest are rounding of float32.
LEAST_SINGULAR = 1e-7


class Reduction(NamedTuple):
    """K keys that stand for F frames: displacement of frame f = values[f] @ keys."""

    keys: NDArray[np.float32]  # (K, N, 3)
    values: NDArray[np.float64]  # (F, K) as large as 1
    worst: NDArray[np.float64]  # (F,) largest error of a frame's vertices
    rms: NDArray[np.float64]  # (F,) root of the mean square of them

    @property
    def error(self) -> float:
        """The largest of all."""
        return float(self.worst.max(initial=0.0))


def reduce(samples: Samples, tolerance: float, growth: NDArray[np.float64] | None = None) -> Reduction:
    """The fewest keys found that keep `tolerance`, in units of the samples; all frames where none fewer do.

    growth: (N,) factor on each vertex's error, for displacements that are stretched afterwards. A larger tolerance
    never takes more keys; the same samples give the same bits.
    """
    task = _Task(samples, np.ones(samples[0].shape[1]) if growth is None else growth, tolerance)
    even = np.ones(task.frame_count), np.ones(len(task.growth))
    vectors = _singular_vectors(task.products(*even))
    best = None
    for count in range(_leading_count(task, vectors), vectors.shape[1] + 1):
        best, _ = task.made(vectors[:, :count], even[0])
        if best.error <= tolerance:
            break
    if best is None or best.error > tolerance:
        return _all_frames(samples)
    while best.values.shape[1] and (fewer := _balanced(task, best.values.shape[1] - 1)) is not None:
        best = fewer
    return best


def within_unit(reduction: Reduction) -> Reduction:
    """Equal displacements with values from 0 to 1, for engines that clamp others: one more key, always at 1."""
    values = reduction.values
    low = np.minimum(values.min(axis=0, initial=0.0), 0.0)
    span = np.maximum(values.max(axis=0, initial=0.0), 0.0) - low
    moved = np.divide(values - low, span, out=np.zeros_like(values), where=span > 0.0)
    keys = reduction.keys * span[:, None, None].astype(np.float32)
    if low.any():
        base = np.tensordot(low, reduction.keys.astype(np.float64), 1)[None]
        keys = np.concatenate([base.astype(np.float32), keys])
        moved = np.concatenate([np.ones((len(values), 1)), moved], axis=1)
    return reduction._replace(keys=keys, values=moved)


class _Task:
    """The displacements, block by block of their vertices, and what errors count."""

    def __init__(self, samples: Samples, growth: NDArray[np.float64], tolerance: float) -> None:
        self._samples = samples
        self.frame_count = sum(map(len, samples))
        self.growth = growth
        self.tolerance = tolerance

    def blocks(self) -> Iterator[tuple[slice, NDArray[np.float64]]]:
        """Vertices and their displacements, (F, n, 3)."""
        width = max(BLOCK_NUMBERS // (3 * max(self.frame_count, 1)), 1)
        for start in range(0, len(self.growth), width):
            at = slice(start, min(start + width, len(self.growth)))
            yield at, np.concatenate([part[:, at] for part in self._samples]).astype(np.float64)

    def products(self, frame_weights: NDArray[np.float64], vertex_weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """(F, F) of the weighted frames with each other."""
        total = np.zeros((self.frame_count, self.frame_count))
        for at, block in self.blocks():
            rows = (block * (frame_weights[:, None, None] * vertex_weights[at][None, :, None])).reshape(len(block), -1)
            total += rows @ rows.T
        return total

    def made(
        self, vectors: NDArray[np.float64], frame_weights: NDArray[np.float64]
    ) -> tuple[Reduction, NDArray[np.float64]]:
        """Keys along orthonormal vectors (F, K) of the weighted frames, as they will be stored.

        Beside them the largest error of each vertex, (N,).
        """
        values = vectors / frame_weights[:, None]
        largest = np.abs(values).max(axis=0, initial=0.0)
        values = values / largest
        to_keys = (vectors * largest).T * frame_weights
        keys = np.empty((vectors.shape[1], len(self.growth), 3), np.float32)
        worst, squares = np.zeros(self.frame_count), np.zeros(self.frame_count)
        of_vertices = np.zeros(len(self.growth))
        for at, block in self.blocks():
            flat = block.reshape(len(block), -1)
            of_block = (to_keys @ flat).astype(np.float32)
            keys[:, at] = of_block.reshape(len(keys), *block.shape[1:])
            missed = _lengths((flat - values @ of_block.astype(np.float64)).reshape(block.shape)) * self.growth[at]
            worst = np.maximum(worst, missed.max(axis=1, initial=0.0))
            squares += (missed * missed).sum(axis=1)
            of_vertices[at] = missed.max(axis=0)
        rms = np.sqrt(squares / max(len(self.growth), 1))
        return Reduction(keys, values, worst, rms), of_vertices


def _singular_vectors(products: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, R) left singular vectors, the largest first, each with its largest number positive."""
    sizes, vectors = np.linalg.eigh(products)
    order = np.argsort(-sizes, kind="stable")
    order = order[sizes[order] > max(LEAST_SINGULAR**2 * float(sizes.max(initial=0.0)), 0.0)]
    vectors = vectors[:, order]
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=0)[None], axis=0)
    return np.where(largest < 0.0, -vectors, vectors)


def _leading_count(task: _Task, vectors: NDArray[np.float64]) -> int:
    """How many of the first singular vectors keep the tolerance, before keys are rounded."""
    first, batch = 0, FIRST_BATCH
    while first <= vectors.shape[1]:
        last = min(first + batch, vectors.shape[1])
        errors = np.zeros(last - first + 1)
        for at, block in task.blocks():
            rest = block.reshape(len(block), -1)
            parts = vectors[:, :last].T @ rest
            rest = rest - vectors[:, :first] @ parts[:first]
            for count in range(first, last + 1):
                missed = _lengths(rest.reshape(block.shape)).max(axis=0) * task.growth[at]
                errors[count - first] = max(errors[count - first], float(missed.max(initial=0.0)))
                if count < last:
                    rest -= np.outer(vectors[:, count], parts[count])
        held = np.flatnonzero(errors <= task.tolerance)
        if len(held):
            return first + int(held[0])
        first, batch = last + 1, 2 * batch
    return vectors.shape[1]


def _balanced(task: _Task, count: int) -> Reduction | None:
    """So many keys that keep the tolerance, if weights for what is worst off find them."""
    frames, vertices = np.ones(task.frame_count), np.ones(len(task.growth))
    for _ in range(ROUNDS):
        vectors = _singular_vectors(task.products(frames, vertices))
        found, of_vertices = task.made(vectors[:, :count], frames)
        if found.error <= task.tolerance:
            return found
        frames = _more_weight(frames, found.worst, FRAME_POWER)
        vertices = _more_weight(vertices, of_vertices, VERTEX_POWER)
    return None


def _more_weight(weights: NDArray[np.float64], errors: NDArray[np.float64], power: float) -> NDArray[np.float64]:
    raised = weights * (errors / errors.max() + LEAST_WEIGHT) ** power
    return np.maximum(raised / raised.max(), LEAST_WEIGHT)


def _all_frames(samples: Samples) -> Reduction:
    keys = np.concatenate(samples)
    nothing = np.zeros(len(keys))
    return Reduction(keys, np.eye(len(keys)), nothing, nothing)


def _lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
