"""Saved settings: `Object.turgor` of characters and carriers, `Object.turgor_spine` of fleshed bodies, and of bones."""

import bpy
from bpy.props import PointerProperty

from . import bone
from .bake import TurgorBake
from .carrier import TurgorCarrier
from .character import TurgorObject
from .display import TurgorDisplay
from .joint import TurgorJoint
from .preferences import TurgorPreferences
from .profiles import TurgorProfiles
from .refine import TurgorRefine
from .several import TurgorSeveral
from .spine import TurgorSpine
from .tagging import OVERRIDABLE

# Those that others point to come first.
CLASSES = (
    TurgorCarrier,
    TurgorProfiles,
    TurgorJoint,
    TurgorSeveral,
    TurgorDisplay,
    TurgorRefine,
    TurgorObject,
    TurgorSpine,
    TurgorBake,
    TurgorPreferences,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.turgor = PointerProperty(type=TurgorObject, override=OVERRIDABLE)
    bpy.types.Object.turgor_spine = PointerProperty(type=TurgorSpine, override=OVERRIDABLE)
    bpy.types.Object.turgor_bake = PointerProperty(type=TurgorBake, override=OVERRIDABLE)
    bone.register()


def unregister() -> None:
    bone.unregister()
    del bpy.types.Object.turgor_bake
    del bpy.types.Object.turgor_spine
    del bpy.types.Object.turgor
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
