"""The engine of a character under the settings of a frame.

Blender evaluates copies of objects, and makes a copy anew whenever anything of its object was edited. What was read
from a copy is marked in the copy itself, by a number: while the number is there, the settings are those. Keyframes and
drivers write into a copy that stays: where they may move settings, it is not marked and is read on every frame.
"""

from __future__ import annotations

from contextlib import suppress
from itertools import count

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from ..logic import joints
from ..logic.profiles import Profiles, Tables
from ..properties.joint import BLEND_NAMES
from ..properties.profiles import PRESET_NAMES
from ..scene import frame, settings
from ..states import SettledEngine, VolumeBinding, VolumeState
from . import joint_names, twins

_marks = count(1)


def settled(target: bpy.types.Object, character: VolumeState, bound: VolumeBinding) -> SettledEngine:
    """Read the settings of the evaluated `target` and make its engine, or return those of the last frame if unchanged.

    Raises frame.FrameError where nothing poses it, and twin.StepError where it is not as it was bound.
    """
    last = character.settled
    if last is not None and last.mark == target.turgor.settled and last.bound is bound:
        return last
    twins.check(target, character, bound)
    armature = frame.armature_place(target)
    saved = settings.read_settings(target)
    engine, strengths = engine_of(target, saved, bound)
    made = SettledEngine(next(_marks), bound, saved, engine, strengths, armature)
    # A copy has room for the mark where its object has, written when it was bound: none is made here.
    if not settings.may_move(target) and target.turgor.is_property_set("settled"):
        # Nothing can be written while Blender draws.
        with suppress(AttributeError):
            target.turgor.settled = made.mark
            character.settled = made
    return made


def engine_of(
    target: bpy.types.Object, saved: settings.BodySettings, bound: VolumeBinding
) -> tuple[turgor.VolumeSkin, NDArray[np.float64]]:
    """The engine under these settings, the same object while they are equal, and (J,) strengths of the joints."""
    return bound.body.with_settings(
        settings_key(saved, bound),
        lambda: _joints(target, saved, bound),
        saved.solver.lower(),
        saved.fields.lower(),
        saved.keep_bone_scale,
    )


def settings_key(saved: settings.BodySettings, bound: VolumeBinding) -> object:
    """A key that is equal while these settings ask for the same engine."""
    arrays = tuple(array.tobytes() for array in saved.joints)
    return arrays, saved.seconds, saved.solver, saved.fields, saved.flesh, saved.keep_bone_scale, bound.curves.stamps


def _joints(target: bpy.types.Object, saved: settings.BodySettings, bound: VolumeBinding) -> list[turgor.Joint]:
    rows = joint_names.rows_of(bound.bones, bound.body.joint_bones)
    arrays, tables = saved.joints, bound.curves.tables
    strengths = joints.effective_strengths(arrays.strengths, arrays.is_muted, arrays.is_solo)
    flexes = joints.effective_strengths(arrays.flexes, arrays.is_muted, arrays.is_solo)
    flesh = saved.flesh * arrays.flesh
    found = []
    for place, name in enumerate(settings.joint_names(target)):
        if name not in rows:
            continue
        first = Profiles(
            PRESET_NAMES[arrays.presets[place]],
            PRESET_NAMES[arrays.curve_sources[place]],
            None if arrays.use_auto_shares[place] else tuple(arrays.shares[place].tolist()),
            tables.get((place, False)),
        )
        second = saved.seconds.get(place)
        by_value = BLEND_NAMES[arrays.blend_modes[place]] == "VALUE"
        joint = joints.JointSettings(
            rows[name][0],
            float(strengths[place]),
            float(arrays.sizes[place]),
            float(flexes[place]),
            first,
            None if second is None else _second(second, tables.get((place, True))),
            float(arrays.blends[place]) if by_value else None,
            float(arrays.fold_losses[place]),
            joints.FleshSettings(
                float(flesh[place]),
                None if arrays.use_auto_outside[place] else float(arrays.outside[place]),
                float(arrays.spread_twists[place]),
                float(arrays.creases[place]),
            ),
        )
        found += [joints.engine_joint(joint._replace(bone=row)) for row in rows[name]]
    return found


def _second(saved: settings.SecondSet, tables: Tables | None) -> Profiles:
    shares = None if saved.use_auto_shares else saved.shares
    return Profiles(saved.preset, saved.curve_source, shares, tables)
