"""New weights beside those that stay."""

from __future__ import annotations

import numpy as np
import pytest

from addon.logic import automatic_weights as merging

VERTICES, BONES = 50, 6


def rows(rng: np.random.Generator, total: float = 1.0) -> np.ndarray:
    weights = rng.random((VERTICES, BONES)) * (rng.random((VERTICES, BONES)) < 0.5)
    weights[:, 0] += 0.01
    return total * weights / weights.sum(axis=1, keepdims=True)


@pytest.fixture
def choice() -> merging.Choice:
    return merging.Choice(
        np.array([True, True, False, False, False, True]),
        np.array([False, False, False, True, False, False]),
        np.arange(VERTICES) % 3 > 0,
    )


def merged(found: np.ndarray, existing: np.ndarray, choice: merging.Choice) -> np.ndarray:
    return merging.dense(merging.merged(merging.sparse(found), merging.sparse(existing), choice), BONES)


@pytest.mark.parametrize("total", [0.0, 0.4, 1.0, 3.0])
def test_chosen_vertices_sum_to_one_and_others_have_no_row(choice: merging.Choice, total: float):
    rng = np.random.default_rng(1)
    existing = rows(rng, total)
    existing[:, 3] = rng.random(VERTICES)
    found = rows(rng)
    found[:, 3] = 0.0
    found *= ((1.0 - existing[:, 3]) / found.sum(axis=1))[:, None]
    found[:, 3] = existing[:, 3]
    result = merged(found, existing, choice)
    np.testing.assert_allclose(result[choice.vertices].sum(axis=1), 1.0, atol=1e-6)
    assert not result[~choice.vertices].any()
    np.testing.assert_allclose(result[choice.vertices, 3], existing[choice.vertices, 3], atol=1e-6)


def test_other_bones_keep_their_proportions(choice: merging.Choice):
    rng = np.random.default_rng(2)
    found, existing = rows(rng), rows(rng)
    found[:, 3] = existing[:, 3] = 0.0
    found /= found.sum(axis=1, keepdims=True)
    existing[:, [2, 4]] += 0.1
    result = merged(found, existing, choice)[choice.vertices]
    before = existing[choice.vertices]
    np.testing.assert_allclose(result[:, 2] * before[:, 4], result[:, 4] * before[:, 2], atol=1e-6)
    np.testing.assert_allclose(result[:, [0, 1, 5]], found[choice.vertices][:, [0, 1, 5]], atol=1e-6)


def test_all_bones_chosen_is_what_was_found():
    rng = np.random.default_rng(3)
    found = rows(rng)
    everything = merging.Choice(np.ones(BONES, bool), np.zeros(BONES, bool), np.ones(VERTICES, bool))
    np.testing.assert_allclose(merged(found, rows(rng), everything), found, atol=1e-7)


def test_parts_join_to_the_whole():
    whole = merging.sparse(rows(np.random.default_rng(4)))
    joined = merging.joined([merging.part(whole, 0, 7), merging.part(whole, 7, 7), merging.part(whole, 7, VERTICES)])
    assert all(np.array_equal(a, b) for a, b in zip(joined, whole, strict=True))


def test_vertices_of_the_body_take_its_weights_but_for_locked_ones():
    rng = np.random.default_rng(5)
    found, body = rows(rng), rows(rng)
    is_locked = np.arange(BONES) == 2
    found[:, 2] = 0.25
    body[:, 2] = 0.0
    body /= body.sum(axis=1, keepdims=True)
    places = np.where(np.arange(VERTICES) % 2, np.arange(VERTICES)[::-1], -1).astype(np.int32)
    result = merging.dense(merging.as_on_body(merging.sparse(found), merging.sparse(body), places, is_locked), BONES)
    np.testing.assert_allclose(result[::2], found[::2], atol=1e-7)
    np.testing.assert_allclose(result[1::2, 2], 0.25, atol=1e-7)
    free = np.delete(result, 2, axis=1)[1::2]
    np.testing.assert_allclose(free, 0.75 * np.delete(body, 2, axis=1)[places[1::2]], atol=1e-7)
