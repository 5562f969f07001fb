"""The settings that an object carries, by their types: Blender's stubs do not know what we add to `Object`."""

from __future__ import annotations

import bpy

from .bake import TurgorBake
from .character import TurgorObject
from .spine import TurgorSpine


def volume_settings(ob: bpy.types.Object) -> TurgorObject:
    """Settings of Turgor Volume, `Object.turgor`; their version is 0 where the object has none."""
    return ob.turgor


def spine_settings(ob: bpy.types.Object) -> TurgorSpine:
    """Settings of Turgor Spine, `Object.turgor_spine`; their version is 0 where the object has none."""
    return ob.turgor_spine


def bake_settings(ob: bpy.types.Object) -> TurgorBake:
    """Settings of the bake of an object, and what its last bake came to: `Object.turgor_bake`."""
    return ob.turgor_bake
