"""Even fields: fine detail is carried along with the skin around it, and profiles act as they are drawn."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Fields, Mode, Rig, chain, limb, rotation
from surfaces import tube

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
ANGLE = 1.0
# Of a fan of 12 sides, bent.
COSINE_MIN = 0.9


def dented(depth: float) -> Rig:
    """A bent limb whose inside, beside the joint, has a hole like a navel: its walls look at each other."""
    surface = tube(rings=96, sides=48)
    rig = chain(surface, 2)
    x, y, z = surface.positions.T
    away = np.hypot(x - 2.0, z) / 0.12
    inside = np.where((y > 0.0) & (away < 1.0), (1.0 - np.minimum(away, 1.0) ** 2) ** 2, 0.0)
    moved = surface.positions - depth * inside[:, None] * np.array([0.0, 1.0, 0.0])
    return rig.with_surface(surface.moved(moved))


def stretch(rig: Rig, frame: turgor.Frame) -> float:
    """The worst length of an edge, corrected, over the longer of skinned and at rest."""
    offsets, corners = rig.surface.face_offsets, rig.surface.face_corners
    faces = [corners[start:end] for start, end in pairwise(offsets)]
    edges = np.array([(a, b) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True)])
    length = lambda points: np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)  # noqa: E731
    return float((length(frame.positions) / np.maximum(length(frame.skinned), length(rig.surface.positions))).max())


def deformed(rig: Rig, fields: Fields) -> turgor.Frame:
    return rig.body(joints=[turgor.presets.belly(1)], fields=fields).deform(rig.bent(ANGLE))


def test_a_navel_is_carried_along():
    rig = dented(0.15)
    smooth, even, plain = deformed(dented(0.0), "even"), deformed(rig, "even"), deformed(rig, "plain")
    assert even.report.relative_error <= 1e-12
    assert stretch(rig, even) <= 1.1 * stretch(dented(0.0), smooth)
    assert stretch(rig, plain) > 1.1 * stretch(rig, even)


@given(seeds, modes)
def test_profiles_act_as_they_are_drawn(seed: int, mode: Mode):
    """A curve that is 1 everywhere: every point that is wholly the joint's, up to a length away, counts in full."""
    rig = limb(bone_count=2)
    everywhere = (np.ones(2), np.ones(2), np.ones(2))
    joints = [turgor.Joint(1, shares=(0.0, 0.0, 1.0), profiles=everywhere)]
    pose = rig.bent(float(np.random.default_rng(seed).uniform(0.3, 1.2)))
    field = rig.body(mode, joints, fields="even").joint_field(1, pose)
    head = rig.rest_matrices[1][:3, 3]
    places = np.linalg.solve(field.axes.T * field.length, (rig.body(mode).deform(pose).skinned - field.origin).T).T
    away = np.linalg.norm(rig.surface.positions - head, axis=1) / field.length
    inside = (np.abs(places) < 0.99).all(1) & (away < 0.99)
    assert inside.any()
    bell = rig.body(mode, [turgor.Joint(1)], fields="even").joint_field(1, pose)
    drawn = (field.gamma - (1.0 - field.axes_share) * bell.gamma)[inside] / field.axes_share
    np.testing.assert_allclose(drawn, 1.0, atol=1e-5)


@given(seeds, modes)
def test_without_detail_both_push_alike(seed: int, mode: Mode):
    """On a round limb the evened out normals are its normals: even fields reach farther, but the same way."""
    rig = limb(bone_count=2)
    pose = rig.bent(float(np.random.default_rng(seed).uniform(0.2, 0.8)))
    plain, even = (rig.body(mode, fields=fields).deform(pose) for fields in ("plain", "even"))
    offsets = [frame.positions - frame.skinned for frame in (plain, even)]
    lengths = [np.linalg.norm(moved, axis=1) for moved in offsets]
    moves = np.all([length > 0.1 * length.max() for length in lengths], axis=0)
    cosines = np.einsum("ij,ij->i", *offsets)[moves] / np.prod(lengths, axis=0)[moves]
    assert moves.sum() > 50
    assert cosines.min() > COSINE_MIN


def test_an_unknown_kind_is_refused_by_name():
    with pytest.raises(turgor.TurgorError, match='fields: need "plain" or "even", got "round"'):
        limb().body(fields="round")  # type: ignore[arg-type]


