"""Saved settings: `Object.turgor` of characters and carriers, `Object.turgor_spine` of fleshed bodies, and of bones."""

import bpy
from bpy.props import PointerProperty

from .bake import TurgorBake
from .carrier import TurgorCarrier
from .character import TurgorObject
from .display import TurgorDisplay
from .joint import TurgorJoint
from .preferences import TurgorPreferences
from .profiles import TurgorProfiles
from .refine import TurgorRefine
from .selected_joints import TurgorSelectedJoints
from .spine import TurgorSpine
from .tagging import OVERRIDABLE

# Those that others point to come first.
CLASSES = (
    TurgorCarrier,
    TurgorProfiles,
    TurgorJoint,
    TurgorSelectedJoints,
    TurgorDisplay,
    TurgorRefine,
    TurgorObject,
    TurgorSpine,
    TurgorBake,
    TurgorPreferences,
)


def register() -> None:
    bpy.types.Object.turgor = PointerProperty(type=TurgorObject, override=OVERRIDABLE)
    bpy.types.Object.turgor_spine = PointerProperty(type=TurgorSpine, override=OVERRIDABLE)
    bpy.types.Object.turgor_bake = PointerProperty(type=TurgorBake, override=OVERRIDABLE)


def unregister() -> None:
    del bpy.types.Object.turgor_bake
    del bpy.types.Object.turgor_spine
    del bpy.types.Object.turgor
