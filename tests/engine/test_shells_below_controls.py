"""What moves a shell as a whole means nothing about its shape, wherever else its bones hold skin."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from rigs import Mode, Rig, random_rigid_motion, random_rotation, rotation, translation
from surfaces import tube

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])

ROOT, CONTROL, UP, DOWN = range(4)
ALONG_X = rotation([0.0, 0.0, 1.0], -np.pi / 2)


def rig_of(*, parents: list[int], root_holds: str) -> Rig:
    """A limb of two bones, and beside it what the root holds: a shell of its own, or a limb on the same two bones."""
    limb, beside = tube(33, 12), tube(33, 12)
    x = np.concatenate([limb.positions[:, 0], beside.positions[:, 0]])
    t = np.clip((x - 2.0) / 0.8 + 0.5, 0.0, 1.0)
    up = t * t * (3.0 - 2.0 * t)
    root = np.zeros(len(x))
    of_beside = np.arange(len(x)) >= len(limb.positions)
    root[of_beside] = 1.0 if root_holds == "a shell" else np.exp(-(((x[of_beside] - 2.0) / 0.8) ** 2))
    weights = np.stack([root, up * (1.0 - root), (1.0 - up) * (1.0 - root)], axis=1)
    bones = np.tile(np.array([ROOT, UP, DOWN], dtype=np.int32), (len(x), 1))
    surface = limb.joined(beside.moved(beside.positions + np.array([0.0, 3.0, 0.0])))
    heads = [[-1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [2.0, 0.0, 0.0], [2.0, 0.1, 0.0]]
    rest = np.array([translation(head) @ ALONG_X for head in heads])
    return Rig(surface, np.array(parents, dtype=np.int32), rest, bones, weights)


BELOW_CONTROL = [-1, ROOT, CONTROL, CONTROL]
BELOW_ROOT = [-1, ROOT, ROOT, ROOT]
rigs = st.builds(
    rig_of,
    parents=st.sampled_from([BELOW_CONTROL, BELOW_ROOT]),
    root_holds=st.sampled_from(["a shell", "skin of the same bones"]),
)


def moved_together(rig: Rig, rng: np.random.Generator, together: NDArray[np.float64]) -> NDArray[np.float64]:
    """The root anywhere; control and both bones moved by `together`, then one of them turned."""
    root = random_rigid_motion(rng)
    common = root @ together
    head = rig.rest_matrices[UP][:3, 3]
    up = common @ translation(head) @ random_rotation(rng, 1.0) @ translation(-head)
    return np.array([root, common, up, common])


@given(seeds, modes, rigs, st.floats(0.0, 30.0))
def test_a_shift_changes_no_target_however_far(seed: int, mode: Mode, rig: Rig, far: float):
    rng = np.random.default_rng(seed)
    shift = translation(far * rng.normal(size=3))
    report = rig.body(mode).deform(moved_together(rig, rng, shift)).report
    rest = rig.surface.mesh().components[0].rest_volume
    assert report.target_volumes[0] == pytest.approx(rest, rel=1e-9)
    assert report.relative_error < 1e-10


@given(seeds, modes, rigs, st.floats(0.0, 30.0), st.booleans())
def test_nor_what_the_skin_is_given(seed: int, mode: Mode, rig: Rig, far: float, keeps_scale: bool):
    """Shape apart from the shift: the same offsets, but for rounding."""
    rng = np.random.default_rng(seed)
    shift = far * rng.normal(size=3)
    turned = moved_together(rig, rng, np.eye(4))
    shifted = turned.copy()
    # Shifted in the root's space.
    by = turned[ROOT, :3, :3] @ shift
    shifted[[CONTROL, UP, DOWN], :3, 3] += by
    body = rig.body(mode, keep_bone_scale=keeps_scale)
    limb = slice(0, len(rig.surface.positions) // 2)
    before, after = body.deform(turned).positions[limb], body.deform(shifted).positions[limb]
    np.testing.assert_allclose(after - by, before, atol=1e-5)


@given(seeds, modes)
def test_a_turn_of_the_control_loses_nothing(seed: int, mode: Mode):
    """Below the control only one bone turns: the whole loss is its own."""
    rng = np.random.default_rng(seed)
    rig = rig_of(parents=BELOW_CONTROL, root_holds="a shell")
    body = rig.body(mode)
    report = body.deform(moved_together(rig, rng, random_rigid_motion(rng))).report
    losses = dict(zip(body.joint_bones.tolist(), report.joint_losses, strict=True))
    total = report.target_volumes.sum() - report.skinned_volumes.sum()
    assert losses[UP] == pytest.approx(total, abs=1e-9 * report.target_volumes.sum())


@given(seeds, modes, rigs, st.floats(0.5, 2.0))
def test_a_scale_is_meant_once(seed: int, mode: Mode, rig: Rig, scale: float):
    rng = np.random.default_rng(seed)
    head = rig.rest_matrices[CONTROL][:3, 3]
    scaled = translation(head) @ np.diag([scale, scale, scale, 1.0]) @ translation(-head)
    report = rig.body(mode).deform(moved_together(rig, rng, scaled)).report
    rest = rig.surface.mesh().components[0].rest_volume
    assert report.target_volumes[0] == pytest.approx(scale**3 * rest, rel=1e-6)


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_a_bone_that_is_pulled_out_of_its_parent_is_meant_to_be(mode: Mode):
    """Between bones of one shell a shift is a stretch, as far as it goes."""
    rig = rig_of(parents=BELOW_CONTROL, root_holds="skin of the same bones")
    pulled = np.array([np.eye(4), np.eye(4), translation([0.3, 0.0, 0.0]), np.eye(4)])
    report = rig.body(mode).deform(pulled).report
    rest = [component.rest_volume for component in rig.surface.mesh().components]
    np.testing.assert_allclose(report.target_volumes, report.skinned_volumes, rtol=1e-9)
    assert np.all(report.target_volumes > 1.02 * np.array(rest))
