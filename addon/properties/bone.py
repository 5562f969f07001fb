"""What a bone says of the skin that it holds: saved with the bone, mirrored and copied with it."""

import bpy
from bpy.props import FloatProperty

# Blender hands the value from one to the other on the way in and out of Edit Mode.
OWNERS = (bpy.types.Bone, bpy.types.EditBone)


def register() -> None:
    for owner in OWNERS:
        owner.turgor_stiffness = FloatProperty(
            name="Turgor Stiffness",
            description=(
                "How strongly the bone holds the skin when Turgor weights are made: at 2 as if it were at half its"
                " distance, at 0.5 as if at twice"
            ),
            default=1.0,
            min=0.01,
            max=100.0,
            soft_min=0.25,
            soft_max=4.0,
            step=5,
            precision=2,
            # Weights are made once: keys would move nothing.
            options=set(),
        )


def unregister() -> None:
    for owner in reversed(OWNERS):
        del owner.turgor_stiffness
