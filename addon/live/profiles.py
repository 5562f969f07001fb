"""Profile curves of a character: shown for each preset, own once they are edited, sampled for the engine.

Main thread only. Curves are drawn when a joint is first shown; an unedited preset keeps the engine's exact tables.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..logic import profiles as presets
from ..logic.profiles import Curves, Place
from ..properties.joint import TurgorJoint
from ..properties.profiles import PRESET_NAMES, ProfileHooks, ProfileSet
from ..properties.shares import THIRDS
from ..scene import curves
from .binding_rules import is_editable

# Set by hand are shares that are none of these, within float32.
SHARE_TOLERANCE = 1e-5
_CUSTOM_NUMBER = next(number for number, name in PRESET_NAMES.items() if name == "CUSTOM")


NO_CURVES = Curves({}, {})


def read(target: bpy.types.Object, before: Curves = NO_CURVES) -> Curves:
    """The Custom curves as they are drawn now; what has not changed since `before` is taken from there."""
    saved = target.turgor
    found = Curves({}, {})
    for place, profiles in _custom_sets(saved.joints):
        if curves.nodes(profiles, saved.curves) is None:
            if not is_editable(target):
                found.tables[place] = presets.preset_tables(profiles.curve_source)
                found.stamps[place] = profiles.curve_source
                continue
            prepare(profiles)
        stamp = curves.digest(profiles, saved.curves)
        is_same = before.stamps.get(place) == stamp
        found.tables[place] = before.tables[place] if is_same else curves.sample(profiles, saved.curves)
        found.stamps[place] = stamp
    return found


def shown_set(target: bpy.types.Object) -> ProfileSet | None:
    """The set of the active joint whose curves the panel shows."""
    saved = target.turgor
    if not 0 <= saved.active_joint < len(saved.joints):
        return None
    return saved.joints[saved.active_joint].shown


def prepare(profiles: ProfileSet) -> None:
    """Have the set's curves, the artist's own excepted, show its preset."""
    target = profiles.id_data
    tree = target.turgor.curves
    has_curves = curves.nodes(profiles, tree) is not None
    if not is_editable(target) or (has_curves and profiles.preset == "CUSTOM"):
        return
    if not curves.shows(profiles, tree, profiles.preset):
        _draw(profiles)


def claim_edited(target: bpy.types.Object) -> None:
    """A preset whose shown curves the artist has changed is Custom from now on."""
    profiles, tree = shown_set(target), target.turgor.curves
    if profiles is None or profiles.preset == "CUSTOM" or not is_editable(target):
        return
    if curves.shows(profiles, tree, profiles.preset) and curves.is_edited(profiles, tree):
        profiles.preset = "CUSTOM"


def copy(source: ProfileSet, profiles: ProfileSet) -> None:
    """Make `profiles` what `source` is, perhaps of another character: preset, directions and curves."""
    profiles.preset = source.preset
    profiles.curve_source = source.curve_source
    profiles.use_auto_shares = source.use_auto_shares
    profiles.shares_before = profiles.shares = source.shares
    if profiles.preset == "CUSTOM":
        profiles.is_symmetric = source.is_symmetric
        curves.copy(source, profiles)


def register() -> None:
    ProfileHooks.on_preset = staticmethod(_follow_preset)
    ProfileHooks.on_shown = staticmethod(_prepare_shown)
    ProfileHooks.on_symmetry = staticmethod(_follow_symmetry)
    ProfileHooks.on_manual_shares = staticmethod(_offer_shares)


def unregister() -> None:
    for name in ("on_preset", "on_shown", "on_symmetry", "on_manual_shares"):
        setattr(ProfileHooks, name, staticmethod(ProfileHooks.ignore))


def _custom_sets(joints: bpy.types.bpy_prop_collection[TurgorJoint]) -> Iterator[tuple[Place, ProfileSet]]:
    if not len(joints):
        return
    numbers, blends = np.empty(len(joints), np.int32), np.empty(len(joints), np.int32)
    joints.foreach_get("preset", numbers)
    joints.foreach_get("blend_mode", blends)
    for place in np.flatnonzero(numbers == _CUSTOM_NUMBER):
        yield (int(place), False), joints[place]
    for place in np.flatnonzero(blends):
        if joints[place].second.preset == "CUSTOM":
            yield (int(place), True), joints[place].second


def _draw(profiles: ProfileSet) -> None:
    """Draw the preset, or what Custom starts from; sides that differ need a curve over both."""
    source = profiles.curve_source if profiles.preset == "CUSTOM" else profiles.preset
    tables = presets.preset_tables(source)
    fitting = tuple(flag and _is_symmetric(table) for flag, table in zip(profiles.is_symmetric, tables, strict=True))
    if fitting != tuple(profiles.is_symmetric):
        profiles.is_symmetric = fitting
    curves.write(profiles, curves.ensure_tree(profiles.id_data), tables, profiles.preset)


def _is_symmetric(table: presets.Table) -> bool:
    return bool(np.allclose(table, table[::-1], rtol=0.0, atol=1e-12))


def _prepare_shown(profiles: ProfileSet) -> None:
    if profiles == shown_set(profiles.id_data):
        prepare(profiles)


def _follow_preset(profiles: ProfileSet) -> None:
    target = profiles.id_data
    if not is_editable(target):
        return
    tree = target.turgor.curves
    has_curves = curves.nodes(profiles, tree) is not None
    if profiles.preset == "CUSTOM" and has_curves:
        curves.claim(profiles, tree)
    elif has_curves or profiles.preset == "CUSTOM" or profiles == shown_set(target):
        _draw(profiles)


def _follow_symmetry(profiles: ProfileSet) -> None:
    target = profiles.id_data
    if not is_editable(target):
        return
    flags, tree = tuple(profiles.is_symmetric), target.turgor.curves
    if profiles.preset != "CUSTOM":
        tables = presets.preset_tables(profiles.preset)
        if all(_is_symmetric(table) for flag, table in zip(flags, tables, strict=True) if flag):
            if curves.nodes(profiles, tree) is not None:
                curves.write(profiles, curves.ensure_tree(target), tables, profiles.preset)
            return
        curves.write(profiles, curves.ensure_tree(target), tables, "CUSTOM")
        profiles.preset = "CUSTOM"
        return
    prepare(profiles)
    tree = curves.ensure_tree(target)
    for node, table, flag in zip(curves.nodes(profiles, tree), curves.sample(profiles, tree), flags, strict=True):
        if curves.is_symmetric(node) != flag:
            curves.write_node(node, table, is_symmetric=flag, preset="CUSTOM")


def _offer_shares(profiles: ProfileSet) -> None:
    """Sliders that nobody has moved start from the preset's directions, so that the shape stays."""
    untouched = (THIRDS, *presets.DIRECTED_SHARES.values())
    offered = presets.DIRECTED_SHARES.get(profiles.curve_source)
    if offered is not None and any(np.allclose(profiles.shares, known, atol=SHARE_TOLERANCE) for known in untouched):
        profiles.shares_before = profiles.shares = offered
