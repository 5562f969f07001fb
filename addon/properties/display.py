"""What of a character is drawn over the viewport: `Object.turgor.display`."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from .tagging import OVERRIDABLE

HEATS = (
    ("NONE", "None", "No colors"),
    ("DISPLACEMENT", "Displacement", "How far Turgor moves each vertex"),
    ("WEIGHT", "Joint Weight", "How much each vertex takes part at the active joint: the product of its profiles"),
    ("STRAIN", "Local Volume", "Change of the flesh between the skin and its bone, against rest"),
)


class TurgorDisplay(bpy.types.PropertyGroup):
    """Drawn only where viewport overlays are on."""

    heat: EnumProperty(
        name="Heat Map",
        description="What colors on the skin show",
        items=HEATS,
        override=OVERRIDABLE,
        options=set(),
    )
    opacity: FloatProperty(
        name="Opacity",
        description="Opacity of the heat map",
        default=0.8,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        override=OVERRIDABLE,
        options=set(),
    )
    heat_range: FloatProperty(
        name="Range",
        description="Value with the hottest color, in units of length, or as a part of 1 for volume; 0 takes it"
        " from the frame",
        min=0.0,
        soft_max=1.0,
        override=OVERRIDABLE,
        options=set(),
    )
    show_axes: BoolProperty(
        name="Joint Axes",
        description="Draw the three directions of the active joint: along the parent, the hinge, inside the bend",
        override=OVERRIDABLE,
        options=set(),
    )
    show_readout: BoolProperty(
        name="Volume",
        description="Write the volume error of the frame into the viewport",
        override=OVERRIDABLE,
        options=set(),
    )
    show_joint_readout: BoolProperty(
        name="Joint Volumes",
        description="Write at each joint which volume skinning takes and Turgor gives back",
        override=OVERRIDABLE,
        options=set(),
    )
    show_graph: BoolProperty(
        name="Graph",
        description="Draw the volume over the measured frames, with Turgor and without",
        override=OVERRIDABLE,
        options=set(),
    )
