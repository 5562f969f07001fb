"""Saved settings become the engine's joints."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.logic.joints import FleshSettings, JointSettings, as_written, effective_strengths, engine_joint
from addon.logic.profiles import (
    AUTOMATIC,
    DIRECTED_SHARES,
    Profiles,
    engine_shares,
    mixed_parts,
    mixed_tables,
    parts,
    preset_tables,
    tables,
)

PRESETS = ("ISOTROPIC", "RUBBER", "MUSCLE", "FOLDS", "BELLY", "BELLY_FOLDED", "FLESH")
unit = st.floats(0.0, 1.0)


def _set(preset: str, shares: tuple[float, float, float] | None = None) -> Profiles:
    return Profiles(preset, preset, shares, None)


@given(st.tuples(unit, unit, unit))
def test_parts_sum_to_one(shares):
    assert sum(parts(_set("MUSCLE", shares))) == pytest.approx(1.0)


def test_no_shares_at_all_are_automatic():
    assert parts(_set("MUSCLE", (0.0, 0.0, 0.0))) == AUTOMATIC


@pytest.mark.parametrize("preset", PRESETS)
def test_custom_starts_as_its_preset(preset):
    custom = Profiles("CUSTOM", preset, None, None)
    assert parts(custom) == parts(_set(preset))
    assert all((own == given).all() for own, given in zip(tables(custom), preset_tables(preset), strict=True))


@pytest.mark.parametrize("first", PRESETS)
@pytest.mark.parametrize("second", PRESETS)
def test_mixtures_begin_and_end_with_their_sets(first, second):
    ends = [_set(first), _set(second)]
    for part, end in zip((0.0, 1.0), ends, strict=True):
        mixture = mixed_tables(tables(ends[0]), tables(ends[1]), part)
        assert all((mixed == own).all() for mixed, own in zip(mixture, tables(end), strict=True))
        assert mixed_parts(parts(ends[0]), parts(ends[1]), part) == parts(end)


@given(unit, unit)
def test_mixtures_are_as_near_as_their_parts(one, other):
    ends = parts(_set("ISOTROPIC")), parts(_set("MUSCLE"))
    difference = np.subtract(mixed_parts(*ends, one), mixed_parts(*ends, other))
    assert np.abs(difference).max() <= abs(one - other) + 1e-12


def test_shares_of_the_engine():
    assert engine_shares(AUTOMATIC) == "auto"
    assert engine_shares((0.2, 0.3, 0.5, 0.0)) == (0.2, 0.3, 0.5)


def test_a_preset_alone_has_its_own_shape():
    joint = engine_joint(
        JointSettings(3, 0.5, 2.0, 0.0, _set("RUBBER"), None, None, 0.1, FleshSettings(0.5, None, 0.25, 1.0))
    )
    assert (joint.flesh, joint.outside, joint.spread_twist, joint.crease) == (0.5, None, 0.25, 1.0)
    assert (joint.bone, joint.strength, joint.size) == (3, 0.5, 2.0)
    assert joint.shares == DIRECTED_SHARES["RUBBER"]


@given(st.lists(st.tuples(unit, st.booleans(), st.booleans()), min_size=1, max_size=8))
def test_a_joint_is_heard_when_it_is_not_muted_and_solo_where_any_is(joints):
    strengths, is_muted, is_solo = (np.array(column) for column in zip(*joints, strict=True))
    heard = effective_strengths(strengths.astype(np.float32), is_muted, is_solo)
    any_solo = any(solo for _, _, solo in joints)
    for place, (strength, mute, solo) in enumerate(joints):
        assert heard[place] == (0.0 if mute or (any_solo and not solo) else np.float32(strength))


@given(st.floats(1e-4, 100.0))
def test_saved_numbers_are_read_as_they_were_written(value):
    written = float(f"{value:.4g}")
    assert as_written(float(np.float32(written))) == written
