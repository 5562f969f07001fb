"""One set of profile curves with its directions. A joint has one, and a second that it can blend into."""

import bpy
from bpy.props import BoolProperty, BoolVectorProperty, EnumProperty, FloatVectorProperty, StringProperty

from .tagging import OVERRIDABLE, tag

# Files store the position in these lists, and `scene.settings` reads it: append only.
PRESETS = (
    ("ISOTROPIC", "Isotropic", "Even swelling around the joint, by the least displacement"),
    ("RUBBER", "Rubber", "Bulges sideways, along the axis of the bend"),
    ("MUSCLE", "Muscle", "Swells on the parent's side, inside the bend: a biceps"),
    ("FOLDS", "Folds", "Wrinkles across the parent bone"),
    ("BELLY", "Belly", "One bulge inside the bend, folds as it closes"),
    ("CUSTOM", "Custom", "Profile curves of your own, starting from the preset chosen before"),
)


def _remember_source(profiles: "ProfileSet", context: bpy.types.Context) -> None:
    tag(profiles, context)
    if profiles.preset != "CUSTOM":
        profiles.curve_source = profiles.preset


class ProfileSet:
    """Where volume comes back and in which shape; not registered by itself."""

    preset: EnumProperty(
        name="Preset",
        description="Where and in which shape the volume comes back",
        items=PRESETS,
        update=_remember_source,
        override=OVERRIDABLE,
        options=set(),
    )
    curve_source: EnumProperty(items=PRESETS[:-1], override=OVERRIDABLE, options={"HIDDEN"})
    use_auto_shares: BoolProperty(
        name="Automatic Direction",
        description="Let the preset choose in which direction the skin swells",
        default=True,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    shares: FloatVectorProperty(
        name="Direction",
        description="Parts of the volume given back along the bone, sideways, and towards the inside of the bend",
        size=3,
        default=(1 / 3, 1 / 3, 1 / 3),
        min=0.0,
        max=1.0,
        update=tag,
        override=OVERRIDABLE,
    )
    is_symmetric: BoolVectorProperty(
        name="Symmetric",
        description="One curve for both sides of the joint, drawn from its middle outwards",
        size=3,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    # Names of the Float Curve nodes in `TurgorObject.curves`, empty until the curves were shown once.
    curve_along: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    curve_sideways: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    curve_inside: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})


class TurgorProfiles(ProfileSet, bpy.types.PropertyGroup):
    """The second set of a joint."""
