"""Saved settings become the engine's joints."""

from __future__ import annotations

import numpy as np
import pytest

from addon.logic.joints import Preset, engine_joints, normalised_shares, preset_tables

PRESETS: list[Preset] = ["isotropic", "rubber", "muscle", "folds", "belly", "custom"]


def test_shares_sum_to_one():
    shares = normalised_shares(np.array([1.0, 1.0, 2.0], np.float32))
    assert shares == pytest.approx((0.25, 0.25, 0.5))


def test_no_shares_at_all_are_automatic():
    assert normalised_shares(np.zeros(3, np.float32)) == "auto"


def test_joints_of_missing_bones_are_left_out():
    bones = [0, None, 2, 3, 4, 5]
    ones, chosen = np.ones(6, np.float32), np.zeros(6, bool)
    shares = np.full((6, 3), 1 / 3, np.float32)
    made = engine_joints(bones, PRESETS, ones, 2 * ones, chosen, shares, {5: preset_tables("muscle")})
    assert [joint.bone for joint in made] == [0, 2, 3, 4, 5]
    assert {joint.size for joint in made} == {2.0}
    assert all(joint.shares == pytest.approx((1 / 3,) * 3) for joint in made)
