"""Saved settings of joints -> the engine's joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
import turgor
from numpy.typing import NDArray
from turgor import presets

Preset = presets.PresetName | Literal["custom"]

# Along the bone, sideways, inside; see `turgor.presets`.
Tables = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def engine_joint(
    bone: int,
    preset: Preset,
    strength: float,
    size: float,
    shares: NDArray[np.float32] | None,
    tables: Tables | None,
) -> turgor.Joint:
    """One joint; shares None: those of the preset. tables: curves of the Custom preset, None: the isotropic bell."""
    parts = None if shares is None else normalised_shares(shares)
    if preset == "custom":
        return turgor.Joint(bone, "auto" if parts is None else parts, tables, strength=strength, size=size)
    return presets.joint(preset, bone, shares=parts, strength=strength, size=size)


def normalised_shares(shares: NDArray[np.float32]) -> presets.Shares:
    """Parts that sum to one; "auto" when all are zero."""
    total = float(shares.sum())
    if total <= 0.0:
        return "auto"
    along, sideways, inside = (float(share) / total for share in shares)
    return along, sideways, inside


def engine_joints(
    bones: Sequence[int | None],
    preset_names: Sequence[Preset],
    strengths: NDArray[np.float32],
    sizes: NDArray[np.float32],
    use_auto_shares: NDArray[np.bool_],
    shares: NDArray[np.float32],
    tables: Mapping[int, Tables],
) -> list[turgor.Joint]:
    """(J,) settings in saved order; bones None: the bone is not in the rig. tables: by place in that order."""
    return [
        engine_joint(
            bone,
            preset_names[place],
            float(strengths[place]),
            float(sizes[place]),
            None if use_auto_shares[place] else shares[place],
            tables.get(place),
        )
        for place, bone in enumerate(bones)
        if bone is not None
    ]


def preset_tables(preset: presets.PresetName) -> Tables:
    """The curves that Custom starts from."""
    return presets.profiles(preset)
