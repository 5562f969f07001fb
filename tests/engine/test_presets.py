"""The five ready-made corrections (MATH 4)."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
import turgor
from rigs import limb
from turgor import presets

NAMES = get_args(presets.PresetName)


@pytest.mark.parametrize("name", NAMES)
def test_curves_are_soft_and_compact(name):
    for curve in presets.profiles(name):
        assert len(curve) >= 2
        assert (curve >= 0.0).all()
        assert curve[0] == curve[-1] == 0.0
        assert curve.max() > 0.1
        assert np.abs(np.diff(curve)).max() < 0.5


@pytest.mark.parametrize("name", NAMES)
def test_only_belly_folds_and_only_along_the_parent(name):
    folded, plain = presets.folded_profiles(name), presets.profiles(name)
    assert (folded is not None) == (name == "belly")
    if folded is not None:
        assert (folded[0] <= plain[0]).all()
        assert np.count_nonzero(np.diff(np.sign(np.diff(folded[0]))) < 0) > 1
        assert all(np.array_equal(f, p) for f, p in zip(folded[1:], plain[1:], strict=True))


def test_unknown_preset_folds_into_an_error():
    with pytest.raises(ValueError, match="isotropic, rubber, muscle, folds, belly"):
        presets.folded_profiles("triceps")  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize("solver", ["simultaneous", "sequential"])
@pytest.mark.parametrize("name", NAMES)
def test_volume_is_exact(name, solver):
    rig = limb()
    joints = [presets.joint(name, bone) for bone in range(rig.bone_count)]
    for angle in (0.2, 0.8, 1.4):
        report = rig.body(joints=joints, solver=solver).deform(rig.bent(angle, twist=0.3)).report
        assert report.relative_error <= 1e-12


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
@pytest.mark.parametrize("name", NAMES)
def test_random_poses_are_exact_and_nothing_flies_off(name, mode):
    rig = limb()
    body = rig.body(mode, [presets.joint(name, bone) for bone in range(rig.bone_count)])
    for seed in range(300):
        report = body.deform(rig.random_pose(np.random.default_rng(seed), 1.0)).report
        assert report.relative_error <= 1e-12
        # The tube's radius is 0.5, and it loses a tenth at most.
        assert report.max_displacement < 0.25


@pytest.mark.parametrize("name", NAMES)
def test_named_function_is_the_preset(name):
    joint = getattr(presets, name)(2, strength=0.5, size=1.5)
    assert (joint.bone, joint.strength, joint.size) == (2, 0.5, 1.5)
    assert joint.shares == presets.DEFAULT_SHARES[name]


def test_shares_can_be_replaced():
    assert presets.joint("muscle", 1, shares=(0.0, 0.5, 0.5)).shares == (0.0, 0.5, 0.5)


def test_unknown_preset_is_an_error_that_names_the_known():
    with pytest.raises(ValueError, match="isotropic, rubber, muscle, folds, belly"):
        presets.profiles("triceps")  # pyright: ignore[reportArgumentType]


def test_presets_differ_in_shape():
    rig = limb(rings=65, sides=24)
    pose = rig.bent(0.9)
    results = {
        name: rig.body(joints=[presets.joint(name, bone) for bone in range(3)]).deform(pose).offsets for name in NAMES
    }
    for one in NAMES:
        for other in NAMES:
            if one != other:
                assert np.abs(results[one] - results[other]).max() > 1e-4


def test_muscle_swells_on_the_inside_of_the_bend():
    rig = limb(bone_count=2, rings=65, sides=24)
    muscle = [turgor.presets.muscle(1)]
    frame = rig.body(joints=muscle).deform(rig.bent(1.2))
    length = np.linalg.norm(frame.offsets, axis=1)
    # The chain bends about +z, towards +y: the inside of the elbow is where y > 0 at rest.
    is_inside = rig.surface.positions[:, 1] > 0.1
    is_outside = rig.surface.positions[:, 1] < -0.1
    assert length[is_inside].sum() > 3.0 * length[is_outside].sum()
