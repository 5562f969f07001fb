"""Saved settings of joints -> the engine's joints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from . import profiles
from .profiles import Profiles


class FleshSettings(NamedTuple):
    """How one joint follows the law of flesh, each in 0..1; see `turgor.Joint`."""

    flesh: float
    outside: float | None  # None: by the joint's place
    spread_twist: float
    crease: float


class JointSettings(NamedTuple):
    """One joint as saved."""

    bone: int
    strength: float
    size: float
    flex: float
    first: Profiles
    second: Profiles | None  # None: no blend
    blend: float | None  # part of the second set; None: as the joint loses volume
    fold_loss: float
    flesh: FleshSettings


def engine_joint(joint: JointSettings) -> turgor.Joint:
    """A preset that is not blended has its own exact shape: the isotropic one has no curves."""
    first, second = joint.first, joint.second
    parts, tables = profiles.parts(first), profiles.tables(first)
    options = {}
    if second is None:
        if first.preset == "ISOTROPIC":
            tables = None
    elif joint.blend is None:
        options = {"folded_profiles": profiles.tables(second), "folded_loss_relative": as_written(joint.fold_loss)}
    else:
        tables = profiles.mixed_tables(tables, profiles.tables(second), joint.blend)
        parts = profiles.mixed_parts(parts, profiles.parts(second), joint.blend)
    shares = profiles.engine_shares(parts)
    return turgor.Joint(
        joint.bone,
        shares,
        tables,
        strength=joint.strength,
        size=joint.size,
        flex=joint.flex,
        **joint.flesh._asdict(),
        **options,
    )


def effective_strengths(
    strengths: NDArray[np.float32], is_muted: NDArray[np.bool_], is_solo: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """(J,) 0 for joints that are muted, or not solo where another is."""
    is_heard = ~is_muted & (is_solo if is_solo.any() else True)
    return np.where(is_heard, strengths, np.float32(0.0))


def as_written(value: float) -> float:
    """A saved float32 as the artist wrote it: 0.1 is the engine's 0.1 to the last bit."""
    return float(str(np.float32(value)))
