"""One set of profile curves with its directions. A joint has one, and a second that it can blend into."""

import bpy
from bpy.props import BoolProperty, BoolVectorProperty, EnumProperty, FloatVectorProperty, StringProperty

from .shares import THIRDS, balanced
from .tagging import OVERRIDABLE, tag

# Files store the number at the end, and `scene.settings` reads it: never change one.
PRESETS = (
    ("ISOTROPIC", "Isotropic", "Even swelling around the joint, by the least displacement", "NONE", 0),
    ("RUBBER", "Rubber", "Bulges sideways, along the axis of the bend", "NONE", 1),
    ("MUSCLE", "Muscle", "Swells on the parent's side, inside the bend: a biceps", "NONE", 2),
    ("FOLDS", "Folds", "Wrinkles across the parent bone", "NONE", 3),
    ("BELLY", "Belly", "One bulge inside the bend, folds as it closes", "NONE", 4),
    ("BELLY_FOLDED", "Belly Folded", "What Belly turns into: folds inside the bend", "NONE", 6),
    ("FLESH", "Flesh", "Across the limb, wide along it, to the inside of the bend: what flesh does", "NONE", 7),
    ("CUSTOM", "Custom", "Profile curves of your own, starting from the preset chosen before", "NONE", 5),
)
PRESET_NAMES = {number: name for name, *_, number in PRESETS}
PRESET_NUMBERS = {name: number for number, name in PRESET_NAMES.items()}


class ProfileHooks:
    """What follows an edit of a set; `live` puts its own here while the add-on runs."""

    @staticmethod
    def ignore(profiles: "ProfileSet") -> None:
        """Nothing follows, while the add-on does not run."""

    on_preset = on_shown = on_symmetry = on_manual_shares = ignore


def _choose_preset(profiles: "ProfileSet", context: bpy.types.Context) -> None:
    tag(profiles, context)
    if profiles.preset != "CUSTOM":
        profiles.curve_source = profiles.preset
        profiles.follow_preset()
    ProfileHooks.on_preset(profiles)


def _mirror(profiles: "ProfileSet", context: bpy.types.Context) -> None:
    tag(profiles, context)
    ProfileHooks.on_symmetry(profiles)


def _choose_direction(profiles: "ProfileSet", context: bpy.types.Context) -> None:
    tag(profiles, context)
    if not profiles.use_auto_shares:
        ProfileHooks.on_manual_shares(profiles)


def _balance(profiles: "ProfileSet", context: bpy.types.Context) -> None:
    tag(profiles, context)
    found = tuple(profiles.shares)
    parts = balanced(found, tuple(profiles.shares_before))
    profiles.shares_before = parts
    if parts != found:
        profiles.shares = parts


class ProfileSet:
    """Where volume comes back and in which shape; not registered by itself."""

    preset: EnumProperty(
        name="Preset",
        description="Where and in which shape the volume comes back",
        items=PRESETS,
        update=_choose_preset,
        override=OVERRIDABLE,
        options=set(),
    )
    # The preset that Custom came from, whose directions it keeps.
    curve_source: EnumProperty(items=PRESETS, override=OVERRIDABLE, options={"HIDDEN"})
    use_auto_shares: BoolProperty(
        name="Automatic Direction",
        description="Let the preset choose in which direction the skin swells",
        default=True,
        update=_choose_direction,
        override=OVERRIDABLE,
        options=set(),
    )
    shares: FloatVectorProperty(
        name="Direction",
        description="Parts of the volume given back along the bone, across, and towards the inside of the bend. "
        "Moving one scales the others, so that the sum stays one",
        size=3,
        default=THIRDS,
        min=0.0,
        max=1.0,
        update=_balance,
        override=OVERRIDABLE,
    )
    shares_before: FloatVectorProperty(size=3, default=THIRDS, override=OVERRIDABLE, options={"HIDDEN"})
    is_symmetric: BoolVectorProperty(
        name="Symmetric",
        description="One curve for both sides of the joint, drawn from its middle outwards",
        size=3,
        update=_mirror,
        override=OVERRIDABLE,
        options=set(),
    )
    # Names of the Float Curve nodes in `TurgorObject.curves`, empty until the curves were shown once.
    curve_along: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    curve_sideways: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    curve_inside: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})

    def follow_preset(self) -> None:
        """What else of a joint comes with its preset."""


class TurgorProfiles(ProfileSet, bpy.types.PropertyGroup):
    """The second set of a joint."""
