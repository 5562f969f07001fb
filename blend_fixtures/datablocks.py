"""Object data of a known kind."""

from __future__ import annotations

from typing import Any, TypeVar

import bpy

Kind = TypeVar("Kind")


def data_of(thing: bpy.types.Object, kind: type[Kind]) -> Kind:
    """The object's data, which must be of this kind."""
    return of_kind(thing.data, kind)


def of_kind(value: Any, kind: type[Kind]) -> Kind:
    """The value itself; `TypeError` if Blender handed out something else."""
    if not isinstance(value, kind):
        raise TypeError(f"need {kind.__name__}, got {type(value).__name__}")
    return value


def pose_of(armature: bpy.types.Object) -> bpy.types.Pose:
    """The armature object's pose."""
    return of_kind(armature.pose, bpy.types.Pose)
