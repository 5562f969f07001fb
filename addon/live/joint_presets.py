"""Joints -> presets as text, and back. Main thread only."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from ..logic import joint_preset, profile_picture
from ..logic import profiles as presets
from ..logic.joint_preset import Curve, JointPreset, PresetError, Profiles
from ..messages import message
from ..properties.joint import SETTINGS, TurgorJoint
from ..properties.profiles import ProfileSet
from ..scene import curves


def text_of(joint: TurgorJoint) -> str:
    """All settings and curves of a joint."""
    settings = {name: getattr(joint, name) for name in SETTINGS}
    return joint_preset.to_text(JointPreset(**settings, first=_read(joint), second=_read(joint.second)))


def picture_of(joint: TurgorJoint) -> NDArray[np.float32]:
    """(n, n, 4) RGBA of its first set."""
    own = curves.nodes(joint, joint.id_data.turgor.curves) if joint.preset == "CUSTOM" else None
    tables = presets.preset_tables(joint.preset) if own is None else curves.sample(joint, joint.id_data.turgor.curves)
    return profile_picture.picture(tables)


def apply(text: str, joints: list[TurgorJoint]) -> None:
    """Give all joints what the text says. Raises PresetError, with no joint changed."""
    preset = joint_preset.from_text(text)
    _check_words(preset)
    for joint in joints:
        _write(joint, preset.first)
        _write(joint.second, preset.second)
        # After the presets: Belly brings a blend of its own.
        for name in SETTINGS:
            setattr(joint, name, getattr(preset, name))


def _read(profiles: ProfileSet) -> Profiles:
    found = curves.read_points(profiles) if profiles.preset == "CUSTOM" else []
    return Profiles(
        profiles.preset,
        profiles.curve_source,
        profiles.use_auto_shares,
        tuple(profiles.shares),
        tuple(Curve(is_symmetric, points) for is_symmetric, points in found),
    )


def _write(profiles: ProfileSet, given: Profiles) -> None:
    profiles.preset = given.preset
    profiles.curve_source = given.curve_source
    profiles.use_auto_shares = given.use_auto_shares
    profiles.shares_before = profiles.shares = given.shares
    if given.preset == "CUSTOM" and given.curves:
        profiles.is_symmetric = tuple(curve.is_symmetric for curve in given.curves)
        curves.write_points(profiles, given.curves)


def _check_words(preset: JointPreset) -> None:
    _check(TurgorJoint, "blend_mode", preset.blend_mode)
    for profiles in (preset.first, preset.second):
        _check(TurgorJoint, "preset", profiles.preset)
        _check(TurgorJoint, "curve_source", profiles.curve_source)
        handles = bpy.types.CurveMapPoint.bl_rna.properties["handle_type"].enum_items
        for curve in profiles.curves:
            for *_, handle in curve.points:
                if handle not in handles:
                    raise PresetError(message("The preset's {name} cannot be {found}", name="handle", found=handle))


def _check(owner: type, name: str, word: str) -> None:
    if word not in owner.bl_rna.properties[name].enum_items:
        raise PresetError(message("The preset's {name} cannot be {found}", name=name, found=word))
