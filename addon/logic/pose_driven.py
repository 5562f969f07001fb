"""Shape keys that poses drive: displacements learnt as polynomials of how far each bone is turned.

Each key has one bone, and its value is a polynomial of third degree in the x, y, z of the bone's turn, short enough to
be a driver that Blender works out without Python. Every bone is learnt from poses in which it turns alone; then all are
adjusted together to frames of the animation, as far as the single poses allow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations_with_replacement
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .reduction import Samples

AXES = "xyz"
DEGREE = 3
# Products of x, y, z up to the third degree: places of their factors.
TERMS = tuple(factors for degree in range(1, DEGREE + 1) for factors in combinations_with_replacement(range(3), degree))
# Part of the mean square of the terms that numbers of a polynomial must earn.
RIDGE = 1e-5
# What the animation must outweigh to change what single poses taught.
TRUST_IN_SINGLE_POSES = 1e-2
# Terms of a value below this part of its largest are left out.
LEAST_TERM = 2e-4
# Characters that a driver's expression may have.
LONGEST_EXPRESSION = 255
MOST_DIGITS = 5


class Part(NamedTuple):
    """What one bone does: polynomials and the displacements that they move."""

    bone: int
    coefficients: NDArray[np.float64]  # (K, terms)
    keys: NDArray[np.float32]  # (K, N, 3)
    sizes: NDArray[np.float64]  # (K,) largest displacement of each in its learning poses


class Learnt(NamedTuple):
    """All keys, K of them."""

    bones: NDArray[np.int32]  # (K,)
    coefficients: NDArray[np.float64]  # (K, terms)
    keys: NDArray[np.float32]  # (K, N, 3)

    def values(self, turns: NDArray[np.float64]) -> NDArray[np.float64]:
        """(F, K) of poses with `turns`, (F, B, 3)."""
        columns = [terms(turns[:, bone]) @ row for bone, row in zip(self.bones, self.coefficients, strict=True)]
        return np.stack(columns, axis=1) if columns else np.zeros((len(turns), 0))

    def error(self, turns: NDArray[np.float64], samples: Samples) -> NDArray[np.float64]:
        """(F,) largest error of each pose's vertices."""
        values, start, found = self.values(turns), 0, []
        for part in samples:
            made = np.tensordot(values[start : start + len(part)], self.keys.astype(np.float64), 1)
            found.append(np.linalg.norm(made - part, axis=2).max(axis=1, initial=0.0))
            start += len(part)
        return np.concatenate(found)


def terms(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, terms) of one bone's turns (F, 3); all 0 at rest."""
    return np.stack([turns[:, factors].prod(axis=1) for factors in map(list, TERMS)], axis=1)


def learn(bone: int, turns: NDArray[np.float64], deltas: NDArray[np.float64], least: float) -> Part:
    """Learn a bone's keys from M poses in which it turns alone.

    turns: (M, 3) of the bone, see `turns.local_turns`. deltas: (M, N, 3) what is to be added to the skin there.

    Keys that move some vertex by more than `least`, those that matter most first.
    """
    known = terms(turns)
    second = known.T @ known / len(known)
    ridged = second + RIDGE * second.trace() / len(second) * np.eye(len(second))
    shapes = np.linalg.solve(ridged, known.T @ deltas.reshape(len(known), -1) / len(known))
    # In the measure of what the terms do in these poses, the polynomials apart from each other.
    root = np.linalg.cholesky(ridged)
    responses = root.T @ shapes
    vectors = np.linalg.eigh(responses @ responses.T)[1][:, ::-1]
    keys = vectors.T @ responses
    coefficients = np.linalg.solve(root.T, vectors).T
    values = known @ coefficients.T
    largest = np.abs(values).max(axis=0)
    largest = np.where(largest > 0.0, largest, 1.0)
    keys = (keys * largest[:, None]).reshape(len(keys), -1, 3)
    sizes = np.linalg.norm(keys, axis=2).max(axis=1, initial=0.0)
    is_kept = sizes > least
    return Part(bone, (coefficients / largest[:, None])[is_kept], keys[is_kept].astype(np.float32), sizes[is_kept])


