"""What a set of profile curves gives the engine: tables and directions of presets, own ones, and mixtures of two."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray
from turgor import presets

Table = NDArray[np.float64]

# Along the bone, sideways, inside; see `turgor.presets`.
Tables = tuple[Table, Table, Table]
# Along the bone, sideways, inside, and by the least displacement.
Parts = tuple[float, float, float, float]
# Place of a joint in the list, and whether it is its second set.
Place = tuple[int, bool]

AUTOMATIC: Parts = (0.0, 0.0, 0.0, 1.0)


class Profiles(NamedTuple):
    """One set as saved, presets by their saved names."""

    preset: str
    source: str  # the preset that Custom came from
    shares: tuple[float, float, float] | None  # None: those of the preset
    tables: Tables | None  # of Custom; None: not drawn yet


class Curves(NamedTuple):
    """Sampled curves of a character's Custom sets that count."""

    tables: dict[Place, Tables]
    stamps: dict[Place, str]  # changes with the table


def preset_tables(preset: str) -> Tables:
    """The curves of a preset."""
    folding = _FOLDED.get(preset)
    return presets.profiles(_NAMES[preset]) if folding is None else folding


def tables(profiles: Profiles) -> Tables:
    """The set's curves: a preset's own, unedited."""
    if profiles.preset != "CUSTOM":
        return preset_tables(profiles.preset)
    return preset_tables(profiles.source) if profiles.tables is None else profiles.tables


def parts(profiles: Profiles) -> Parts:
    """Where the set gives volume back; they sum to one. Shares that are all zero stand for the least displacement."""
    if profiles.shares is None:
        source = profiles.source if profiles.preset == "CUSTOM" else profiles.preset
        shares = DIRECTED_SHARES.get(source)
        return AUTOMATIC if shares is None else (*shares, 0.0)
    total = sum(profiles.shares)
    if total <= 0.0:
        return AUTOMATIC
    along, sideways, inside = (share / total for share in profiles.shares)
    return along, sideways, inside, 0.0


def mixed_tables(first: Tables, second: Tables, part: float) -> Tables:
    """`part` of the second set, the rest of the first."""
    along, sideways, inside = ((1.0 - part) * a + part * b for a, b in zip(first, second, strict=True))
    return along, sideways, inside


def mixed_parts(first: Parts, second: Parts, part: float) -> Parts:
    """`part` of the second set, the rest of the first."""
    along, sideways, inside, automatic = ((1.0 - part) * a + part * b for a, b in zip(first, second, strict=True))
    return along, sideways, inside, automatic


def engine_shares(parts: Parts) -> turgor.presets.Shares:
    """The parts of all directions as `turgor.Joint` takes its shares."""
    if parts == AUTOMATIC:
        return "auto"
    return parts if parts[3] > 0.0 else parts[:3]


_NAMES: dict[str, presets.PresetName] = {name.upper(): name for name in presets.DEFAULT_SHARES}

_FOLDED = {"BELLY_FOLDED": presets.folded_profiles("belly")}


def _directed_shares() -> dict[str, tuple[float, float, float]]:
    found: dict[str, tuple[float, float, float]] = {}
    names: dict[str, presets.PresetName] = {**_NAMES, "BELLY_FOLDED": "belly"}
    for saved, name in names.items():
        shares = presets.DEFAULT_SHARES[name]
        if shares != "auto":
            found[saved] = shares
    return found


# Shares of the presets that have directions; the others give back by the least displacement.
DIRECTED_SHARES = _directed_shares()
