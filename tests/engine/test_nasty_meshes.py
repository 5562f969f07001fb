"""Meshes, skeletons and poses as nobody wants them: finite, exact where there is an inside, still where none is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from reference_volume import mean_of_fans
from rigs import Mode, chain, random_rotation, rotation, translation
from surfaces import Surface, cube, open_tube, strip, tube

EXACT = 1e-10
PRESETS: tuple[turgor.presets.PresetName, ...] = ("isotropic", "rubber", "muscle", "folds", "belly")
seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])


def scattered_cubes(count: int) -> Surface:
    """Shells of all sizes along the limb."""
    rng = np.random.default_rng(count)
    result = Surface(np.zeros((0, 3)), [])
    for _ in range(count):
        size, place = rng.uniform(0.01, 0.1), rng.uniform([0.0, -0.4, -0.4], [4.0, 0.4, 0.4])
        one = cube()
        result = result.joined(one.moved(size * one.positions + place))
    return result


def with_faces(surface: Surface, *faces: list[int]) -> Surface:
    return Surface(surface.positions, [*surface.faces, *faces])


def crumbled(surface: Surface) -> Surface:
    """Some faces missing, some turned, some points loose."""
    rng = np.random.default_rng(5)
    kept = [list(face) for face in surface.faces if rng.random() > 0.05]
    turned = [face[::-1] if rng.random() < 0.1 else face for face in kept]
    return Surface(np.vstack([surface.positions, rng.uniform(-5.0, 5.0, (4, 3))]), turned)


LIMB = tube(17, 8)
MESHES: dict[str, Surface] = {
    "caps of 320 corners": tube(3, 320),
    "300 shells": scattered_cubes(300),
    "a triangle": Surface(LIMB.positions[:3], [[0, 1, 2]]),
    "two triangles": Surface(LIMB.positions[:4], [[0, 1, 2], [0, 2, 3]]),
    "two triangles, both sides": Surface(LIMB.positions[:4], [[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]]),
    "a strip": strip(),
    "a face twice": with_faces(LIMB, list(LIMB.faces[20])),
    "a fin": with_faces(LIMB, [8, 9, 60]),
    "a corner twice in a face": Surface(LIMB.positions, [[f[0], *f] for f in LIMB.faces]),
    "every face alone": LIMB.split_apart(),
    "crumbled": crumbled(LIMB),
    "crumbled and open": crumbled(open_tube(17, 8)),
    "rough": LIMB.roughened(np.random.default_rng(1), 0.2),
    "squashed": LIMB.moved(LIMB.positions * [1.0, 1.0, 1e-3]),
    "loose points only": Surface(LIMB.positions, []),
}


def relative_volume_errors(surface: Surface, frame: turgor.Frame) -> NDArray[np.float64]:
    """(K,) of every sound shell; where faces are plain, by the independent measure."""
    mesh = surface.mesh()
    volumes = mesh.component_volumes(frame.positions)
    is_plain = mesh.welded_count == mesh.vertex_count and all(len(set(face)) == len(face) for face in surface.faces)
    # Some of a face's corners may belong to another shell as well.
    component_of_face = np.array([np.median(mesh.vertex_components[list(face)]) for face in surface.faces])
    for index, component in enumerate(mesh.components):
        if is_plain and component.status == "closed" and component.flipped_face_count == 0:
            own = np.flatnonzero(component_of_face == index)
            volumes[index] = mean_of_fans(Surface(frame.positions, [surface.faces[face] for face in own]))
    targets = frame.report.target_volumes
    sound = [component.is_sound for component in mesh.components]
    return np.abs(volumes / np.where(targets == 0.0, 1.0, targets) - 1.0)[sound]


def assert_sane(surface: Surface, frame: turgor.Frame):
    """Finite, and nothing without an inside has moved, nor anything further than the mesh is large."""
    assert np.isfinite(frame.positions).all()
    mesh = surface.mesh()
    is_corrected = np.array([*(part.is_sound for part in mesh.components), False])[mesh.vertex_components]
    # A vertex may belong to several shells.
    near = [face for face in surface.faces if is_corrected[list(face)].any()]
    is_still = ~np.isin(np.arange(mesh.vertex_count), np.concatenate([[-1], *near]))
    moved = np.linalg.norm(frame.positions - frame.skinned, axis=1)
    size = max(np.linalg.norm(np.ptp(points, axis=0)) for points in (surface.positions, frame.skinned))
    assert not moved[is_still].any()
    assert moved.max(initial=0.0) <= size


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("name", MESHES)
def test_any_mesh(name: str, preset: turgor.presets.PresetName):
    surface = MESHES[name]
    rig = chain(surface, 3)
    joints = [turgor.presets.joint(preset, bone) for bone in range(3)]
    for solver in ("simultaneous", "sequential"):
        for mode in ("linear", "dual_quaternion"):
            frame = rig.body(mode, joints, solver=solver).deform(rig.bent(0.6, twist=0.3))
            assert_sane(surface, frame)
            assert frame.report.relative_error <= EXACT
            assert relative_volume_errors(surface, frame).max(initial=0.0) <= EXACT


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize(("size", "place"), [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e6), (1e6, 1e6)])
def test_any_unit_and_place(size: float, place: float, preset: turgor.presets.PresetName):
    rig = chain(tube(17, 8), 3)
    change = translation([place, -place, place]) @ np.diag([size, size, size, 1.0])
    moved = rig.with_surface(rig.surface.moved(rig.surface.positions * size + [place, -place, place]))
    moved = replace(moved, rest_matrices=change @ rig.rest_matrices @ np.diag([1 / size, 1 / size, 1 / size, 1.0]))
    pose = change @ rig.bent(0.8, twist=0.4) @ np.linalg.inv(change)
    joints = [turgor.presets.joint(preset, bone) for bone in range(3)]
    for mode in ("linear", "dual_quaternion"):
        frame = moved.body(mode, joints).deform(pose)
        assert_sane(moved.surface, frame)
        # What points that far from the origin can hold at all.
        digits = np.finfo(float).eps * np.abs(frame.positions).max() / size
        assert relative_volume_errors(moved.surface, frame).max() <= EXACT + 100.0 * digits


def odd_bone(kind: str) -> NDArray[np.float64]:
    return {
        "mirrored": np.diag([-1.0, 1.0, 1.0, 1.0]),
        "flattened": np.diag([1.0, 0.0, 1.0, 1.0]),
        "a line": np.diag([0.0, 1.0, 0.0, 1.0]),
        "nothing": np.diag([0.0, 0.0, 0.0, 1.0]),
        "almost nothing": np.diag([1e-20, 1e-20, 1e-20, 1.0]),
        "enormous": np.diag([1e4, 1e4, 1e4, 1.0]),
        "torn off": translation([0.0, 40.0, 0.0]),
    }[kind]


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize(
    "kind", ["mirrored", "flattened", "a line", "nothing", "almost nothing", "enormous", "torn off"]
)
def test_any_bone(kind: str, preset: turgor.presets.PresetName):
    rng = np.random.default_rng(3)
    rig = chain(tube(33, 12), 5)
    joints = [turgor.presets.joint(preset, bone) for bone in range(5)]
    for mode in ("linear", "dual_quaternion"):
        for solver in ("simultaneous", "sequential"):
            body = rig.body(mode, joints, solver=solver)
            for bone in range(5):
                local = [random_rotation(rng, 1.0) for _ in range(5)]
                local[bone] = local[bone] @ odd_bone(kind)
                posed: list[NDArray[np.float64]] = []
                for rest, parent, turn in zip(rig.rest_matrices, rig.parents, local, strict=True):
                    before = np.linalg.inv(rig.rest_matrices[parent]) @ rest if parent >= 0 else rest
                    posed.append((posed[parent] if parent >= 0 else np.eye(4)) @ before @ turn)
                frame = body.deform(np.array(posed) @ np.linalg.inv(rig.rest_matrices))
                assert_sane(rig.surface, frame)
                assert np.isfinite(frame.report.relative_error)


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_sixty_children_of_one_bone(mode: Mode):
    """Every bone but the first hangs on it, and bends skin of its own."""
    surface = tube(241, 12)
    rig = chain(surface, 61)
    rig = replace(rig, parents=np.array([-1, *[0] * 60], dtype=np.int32))
    rng = np.random.default_rng(4)
    frame = rig.body(mode).deform(rig.random_pose(rng, 0.2))
    assert_sane(surface, frame)
    assert relative_volume_errors(surface, frame).max() <= EXACT


@given(seeds, modes, solvers)
def test_weights_at_random(seed: int, mode: Mode, solver):
    """Any bones on any vertex, some of them twice, some vertices without."""
    rng = np.random.default_rng(seed)
    rig = chain(tube(17, 8), 6)
    weights = rng.choice([0.0, 1e-30, 1e-5, 0.3, 1.0, 1e4], rig.weights.shape)
    rig = replace(rig, bones=rng.integers(0, 6, rig.bones.shape).astype(np.int32), weights=weights)
    frame = rig.body(mode, solver=solver).deform(rig.random_pose(rng, 0.4))
    assert np.isfinite(frame.positions).all()
    # Such skin may be turned inside out; then no field reaches the target, and the report says so.
    error = relative_volume_errors(rig.surface, frame).max()
    assert error == pytest.approx(frame.report.relative_error, abs=EXACT)


def test_fields_that_hold_next_to_nothing():
    """200 joints over 15 points, in large units: coefficients beyond single precision."""
    rig = chain(tube(3, 5), 200, softness=6.0)
    size = 1e6
    large = rig.with_surface(rig.surface.moved(rig.surface.positions * size))
    change = np.diag([size, size, size, 1.0])
    large = replace(large, rest_matrices=change @ rig.rest_matrices @ np.linalg.inv(change))
    for preset in PRESETS:
        body = large.body(joints=[turgor.presets.joint(preset, bone, size=0.2) for bone in range(200)])
        for seed in range(10):
            pose = rig.random_pose(np.random.default_rng(seed), 3.0)
            assert np.isfinite(body.deform(change @ pose @ np.linalg.inv(change)).positions).all()


class TestShellsThatTouch:
    """Two shells that use the same vertices, but no edge, keep their own volumes."""

    @staticmethod
    def joined_at(first: Surface, second: Surface, pairs: dict[int, int]) -> Surface:
        """Vertex `pairs[v]` of the second surface becomes vertex v of the first."""
        other = {theirs: ours for ours, theirs in pairs.items()}
        kept = [vertex for vertex in range(len(second.positions)) if vertex not in other]
        number = other | {vertex: len(first.positions) + place for place, vertex in enumerate(kept)}
        faces = [*first.faces, *[[number[corner] for corner in face] for face in second.faces]]
        return Surface(np.vstack([first.positions, second.positions[kept]]), faces)

    @pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
    def test_closed_shells(self, solver):
        lower, upper = tube(17, 8), tube(17, 8)
        upper = upper.moved(upper.positions + np.array([0.0, 1.0, 0.0]))
        touching = 8 * 8  # its top is at y = 0.5, and the upper tube's lowest point there too
        assert np.allclose(lower.positions[touching], upper.positions[touching + 4])
        both = self.joined_at(lower, upper, {touching: touching + 4})
        frame = chain(both, 3).body(solver=solver).deform(chain(both, 3).bent(0.7))
        assert relative_volume_errors(both, frame).max() <= EXACT

    @pytest.mark.parametrize("seed", range(10))
    def test_open_shells(self, seed: int):
        """Two points on the rims of both: each opening has its own cap, whatever the order of vertices."""
        left, right = open_tube(9, 8), open_tube(9, 8)
        right = right.moved(right.positions * [1.0, 1.0, 2.0] + [4.0, 0.0, 0.0])
        both = self.joined_at(left, right, {64: 0, 68: 4})
        order = np.random.default_rng(seed).permutation(len(both.positions))
        mixed = Surface(both.positions[np.argsort(order)], [[int(order[c]) for c in face] for face in both.faces])
        expected = sorted(side.mesh().components[0].rest_volume for side in (left, right))
        components = mixed.mesh().components
        np.testing.assert_allclose(sorted(component.rest_volume for component in components), expected, rtol=1e-12)


class TestTurnsAreNoIntent:
    """However a rig is put together: where bones only turn about their joints, the rest volume is kept."""

    @given(seeds, modes)
    def test_bones_without_weights_in_between(self, seed: int, mode: Mode):
        rng = np.random.default_rng(seed)
        rig = chain(tube(33, 12), 6)
        weights = np.where(np.isin(rig.bones, [2, 3]), 0.0, rig.weights)
        rig = replace(rig, weights=weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-3))
        report = rig.body(mode).deform(rig.random_pose(rng, 0.5)).report
        assert report.target_volumes[0] == pytest.approx(mean_of_fans(rig.surface), rel=1e-9)

    @given(seeds, modes, st.booleans())
    def test_chains_cut_by_a_control_rig(self, seed: int, mode: Mode, has_heavy_head: bool):
        """The last bone has no parent, but goes where the chain carries it; its tree may be the heavier one."""
        rng = np.random.default_rng(seed)
        rig = chain(tube(33, 12), 4)
        pose = rig.random_pose(rng, 0.5)
        cut = replace(rig, parents=np.array([-1, 0, 1, -1], dtype=np.int32))
        if has_heavy_head:
            eye = tube(65, 32)
            head = cut.surface.joined(eye.moved(0.1 * eye.positions + [3.5, 0.0, 0.5]))
            added = len(eye.positions)
            bones = np.vstack([cut.bones, np.tile(np.array([3, 2, 1], dtype=np.int32), (added, 1))])
            weights = np.vstack([cut.weights, np.tile([1.0, 0.0, 0.0], (added, 1))])
            cut = replace(cut, surface=head, bones=bones, weights=weights)
        report = cut.body(mode).deform(pose).report
        expected = [component.rest_volume for component in cut.surface.mesh().components]
        np.testing.assert_allclose(report.target_volumes, expected, rtol=1e-9)

    def test_a_root_that_follows_a_chain_loses_where_the_skin_blends(self):
        tied = chain(tube(33, 12), 4)
        cut = replace(tied, parents=np.array([-1, 0, 1, -1], dtype=np.int32))
        pose = tied.pose([np.eye(4), np.eye(4), np.eye(4), rotation([0.0, 0.0, 1.0], 0.8)])
        losses = []
        for body in (tied.body(), cut.body()):
            report = body.deform(pose).report
            losses.append(report.joint_losses[body.joint_bones.tolist().index(3)])
        assert losses[0] == pytest.approx(losses[1], rel=1e-9)
