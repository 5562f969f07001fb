"""One frame by `deform`, `deform_into`, `deform_into_address`, `deform_many`, `measure`: the same bits, on any mesh."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
import turgor
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from rigs import Mode, Rig, chain, random_rigid_motion, rotation, translation
from surfaces import Surface, shells_on_common_points, tube
from test_nasty_meshes import MESHES

Solver = Literal["simultaneous", "sequential"]

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])
# What the volumes may differ by that a frame reports and that are measured on its positions, part of the shell's.
MEASURED = 1e-10


@st.composite
def surfaces(draw: st.DrawFn) -> Surface:
    """Shells that share points, coincident vertices along seams, or anything that nobody wants."""
    rng = np.random.default_rng(draw(seeds))
    kind = draw(st.sampled_from(["shared", "seams", "shared and a tube", "nasty"]))
    if kind == "shared":
        return shells_on_common_points(rng, int(rng.integers(1, 6)))
    if kind == "seams":
        return tube(9, 8).roughened(rng, 0.05).split_apart()
    if kind == "shared and a tube":
        return tube(9, 8).joined(shells_on_common_points(rng, 3))
    return MESHES[draw(st.sampled_from(sorted(MESHES)))]


def careless_rig(surface: Surface, rng: np.random.Generator) -> Rig:
    """Three bones; vertices at one place may be held by different ones, and some vertices by none."""
    rig = chain(surface, 3)
    weights = rig.weights * rng.choice([1.0, 1.0, rng.random()], (len(rig.weights), 1))
    bones = np.where(rng.random((len(rig.bones), 1)) < 0.1, rig.bones[:, ::-1], rig.bones)
    weights[rng.random(len(weights)) < 0.05] = 0.0
    mask = np.where(rng.random(len(weights)) < 0.2, rng.random(len(weights)), 1.0) if rng.random() < 0.3 else None
    return Rig(surface, rig.parents, rig.rest_matrices, bones, weights, mask)


def poses_of(rig: Rig, rng: np.random.Generator, count: int) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """(F, B, 4, 4), and the other arguments of each frame."""
    poses = np.array([rig.random_pose(rng, 0.8, scale=0.1, shift=0.1) for _ in range(count)])
    size = np.diag([*rng.uniform(0.5, 2.0, 3), 1.0])
    options: dict[str, Any] = {"target_scale": rng.uniform(0.8, 1.2, count)}
    options["object_from_armature"] = np.array([random_rigid_motion(rng) @ size for _ in range(count)])
    return poses, options


@settings(max_examples=200)
@given(seeds, surfaces(), modes, solvers)
def test_all_paths_give_the_same_bits(seed: int, surface: Surface, mode: Mode, solver: Solver):
    rng = np.random.default_rng(seed)
    rig = careless_rig(surface, rng)
    count = len(surface.positions)
    shapes = rng.normal(scale=0.02, size=(1, count, 3)) if rng.random() < 0.5 else None
    joints = [turgor.presets.muscle(bone=1)] if rng.random() < 0.5 else None
    body = turgor.VolumeSkin(surface.mesh(), rig.skinning(mode), joints, solver=solver, shape_deltas=shapes)
    if rng.random() < 0.5:
        body = body.with_mask(rng.random(count).astype(np.float32))
    poses, options = poses_of(rig, rng, 3)
    options["repair_folds"] = bool(rng.random() < 0.2)
    if shapes is not None:
        options["shape_values"] = rng.uniform(-1.0, 1.0, (3, 1))
    effect = rng.choice([1.0, 0.3], 3)
    many = body.deform_many(poses, effect=effect, **options)
    folds = options.pop("repair_folds")
    measures = body.measure(poses, **options) if not folds else None
    for row, pose in enumerate(poses):
        own = {name: values[row] for name, values in options.items()} | {"repair_folds": folds}
        frame = body.deform(pose, **own)
        assert np.array_equal(many[row], (frame.skinned + effect[row] * frame.offsets.astype(float)).astype("f4"))
        farthest = np.linalg.norm(frame.offsets.astype(float), axis=1).max(initial=0.0)
        assert frame.report.max_displacement == pytest.approx(farthest, rel=1e-6)
        room, raw = np.full((2, count, 3), np.nan, np.float32)
        assert body.deform_into(room, pose, **own).max_displacement == frame.report.max_displacement
        body.deform_into_address(raw.ctypes.data, count, pose, **own)
        assert np.array_equal(room, frame.offsets)
        assert np.array_equal(raw, frame.offsets)
        if measures is not None:
            assert np.array_equal(measures.corrected_volumes[row], frame.report.corrected_volumes)


@settings(max_examples=100)
@given(seeds, surfaces(), modes, st.booleans())
def test_offsets_added_by_another_deformer_reach_every_path(seed: int, surface: Surface, mode: Mode, has_folds: bool):
    rng = np.random.default_rng(seed)
    rig = careless_rig(surface, rng)
    count = len(surface.positions)
    body = turgor.VolumeSkin(surface.mesh(), rig.skinning(mode))
    poses, options = poses_of(rig, rng, 2)
    added = rng.normal(scale=0.03, size=(count, 3)).astype(np.float32)
    for row, pose in enumerate(poses):
        own: dict[str, Any] = {name: values[row] for name, values in options.items()} | {"repair_folds": has_folds}
        plain = body.deform(pose, **own)
        frame = body.deform(pose, added_offsets=added, **own)
        room = np.full((count, 3), np.nan, np.float32)
        body.deform_into(room, pose, added_offsets=added, **own)
        assert np.array_equal(room, frame.offsets)
        size = max(1.0, float(np.abs(frame.skinned).max(initial=0.0)))
        assert np.abs(frame.skinned - plain.skinned - added).max(initial=0.0) <= 1e-6 * size


@settings(max_examples=200)
@given(seeds, surfaces(), modes, solvers)
def test_figures_are_those_of_the_positions(seed: int, surface: Surface, mode: Mode, solver: Solver):
    """Volumes that a frame reports, measured on what it returns; positions and offsets say the same."""
    rng = np.random.default_rng(seed)
    rig = careless_rig(surface, rng)
    mesh = surface.mesh()
    body = turgor.VolumeSkin(mesh, rig.skinning(mode), solver=solver)
    pose = rig.random_pose(rng, 0.8)
    place = translation(rng.uniform(-3.0, 3.0, 3)) @ rotation([0.0, 0.6, 0.8], 0.4)
    frame = body.deform(pose, object_from_armature=place, target_scale=1.1)
    size = max(1.0, float(np.abs(frame.skinned).max(initial=0.0)))
    assert np.abs(frame.positions - frame.skinned - frame.offsets).max(initial=0.0) <= 1e-6 * size
    # Where skinning opened a seam, what is measured is the surface between its sides.
    if frame.report.seam_gap > 0.0:
        return
    sound = np.array([component.is_sound for component in mesh.components], bool)
    for positions, reported in (
        (frame.positions, frame.report.corrected_volumes),
        (frame.skinned, frame.report.skinned_volumes),
    ):
        measured = mesh.component_volumes(positions)
        scale = np.abs(frame.report.target_volumes) + size**3 * 1e-3
        assert (np.abs(measured - reported)[sound] <= MEASURED * scale[sound]).all()


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_two_shells_that_share_a_point_keep_their_volumes(order: tuple[int, int]):
    """The point they share stays as skinned; on every path."""
    corners = [(0, 0, 0), (1, 0, 0.1), (1, 1, 0), (0.9, 0.2, 1), (-2, 0, 0), (-2, 2, 0.3), (-1.7, 0.2, 2)]
    shells = [[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], [[0, 4, 5], [0, 6, 4], [4, 6, 5], [5, 6, 0]]]
    surface = Surface(np.array(corners, float), [*shells[order[0]], *shells[order[1]]])
    mesh = surface.mesh()
    still = turgor.Skinning(turgor.Skeleton([-1], [np.eye(4)]), np.zeros(8, np.int32), [], [])
    body = turgor.VolumeSkin(mesh, still)
    frame = body.deform(np.eye(4)[None], target_scale=1.3)
    many = body.deform_many(np.eye(4)[None, None], target_scale=1.3)[0]
    assert not frame.offsets[0].any()
    assert np.array_equal(many, (frame.skinned + frame.offsets.astype(float)).astype("f4"))
    wanted = 1.3 * mesh.component_volumes(surface.positions)
    assert len(wanted) == 2
    assert mesh.component_volumes(frame.positions) == pytest.approx(wanted, rel=1e-12)
    assert mesh.component_volumes(many) == pytest.approx(wanted, rel=1e-6)
