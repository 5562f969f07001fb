"""Corrective displacements: the target's skinning takes them to the wanted shape."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.logic.inverse_skinning import FLATTEST, Maps, TargetSkin, growth, inverse, largest_influences
from addon.logic.turns import local_turns, turned, within_ball
from addon.logic.weights import BoneWeights

seeds = st.integers(0, 2**32 - 1)
BONES, POINTS = 4, 60
PARENTS = np.array([-1, 0, 1, 2], np.int32)


def _rig(rng: np.random.Generator, influences: int = 4):
    """A chain of four bones along z, each with its own axes, and points near it."""
    rest = np.tile(np.eye(4), (BONES, 1, 1))
    rest[:, 2, 3] = np.arange(BONES)
    for bone in range(BONES):
        rest[bone, :3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        rest[bone, :3, :3] *= np.sign(np.linalg.det(rest[bone, :3, :3]))
    points = rng.uniform([-0.5, -0.5, 0.0], [0.5, 0.5, BONES], (POINTS, 3))
    bones = np.array([rng.permutation(BONES)[:influences] for _ in range(POINTS)], np.int32)
    weights = rng.uniform(0.05, 1.0, (POINTS, influences)).astype(np.float32)
    offsets = np.arange(POINTS + 1, dtype=np.int32) * influences
    return rest, points, BoneWeights(offsets, bones.ravel(), weights.ravel())


def _pose(rng: np.random.Generator, rest: np.ndarray, most: float) -> np.ndarray:
    pose = np.tile(np.eye(4), (BONES, 1, 1))
    for bone in range(BONES):
        pose = turned(bone, within_ball(1, most, int(rng.integers(2**31))), rest, PARENTS)[0] @ pose
    return pose


@given(seeds, st.sampled_from(["linear", "dual_quaternion"]), st.integers(1, 4))
def test_key_and_skinning_make_the_wanted_shape(seed: int, mode, influences: int):
    rng = np.random.default_rng(seed)
    rest, points, weights = _rig(rng)
    skin = TargetSkin(PARENTS, rest, largest_influences(weights, influences), mode=mode)
    maps = skin.maps(_pose(rng, rest, 1.2), np.eye(4))
    wanted = maps.moved(points) + 0.1 * rng.normal(size=points.shape)
    found = inverse(maps, points, wanted)
    missed = np.linalg.norm(maps.moved(points + found.deltas) - wanted, axis=1)
    assert missed[~found.is_clamped].max(initial=0.0) < 1e-9
    assert missed.max() <= found.error + 1e-9


@given(seeds)
def test_maps_are_those_of_the_skinning(seed: int):
    rng = np.random.default_rng(seed)
    rest, points, weights = _rig(rng)
    skin = TargetSkin(PARENTS, rest, weights)
    pose, place = _pose(rng, rest, 2.0), np.diag([2.0, 2.0, 2.0, 1.0])
    moved = skin.maps(pose, place).moved(points)
    assert np.abs(moved - skin._skinning.deform(points, pose, place)).max() < 1e-12


@given(seeds)
def test_flattened_space_is_clamped_and_stays_bounded(seed: int):
    rng = np.random.default_rng(seed)
    flat = np.linalg.qr(rng.normal(size=(3, 3)))[0] @ np.diag([1.0, 0.7, 1e-9])
    maps = Maps(np.array([flat, np.eye(3), np.zeros((3, 3))], np.float64), np.zeros((3, 3)))
    wanted = rng.normal(size=(3, 3))
    found = inverse(maps, np.zeros((3, 3)), wanted)
    assert found.is_clamped.tolist() == [True, False, True]
    assert np.isfinite(found.deltas).all()
    assert np.linalg.norm(found.deltas[0]) <= np.linalg.norm(wanted[0]) / FLATTEST * (1.0 + 1e-9)
    assert np.allclose(found.deltas[1], wanted[1])
    assert found.error > 0.0


@given(seeds)
def test_no_displacement_grows_more_than_said(seed: int):
    rng = np.random.default_rng(seed)
    maps = Maps(rng.normal(size=(20, 3, 3)), np.zeros((20, 3)))
    largest = np.linalg.norm(maps.linear, ord=2, axis=(1, 2))
    assert (growth(maps) >= largest * (1.0 - 1e-12)).all()
    turns = Maps(np.linalg.qr(maps.linear)[0], maps.places)
    assert growth(turns) == pytest.approx(np.ones(20))


@given(seeds, st.integers(1, 5))
def test_the_largest_influences_stay_in_order_with_their_sum(seed: int, count: int):
    rng = np.random.default_rng(seed)
    _, _, weights = _rig(rng)
    kept = largest_influences(weights, count)
    for row in range(POINTS):
        before = weights.weights[weights.offsets[row] : weights.offsets[row + 1]]
        own = slice(kept.offsets[row], kept.offsets[row + 1])
        bones = weights.bones[weights.offsets[row] : weights.offsets[row + 1]].tolist()
        chosen = [bones.index(bone) for bone in kept.bones[own]]
        assert len(chosen) == min(count, 4)
        assert chosen == sorted(chosen)
        assert before[chosen].min() >= np.delete(before, chosen).max(initial=0.0)
        assert kept.weights[own].sum() == pytest.approx(before.sum(), rel=1e-6)


def test_vertices_without_weights_keep_none():
    kept = largest_influences(BoneWeights(np.array([0, 0, 1], np.int32), np.array([2], np.int32), np.ones(1, "f4")), 2)
    assert kept.offsets.tolist() == [0, 0, 1]


@given(seeds, st.floats(0.01, 3.1))
def test_a_turn_is_read_where_it_was_made(seed: int, most: float):
    rng = np.random.default_rng(seed)
    rest, _, _ = _rig(rng)
    vectors = within_ball(5, most, seed)
    assert np.linalg.norm(vectors, axis=1).max() <= most
    bone = int(rng.integers(BONES))
    found = local_turns(turned(bone, vectors, rest, PARENTS), rest, PARENTS)
    angles = np.linalg.norm(vectors, axis=1, keepdims=True)
    assert np.abs(found[:, bone] - vectors / angles * np.sin(angles / 2.0)).max() < 1e-9
    assert np.abs(np.delete(found, bone, axis=1)).max() < 1e-9