@given(seeds, modes)
def test_exact_with_the_law_of_flesh(seed: int, mode: Mode):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=4)
    joints = [turgor.Joint(bone, flesh=float(rng.uniform(0.0, 1.0))) for bone in range(rig.bone_count)]
    frame = rig.body(mode, joints, fields="even").deform(rig.random_pose(rng, 0.8))
    assert np.isfinite(frame.positions).all()
    assert frame.report.relative_error <= 1e-12


@given(seeds, modes)
def test_a_shell_that_skinning_turns_over(seed: int, mode: Mode):
    """Weights that have nothing to do with the bones leave little of a small shell, or turn it inside out."""
    rng = np.random.default_rng(seed)
    surface = tube(rings=13, sides=10)
    rig = chain(surface, 3)
    surface = surface.moved(surface.positions * rng.uniform(0.05, 0.5) + rng.uniform(-3.0, 3.0, 3))
    along = (surface.positions - surface.positions.mean(0)) / np.ptp(surface.positions, axis=0)
    weights = 1.0 / (1.0 + np.exp(-8.0 * along @ rng.normal(size=(3, 3))))
    bones = np.tile(np.arange(3, dtype=np.int32), (len(weights), 1))
    rig = replace(rig, surface=surface, bones=bones, weights=weights / weights.sum(1, keepdims=True))
    pose = rig.random_pose(rng, 2.5)
    plain, even = (rig.body(mode, fields=fields).deform(pose) for fields in ("plain", "even"))
    assert plain.report.relative_error <= 1e-12
    assert even.report.relative_error <= 1e-12
    assert np.isfinite(even.positions).all()


def test_nothing_jumps_while_a_shell_is_flattened():
    """Normals that are carried along come to lie in the plane, and fields go over to the gradient: steps halve."""
    rig = limb(bone_count=2, rings=25)
    even, plain = (rig.body(fields=fields) for fields in ("even", "plain"))

    def swollen(body: turgor.VolumeSkin, thickness: float) -> np.ndarray:
        pose = np.array([np.diag([1.0, 1.0, thickness, 1.0])] * 2)
        frame = body.deform(pose, target_scale=1.05)
        return frame.positions - frame.skinned

    largest = []
    for steps in (200, 400):
        frames = [swollen(even, thickness) for thickness in np.linspace(0.2, 0.002, steps + 1)]
        largest.append(max(np.abs(b - a).max() for a, b in pairwise(frames)))
    assert largest[1] <= 0.62 * largest[0], largest
    apart = [np.abs(swollen(even, t) - swollen(plain, t)).max() / np.abs(swollen(plain, t)).max() for t in (0.2, 0.002)]
    assert apart[1] <= 0.01 < 0.5 < apart[0], apart


def test_how_far_a_volume_moves_skin_does_not_jump_while_a_shell_is_flattened():
    """The displacement that a joint reports, over the volume that it gives back: fields follow what they push along."""
    rig = limb(bone_count=2, rings=25)
    body = rig.body(fields="even")

    def needed(thickness: float) -> float:
        report = body.deform(np.diag([1.0, 1.0, thickness, 1.0]) @ rig.bent(ANGLE)).report
        return float(np.log(report.joint_displacements[1] / report.joint_regained[1]))

    largest = [
        np.abs(np.diff([needed(thickness) for thickness in np.geomspace(0.2, 0.002, steps + 1)])).max()
        for steps in (100, 200)
    ]
    assert largest[1] <= 0.62 * largest[0], largest


@pytest.mark.parametrize("degrees", [0.0, 60.0, 120.0, 150.0])
def test_what_turns_by_angle_still_swells_outwards(degrees: float):
    """Normals turn with the skin that twists spread along the bone."""
    rig = limb(bone_count=3, rings=65, sides=24)
    joints = [turgor.Joint(bone, flesh=1.0) for bone in range(rig.bone_count)]
    pose = rig.pose([np.eye(4), rotation([0.0, 1.0, 0.0], np.radians(degrees)), np.eye(4)])
    body = rig.body(joints=joints, fields="even")
    swollen, plain = (body.deform(pose, target_scale=scale).positions for scale in (1.1, 1.0))
    radial = plain * [0.0, 1.0, 1.0]
    is_side = (plain[:, 0] > 0.3) & (plain[:, 0] < 3.7)
    radial = radial[is_side] / np.linalg.norm(radial[is_side], axis=1, keepdims=True)
    moved = (swollen - plain)[is_side]
    outwards = (moved * radial).sum(1)
    around = np.linalg.norm(np.cross(moved, radial)[:, :1], axis=1)
    assert outwards.min() > 0.0
    assert around.max() <= 0.05 * outwards.max()
