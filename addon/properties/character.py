"""Settings of a character's mesh: everything under one pointer, `Object.turgor`."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .carrier import TurgorCarrier
from .display import TurgorDisplay
from .joint import TurgorJoint
from .profiles import ProfileHooks
from .refine import TurgorRefine
from .selected_joints import TurgorSelectedJoints
from .tagging import OVERRIDABLE, tag

# Version of the saved settings; `migrations` brings older files up to it.
DATA_VERSION = 2

SOLVERS = (
    ("SIMULTANEOUS", "Simultaneous", "All joints at once: the order of bones never matters"),
    ("SEQUENTIAL", "Sequential", "Joint after joint, parents first"),
)


# Append only: files store the position, and files that store none were shaped by the first.
FIELDS = (
    (
        "PLAIN",
        "Plain",
        "Along the gradient of the volume: small hollows and tips are pushed their own way, each its own",
    ),
    ("EVEN", "Even", "Along smooth normals: fine detail is carried along, and profile curves act as they are drawn"),
)


def _show_joint(saved: "TurgorObject", context: bpy.types.Context) -> None:
    if 0 <= saved.active_joint < len(saved.joints):
        ProfileHooks.on_shown(saved.joints[saved.active_joint].shown)


class TurgorObject(bpy.types.PropertyGroup):
    """Settings of a character's mesh."""

    version: IntProperty(override=OVERRIDABLE, options={"HIDDEN"})
    joints: CollectionProperty(type=TurgorJoint, override=OVERRIDABLE | {"USE_INSERTION"})
    active_joint: IntProperty(name="Active Joint", update=_show_joint, options={"HIDDEN"})
    several: PointerProperty(type=TurgorSelectedJoints)
    solver: EnumProperty(
        name="Solver",
        description="How the joints share the work",
        items=SOLVERS,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    # 0 in files of before: they keep their shape.
    flesh: FloatProperty(
        name="Flesh",
        description="How far skin moves as flesh does before its volume is restored: twists turn it along the bone,"
        " bends shift it to their inside. 0: as the armature leaves it",
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=tag,
        override=OVERRIDABLE,
    )
    fields: EnumProperty(
        name="Fields",
        description="Which way the skin moves where volume comes back",
        items=FIELDS,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    keep_bone_scale: BoolProperty(
        name="Follow Bone Scale",
        description="Scaled or stretched bones change the volume to be kept. Off: the rest volume whatever they do",
        default=True,
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    repair_folds: BoolProperty(
        name="Repair Folds",
        description="Where the correction alone makes the skin pass through itself, it backs off, and the volume comes"
        " back elsewhere; takes longer on every frame",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    target_volume: FloatProperty(
        name="Volume",
        description="Factor on the volume to be kept; animate it for breathing",
        default=1.0,
        min=0.01,
        soft_min=0.5,
        soft_max=1.5,
        max=100.0,
        update=tag,
        override=OVERRIDABLE,
    )
    vertex_group: StringProperty(
        name="Vertex Group",
        description="Where volume may come back, by the weights of a vertex group; the total stays exact",
        update=tag,
        override=OVERRIDABLE,
    )
    invert_vertex_group: BoolProperty(
        name="Invert",
        description="Volume comes back outside of the group",
        update=tag,
        override=OVERRIDABLE,
        options=set(),
    )
    pin_group: StringProperty(
        name="Pin",
        description="Vertices of this group stay where skinning puts them",
        update=tag,
        override=OVERRIDABLE,
    )
    display: PointerProperty(type=TurgorDisplay, override=OVERRIDABLE)
    refine: PointerProperty(type=TurgorRefine)
    # The mesh as it was bound: frame at which modifiers before the Armature were read, its topology, and the matrix
    # object_from_armature by rows, all zero when there is none yet.
    bound_frame: IntProperty(override=OVERRIDABLE, options={"HIDDEN"})
    bound_topology: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    bound_placement: FloatVectorProperty(size=16, default=(0.0,) * 16, override=OVERRIDABLE, options={"HIDDEN"})
    # 0 but in evaluated copies: there the number of the settings that were read from it, see `live.engines`.
    settled: IntProperty(options={"HIDDEN"})
    # The same of what its twins were compared with, see `live.twins`.
    in_step: IntProperty(options={"HIDDEN"})
    curves: PointerProperty(type=bpy.types.ShaderNodeTree, override=OVERRIDABLE)
    carrier: PointerProperty(type=TurgorCarrier, override=OVERRIDABLE)

    @property
    def preset_of_new(self) -> str:
        """Of a joint that nobody has set: flesh, but a character of before keeps to what it began with."""
        return "FLESH" if self.fields == "EVEN" else "ISOTROPIC"
