"""Settings of one joint; `name` is the bone's name."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, PointerProperty

from .profiles import ProfileHooks, ProfileSet, TurgorProfiles
from .tagging import OVERRIDABLE, tag

# Append only: files store the position.
BLENDS = (
    ("NONE", "None", "One set of profile curves"),
    ("VALUE", "Value", "From the first set to the second by a value, which can be animated"),
    ("LOSS", "Volume Lost", "From the first set to the second as the joint loses volume: a bulge turns into folds"),
)
# By the number that Blender stores.
BLEND_NAMES = tuple(name for name, *_ in BLENDS)

# All of a joint but its sets of profiles, and whether it is heard or edited: what is copied, mirrored and shared.
SETTINGS = (
    "strength",
    "size",
    "flex",
    "blend_mode",
    "blend",
    "fold_loss",
    "flesh",
    "use_auto_outside",
    "outside",
    "spread_twist",
    "crease",
)

SETS = (
    ("FIRST", "First", "Show the first set of profile curves"),
    ("SECOND", "Second", "Show the second set of profile curves"),
)


def _show(joint: "TurgorJoint", context: bpy.types.Context) -> None:
    tag(joint, context)
    ProfileHooks.on_shown(joint.shown)


def _factor(name: str, description: str, default: float) -> object:
    return FloatProperty(
        name=name,
        description=description,
        default=default,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=tag,
        override=OVERRIDABLE,
    )


class TurgorJoint(ProfileSet, bpy.types.PropertyGroup):
    """How one joint gives volume back."""

    strength: FloatProperty(
        name="Strength",
        description="Part of the volume lost at this joint that it gives back itself",
        default=1.0,
        min=0.0,
        soft_max=1.0,
        max=10.0,
        subtype="FACTOR",
        update=tag,
        override=OVERRIDABLE,
    )
    size: FloatProperty(
        name="Size",
        description="Length of skin that takes part, as a factor on the automatic length",
        default=1.0,
        min=0.05,
        soft_max=3.0,
        max=20.0,
        update=tag,
        override=OVERRIDABLE,
    )
    flex: FloatProperty(
        name="Flex",
        description="Bulge beyond what was lost, as a muscle that is tensed, taken from the same limb",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        max=10.0,
        update=tag,
        override=OVERRIDABLE,
    )
    flesh: _factor(
        "Flesh",
        "How far this joint follows the flesh of the character: twists turn the skin along the bone, a bend"
        " shifts it to its inside",
        default=1.0,
    )
    use_auto_outside: BoolProperty(
        name="Auto",
        description="Bony or soft by how near the joint lies to the skin on the outside of its bends",
        default=True,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    outside: _factor(
        "Soft",
        "The outside of a bend: 0 where bone lies under the skin, an elbow, 1 where flesh is soft",
        default=1.0,
    )
    spread_twist: _factor(
        "Spread Twist",
        "How far a twist is spread along the whole bone, as in a forearm. 0: it stays where weights blend",
        default=1.0,
    )
    crease: _factor(
        "Crease",
        "How far the inside of a bend closes on the plane that halves it instead of passing through itself",
        default=0.7,
    )
    mute: BoolProperty(
        name="Mute",
        description="Give nothing back at this joint",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    is_solo: BoolProperty(
        name="Solo",
        description="Only joints with this switch on give volume back",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    select: BoolProperty(
        name="Select",
        description="Edit this joint together with the other selected ones",
        override=OVERRIDABLE,
        options=set(),
    )
    blend_mode: EnumProperty(
        name="Blend",
        description="What leads from the first set of profile curves to the second",
        items=BLENDS,
        update=_show,
        override=OVERRIDABLE,
        options=set(),
    )
    blend: FloatProperty(
        name="Blend Value",
        description="Part of the second set of profile curves",
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=tag,
        override=OVERRIDABLE,
    )
    second: PointerProperty(type=TurgorProfiles, override=OVERRIDABLE)
    shown_set: EnumProperty(
        name="Set",
        description="Which set of profile curves is shown",
        items=SETS,
        update=_show,
        override=OVERRIDABLE,
        options=set(),
    )
    fold_loss: FloatProperty(
        name="Full at",
        description="Volume lost at which the second set is reached, as part of a tenth of the joint's length cubed",
        default=0.1,
        min=1e-4,
        soft_max=1.0,
        max=100.0,
        update=tag,
        override=OVERRIDABLE,
    )
    # Percent of the rest volume that the joint took at most over the measured motion; negative: never measured.
    peak_loss: FloatProperty(default=-1.0, override=OVERRIDABLE, options={"HIDDEN"})

    @property
    def shown(self) -> ProfileSet:
        """The set whose curves are shown."""
        return self.second if self.blend_mode != "NONE" and self.shown_set == "SECOND" else self

    def follow_preset(self) -> None:
        """Belly is a blend; another preset takes away what Belly brought, not what the artist chose."""
        if self.preset == "BELLY":
            self.blend_mode = "LOSS"
            self.second.preset = "BELLY_FOLDED"
        elif self.blend_mode == "LOSS" and self.second.preset == "BELLY_FOLDED":
            self.blend_mode = "NONE"
