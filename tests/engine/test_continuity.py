"""No pops: halving the time step halves the largest step of any vertex (MATH 3)."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
import turgor
from rigs import Mode, Rig, limb, rotation

Motion = Callable[[Rig, float], np.ndarray]


def swing_through_straight(rig: Rig, time: float) -> np.ndarray:
    """The bend changes its sign at time 0, while every joint twists by up to a quarter turn."""
    return rig.bent(0.8 * time, twist=np.pi / 2 * (0.5 + 0.5 * time) / (rig.bone_count - 1))


def wheel_around_straight(rig: Rig, time: float) -> np.ndarray:
    """A small bend whose axis turns all around, twisted: the bend's direction swings fast, its size hardly changes."""
    axis = [np.cos(np.pi * time), 0.0, np.sin(np.pi * time)]
    turned = rotation(axis, 0.05) @ rotation([0.0, 1.0, 0.0], 0.6)
    return rig.pose([np.eye(4), *[turned] * (rig.bone_count - 1)])


def straight_twist(rig: Rig, time: float) -> np.ndarray:
    """No bend at all: the joints' frames are undefined throughout."""
    return rig.bent(0.0, twist=time)


def largest_step(body: turgor.VolumeSkin, rig: Rig, motion: Motion, step_count: int) -> float:
    times = np.linspace(-1.0, 1.0, step_count + 1)
    positions = [body.deform(motion(rig, time)).positions for time in times]
    return max(np.abs(after - before).max() for before, after in pairwise(positions))


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
@pytest.mark.parametrize("preset", ["isotropic", "rubber", "muscle", "folds", "belly"])
@pytest.mark.parametrize("motion", [swing_through_straight, wheel_around_straight, straight_twist])
def test_half_the_time_step_is_half_the_vertex_step(motion: Motion, preset: turgor.presets.PresetName, solver):
    rig = limb()
    joints = [turgor.presets.joint(preset, bone) for bone in range(rig.bone_count)]
    body = rig.body(joints=joints, solver=solver)
    coarse, middle, fine = (largest_step(body, rig, motion, count) for count in (128, 256, 512))
    assert middle <= 0.55 * coarse
    assert fine <= 0.55 * middle


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_correction_vanishes_with_the_pose(mode: Mode):
    rig = limb()
    body = rig.body(mode)
    moves = [body.deform(rig.bent(angle, twist=angle)).report.max_displacement for angle in (0.1, 0.01, 0.001)]
    assert moves[0] > moves[1] > moves[2]
    assert moves[2] < 1e-4