def assemble(parts: Sequence[Part], least: float, most: int) -> Learnt:
    """The keys that move some vertex by more than `least`, at most `most` of them; bones in order."""
    ranked = sorted(
        ((size, number, key) for number, part in enumerate(parts) for key, size in enumerate(part.sizes)),
        key=lambda entry: (-entry[0], *entry[1:]),
    )
    chosen = sorted((number, key) for size, number, key in ranked[:most] if size > least)
    if not chosen:
        shape = parts[0].keys.shape[1:] if parts else (0, 3)
        return Learnt(np.zeros(0, np.int32), np.zeros((0, len(TERMS))), np.zeros((0, *shape), np.float32))
    return Learnt(
        np.array([parts[number].bone for number, _ in chosen], np.int32),
        np.array([_shortened(parts[number].coefficients[key]) for number, key in chosen]),
        np.stack([parts[number].keys[key] for number, key in chosen]),
    )


def adjusted(
    learnt: Learnt, single_turns: Mapping[int, NDArray[np.float64]], turns: NDArray[np.float64], samples: Samples
) -> Learnt:
    """The keys changed so that frames of an animation, `turns` (F, B, 3) and `samples`, are met better.

    single_turns: by bone, (M, 3) of the poses that it was learnt from: what they taught is kept where it can be.
    """
    values = learnt.values(turns)
    if not values.size:
        return learnt
    weight = np.zeros((values.shape[1], values.shape[1]))
    for bone in np.unique(learnt.bones):
        own = np.flatnonzero(learnt.bones == bone)
        seen = terms(single_turns[int(bone)]) @ learnt.coefficients[own].T
        weight[np.ix_(own, own)] = seen.T @ seen / len(seen)
    weight += RIDGE * weight.trace() / len(weight) * np.eye(len(weight))
    spread = np.linalg.solve(weight, values.T)
    gram = values @ spread
    gram += TRUST_IN_SINGLE_POSES * gram.trace() / len(gram) * np.eye(len(gram))
    keys = learnt.keys.copy()
    wanted = np.concatenate(samples)
    missed = wanted - np.tensordot(values, keys.astype(np.float64), 1)
    keys += np.tensordot(spread @ np.linalg.inv(gram), missed, 1).astype(np.float32)
    return learnt._replace(keys=keys)


def expression(coefficients: NDArray[np.float64]) -> str:
    """A driver's expression of x, y and z: sums and products only, at most `LONGEST_EXPRESSION` characters."""
    return next(
        text
        for digits in range(MOST_DIGITS, 0, -1)
        if len(text := _text(coefficients, digits)) <= LONGEST_EXPRESSION or digits == 1
    )


def _text(coefficients: NDArray[np.float64], digits: int) -> str:
    written = (
        f"{_number(number, digits)}*{'*'.join(AXES[factor] for factor in factors)}"
        for number, factors in zip(coefficients, TERMS, strict=True)
        if number != 0.0
    )
    return "".join(written).removeprefix("+") or "0"


def _shortened(coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coefficients rounded as the driver's expression will write them, so that what is learnt is what is driven."""
    kept = np.where(np.abs(coefficients) < LEAST_TERM * np.abs(coefficients).max(), 0.0, coefficients)
    digits = MOST_DIGITS
    while True:
        rounded = np.array([float(_number(number, digits)) if number else 0.0 for number in kept])
        if digits == 1 or len(_text(rounded, digits)) <= LONGEST_EXPRESSION:
            return rounded
        digits -= 1


def _number(number: float, digits: int) -> str:
    """A number in short form, with its sign."""
    text = f"{number:+.{digits}g}"
    if "e" in text:
        text = np.format_float_positional(float(text), sign=True, trim="-")
    return text.replace("0.", ".", 1) if text[1:].startswith("0.") else text
