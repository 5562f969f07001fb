"""Flex: a bulge beyond what was lost, taken from the same limb."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Fields, Mode, limb
from test_folds import deep, elbow

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
fields = st.sampled_from(["plain", "even"])
flexes = st.floats(0.0, 10.0)
PRESETS: tuple[turgor.presets.PresetName, ...] = ("isotropic", "muscle", "flesh")


def flexed(bone: int, flex: float, preset: turgor.presets.PresetName = "muscle") -> list[turgor.Joint]:
    return [turgor.presets.joint(preset, bone, flex=flex)]


@given(seeds, modes, fields, flexes, st.sampled_from(PRESETS), st.sampled_from(["simultaneous", "sequential"]))
def test_volume_is_exact(seed: int, mode: Mode, kind: Fields, flex: float, preset, solver):
    rng = np.random.default_rng(seed)
    rig = limb(4)
    joints = [turgor.presets.joint(preset, bone, flex=flex * rng.random(), flesh=1.0) for bone in range(rig.bone_count)]
    frame = rig.body(mode, joints, fields=kind, solver=solver).deform(rig.random_pose(rng, 1.5))
    found = rig.surface.mesh().component_volumes(frame.positions)
    np.testing.assert_allclose(found, frame.report.target_volumes, rtol=1e-12)


@given(seeds, modes, fields)
def test_none_of_it_is_the_same_to_the_last_bit(seed: int, mode: Mode, kind: Fields):
    rig = limb()
    pose = rig.random_pose(np.random.default_rng(seed), 1.0)
    frames = [
        rig.body(mode, joints, fields=kind).deform(pose) for joints in (flexed(1, 0.0), [turgor.presets.muscle(1)])
    ]
    np.testing.assert_array_equal(frames[0].offsets, frames[1].offsets)


@pytest.mark.parametrize("kind", ["plain", "even"])
def test_a_muscle_rises_and_the_limb_around_it_gives(kind: Fields):
    """On the parent's side; the bulge grows with the flex, and elsewhere skin sinks in."""
    rig = limb(2, rings=97, sides=24)
    pose = rig.bent(1.2)
    still = rig.body(joints=flexed(1, 0.0), fields=kind).deform(pose).positions
    heights = []
    for flex in (0.25, 0.5, 1.0):
        moved = rig.body(joints=flexed(1, flex), fields=kind).deform(pose).positions - still
        normals = vertex_normals(rig, still)
        outwards = np.einsum("ij,ij->i", moved, normals)
        top = np.argmax(outwards)
        assert rig.surface.positions[top, 0] < 2.0
        assert outwards.min() < 0.0
        heights.append(outwards[top])
    assert np.all(np.diff(heights) > 0.2 * heights[0])


@pytest.mark.parametrize("kind", ["plain", "even"])
def test_a_limb_at_rest_flexes_too(kind: Fields):
    """A straight joint has no axes: it swells all around, and the rest of the limb grows thinner."""
    rig = limb(2, rings=97, sides=24)
    frame = rig.body(joints=flexed(1, 1.0, "isotropic"), fields=kind).deform(rig.rest_pose())
    x, *across = rig.surface.positions.T
    grown = np.hypot(*frame.positions[:, 1:].T) - np.hypot(*across)
    is_side = (x > 0.3) & (x < 3.7)
    assert grown[is_side & (abs(x - 2.0) < 0.1)].min() > 0.01
    assert grown[is_side & (abs(x - 2.0) > 1.2)].max() < 0.0
    assert frame.report.relative_error <= 1e-12


@given(seeds, fields)
def test_nothing_jumps(seed: int, kind: Fields):
    rng = np.random.default_rng(seed)
    rig = limb()
    pose, flex = rig.random_pose(rng, 1.0), rng.uniform(0.0, 2.0)
    near = [rig.body(joints=flexed(1, value), fields=kind).deform(pose).positions for value in (flex, flex + 1e-4)]
    assert np.abs(near[1] - near[0]).max() < 1e-3


@pytest.mark.parametrize("seed", [1, 7, 8, 11])
def test_volume_that_comes_back_after_folds_brings_no_second_bulge(seed: int):
    """What was held back comes back elsewhere; a muscle that flexed twice would stand out half as far again."""
    rng = np.random.default_rng(seed)
    rig = elbow(softness=rng.uniform(0.1, 0.35))
    pose = deep(rig, rng)
    joints = [turgor.presets.joint("muscle", bone, flex=0.5) for bone in range(rig.bone_count)]
    body = rig.body(joints=joints, fields="even")
    plain, repaired = body.deform(pose), body.deform(pose, repair_folds=True)
    assert repaired.report.folds_found > 0
    assert repaired.report.max_displacement < 1.45 * plain.report.max_displacement


@pytest.mark.parametrize("flex", [-0.1, 10.1, np.nan])
def test_what_is_no_flex_is_refused(flex: float):
    with pytest.raises(turgor.TurgorError, match="flex"):
        turgor.Joint(1, flex=flex)


def vertex_normals(rig, positions: np.ndarray) -> np.ndarray:
    """(N, 3) unit, by the areas of the faces around each vertex."""
    normals = np.zeros_like(positions)
    offsets, corners = rig.surface.face_offsets, rig.surface.face_corners
    for start, end in pairwise(offsets):
        face = corners[start:end]
        points = positions[face] - positions[face].mean(0)
        normals[face] += np.cross(points, np.roll(points, -1, 0)).sum(0)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
