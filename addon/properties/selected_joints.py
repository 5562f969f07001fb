"""Settings of several joints as if they were one's: `Object.turgor.several`, for panels only.

Reading gives those of the active joint, writing changes the active and all selected ones. A script that sets one joint
changes no other: there is nothing here that is saved, keyed or overridden.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy

from .joint import TurgorJoint
from .profiles import ProfileSet

_DECLARED = ProfileSet.__annotations__ | TurgorJoint.__annotations__
NAMES = (
    "preset",
    "strength",
    "size",
    "flex",
    "flesh",
    "use_auto_outside",
    "outside",
    "spread_twist",
    "crease",
    "use_auto_shares",
    "shares",
    "blend_mode",
    "blend",
    "fold_loss",
)
# What declares a setting but not its look.
_OF_STORAGE = frozenset({"update", "override", "options", "get", "set"})


def edited_joints(saved: bpy.types.PropertyGroup) -> list[TurgorJoint]:
    """The active joint first, then the selected ones. saved: `Object.turgor`."""
    active = saved.active_joint
    places = [active] if 0 <= active < len(saved.joints) else []
    places += [place for place, joint in enumerate(saved.joints) if joint.select and place != active]
    return [saved.joints[place] for place in places]


class TurgorSelectedJoints(bpy.types.PropertyGroup):
    """The active joint and all selected ones."""

    __annotations__: dict[str, Any]


def _proxy(name: str) -> Any:
    declared = _DECLARED[name]
    look = {key: value for key, value in declared.keywords.items() if key not in _OF_STORAGE}
    get, set_all = _enum_access(name) if "items" in look else _access(name)
    return declared.function(**look, get=get, set=set_all, options=set())


def _access(name: str) -> tuple[Callable[[TurgorSelectedJoints], Any], Callable[[TurgorSelectedJoints, Any], None]]:
    def get(several: TurgorSelectedJoints) -> Any:
        joints = edited_joints(several.id_data.turgor)
        return getattr(joints[0], name) if joints else _DECLARED[name].keywords.get("default", 0.0)

    def set_all(several: TurgorSelectedJoints, value: Any) -> None:
        for joint in edited_joints(several.id_data.turgor):
            setattr(joint, name, value)

    return get, set_all


def _enum_access(
    name: str,
) -> tuple[Callable[[TurgorSelectedJoints], int], Callable[[TurgorSelectedJoints, int], None]]:
    """Enumerations are read and written by number."""

    def items() -> Any:
        return TurgorJoint.bl_rna.properties[name].enum_items

    def get(several: TurgorSelectedJoints) -> int:
        joints = edited_joints(several.id_data.turgor)
        return items()[getattr(joints[0], name)].value if joints else 0

    def set_all(several: TurgorSelectedJoints, value: int) -> None:
        chosen = next(item.identifier for item in items() if item.value == value)
        for joint in edited_joints(several.id_data.turgor):
            setattr(joint, name, chosen)

    return get, set_all


TurgorSelectedJoints.__annotations__ = {name: _proxy(name) for name in NAMES}
