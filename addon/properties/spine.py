"""Saved settings of Turgor Spine: `Object.turgor_spine`, on the body."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .tagging import OVERRIDABLE, tag

# Version of the saved settings.
DATA_VERSION = 1

SOURCES = (
    ("BONES", "Bones", "A chain of bones: from its rest to its pose"),
    ("CURVE", "Curve", "A curve object: from where it was to where it is, or onto it"),
)
COURSES = (
    ("JOINTS", "Through Joints", "One smooth curve through the joints: tails, tentacles, fish"),
    ("BONES", "Along Bones", "Bones stay straight, each bend is spread around its joint: trunks, limbs"),
)
RESTS = (
    ("CURVE", "Curve at Rest", "The curve as it was when the body was bound: nothing moves until the curve does"),
    ("X", "X", "The body lies along its X axis and moves onto the curve"),
    ("Y", "Y", "The body lies along its Y axis and moves onto the curve"),
    ("Z", "Z", "The body lies along its Z axis and moves onto the curve"),
)
KINDS = (
    ("RADIAL", "Radial", "Flesh gives way evenly to all sides"),
    ("NORMAL", "Normal", "Flesh gives way towards the inside and the outside of the bend"),
    ("BINORMAL", "Binormal", "Flesh gives way sideways, across the bend"),
    ("BLEND", "Blend", "Some of each"),
)


def _is_armature(settings: bpy.types.PropertyGroup, ob: bpy.types.Object) -> bool:
    return ob.type == "ARMATURE"


def _is_curve(settings: bpy.types.PropertyGroup, ob: bpy.types.Object) -> bool:
    return ob.type == "CURVE"


class TurgorSpine(bpy.types.PropertyGroup):
    """The spine of a body, and how its flesh follows."""

    version: IntProperty(override=OVERRIDABLE, options={"HIDDEN"})
    source: EnumProperty(
        name="Spine",
        description="What the body bends along",
        items=SOURCES,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    rig: PointerProperty(
        name="Armature",
        description="Armature whose bones are the spine",
        type=bpy.types.Object,
        poll=_is_armature,
        update=tag,
        override=OVERRIDABLE,
    )
    first_bone: StringProperty(
        name="From", description="First bone of the chain, nearest to the root", update=tag, override=OVERRIDABLE
    )
    last_bone: StringProperty(name="To", description="Last bone of the chain", update=tag, override=OVERRIDABLE)
    course: EnumProperty(
        name="Course",
        description="How the spine runs from joint to joint",
        items=COURSES,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    bend_width: FloatProperty(
        name="Bend Width",
        description="Part of each bone that takes part in the bends at its ends",
        default=0.7,
        min=0.1,
        max=0.95,
        subtype="FACTOR",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    use_roll: BoolProperty(
        name="Follow Roll",
        description="Bones that roll about their length twist the body",
        default=True,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    curve: PointerProperty(
        name="Curve",
        description="Curve object that is the spine; its first spline counts",
        type=bpy.types.Object,
        poll=_is_curve,
        update=tag,
        override=OVERRIDABLE,
    )
    rest: EnumProperty(
        name="Rest",
        description="Where the body lies before it is bent",
        items=RESTS,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    kind: EnumProperty(
        name="Flesh",
        description="Where flesh goes that the bend displaces",
        items=KINDS,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    blend: FloatVectorProperty(
        name="Blend",
        description="Parts of radial, normal and binormal flesh",
        size=3,
        default=(1.0, 0.0, 1.0),
        min=0.0,
        max=1.0,
        update=tag,
        override=OVERRIDABLE,
    )
    twist_start: FloatProperty(
        name="Twist Start",
        description="Angle about the spine at its start",
        subtype="ANGLE",
        update=tag,
        override=OVERRIDABLE,
    )
    twist: FloatProperty(
        name="Twist End",
        description="Angle about the spine at its end; it grows smoothly from one to the other",
        subtype="ANGLE",
        update=tag,
        override=OVERRIDABLE,
    )
    slide: FloatProperty(
        name="Slide",
        description="Length by which the body glides along the spine; animate it to swim along a path",
        subtype="DISTANCE",
        update=tag,
        override=OVERRIDABLE,
    )
    stretch: BoolProperty(
        name="Thin When Stretched",
        description="Where the spine grows longer the body grows thinner and keeps its volume",
        default=True,
        update=tag,
        override=OVERRIDABLE,
    )
    keep_volume: BoolProperty(
        name="Exact Volume",
        description="Remove what the mesh's own coarseness leaves, evenly from the whole skin: the total is exact",
        default=True,
        update=tag,
        override=OVERRIDABLE,
    )
    start: FloatProperty(
        name="Start",
        description="Part of the spine's length before which the body is carried rigidly",
        default=0.0,
        min=0.0,
        max=0.95,
        subtype="FACTOR",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    end: FloatProperty(
        name="End",
        description="Part of the spine's length after which the body is carried rigidly",
        default=1.0,
        min=0.05,
        max=1.0,
        subtype="FACTOR",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    vertex_group: StringProperty(
        name="Vertex Group",
        description="Which vertices follow the spine, and by how much",
        update=tag,
        override=OVERRIDABLE,
    )
    invert_vertex_group: BoolProperty(
        name="Invert",
        description="Vertices outside of the group follow",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    show_overlay: BoolProperty(
        name="Show Spine",
        description="Draw the spine at rest and posed, its frames, the tube within which every chunk keeps its volume,"
        " and the vertices outside of it",
        override=OVERRIDABLE,
        options=set(),
    )
    # The body as it was bound, as in `character.TurgorObject`: the matrix is object_from_spine; the curve at rest, and
    # the object, armature or curve, whose rest it is.
    bound_frame: IntProperty(override=OVERRIDABLE, options={"HIDDEN"})
    bound_topology: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    bound_placement: FloatVectorProperty(size=16, default=(0.0,) * 16, override=OVERRIDABLE, options={"HIDDEN"})
    bound_curve: PointerProperty(type=bpy.types.Curve, override=OVERRIDABLE)
    bound_to: PointerProperty(type=bpy.types.Object, override=OVERRIDABLE, options={"HIDDEN"})
