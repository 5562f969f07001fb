"""Saved settings: everything under one pointer, `Object.turgor`, on the character and on its carrier."""

from collections.abc import Callable
from typing import ClassVar

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

OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}

# Version of the saved settings; `migrations` brings older files up to it.
DATA_VERSION = 1

# Files store the position in these lists, and `scene.settings` reads it: append only.
PRESETS = (
    ("ISOTROPIC", "Isotropic", "Even swelling around the joint, by the least displacement"),
    ("RUBBER", "Rubber", "Bulges sideways, along the axis of the bend"),
    ("MUSCLE", "Muscle", "Swells on the parent's side, inside the bend: a biceps"),
    ("FOLDS", "Folds", "Wrinkles across the parent bone"),
    ("BELLY", "Belly", "One bulge inside the bend, folds as it closes"),
    ("CUSTOM", "Custom", "Profile curves of your own, starting from the preset chosen before"),
)
SOLVERS = (
    ("SIMULTANEOUS", "Simultaneous", "All joints at once: the order of bones never matters"),
    ("SEQUENTIAL", "Sequential", "Joint after joint, parents first"),
)
ROUTES = (
    ("AUTOMATIC", "Automatic", "Pull where a self-test proves that it works, else push"),
    ("PULL", "Pull", "Blender's dependency graph asks for the correction: one evaluation per frame"),
    ("PUSH", "Push", "Frame handlers write the correction: two evaluations per frame"),
)


def ignore_tick(carrier: "TurgorCarrier") -> None:
    """What a tick does while no route is registered."""


class TurgorCarrier(bpy.types.PropertyGroup):
    """On the carrier only: the hidden object that holds the offset of every vertex."""

    # Called with the evaluated group whenever the dependency graph reads `tick`, perhaps on a worker thread.
    # It must not raise, and must not call anything that tags data.
    on_tick: ClassVar[Callable[["TurgorCarrier"], None]] = staticmethod(ignore_tick)

    def _tick(self) -> float:
        TurgorCarrier.on_tick(self)
        return 0.0

    tick: FloatProperty(get=_tick, override=OVERRIDABLE, options={"HIDDEN"})
    kind: EnumProperty(
        items=(("VOLUME", "Turgor Volume", ""), ("SPINE", "Turgor Spine", "")),
        override=OVERRIDABLE,
        options={"HIDDEN"},
    )
    mesh: PointerProperty(type=bpy.types.Mesh, override=OVERRIDABLE)
    target: PointerProperty(type=bpy.types.Object, override=OVERRIDABLE)


def _tag(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """What a script sets without this is not seen until something else changes."""
    settings.id_data.update_tag()


def _remember_source(joint: "TurgorJoint", context: bpy.types.Context) -> None:
    _tag(joint, context)
    if joint.preset != "CUSTOM":
        joint.curve_source = joint.preset


class TurgorJoint(bpy.types.PropertyGroup):
    """How one joint gives volume back; `name` is the bone's name."""

    preset: EnumProperty(
        name="Preset",
        description="Where and in which shape the volume comes back",
        items=PRESETS,
        update=_remember_source,
        override=OVERRIDABLE,
        options=set(),
    )
    curve_source: EnumProperty(items=PRESETS[:-1], override=OVERRIDABLE, options={"HIDDEN"})
    strength: FloatProperty(
        name="Strength",
        description="Part of the volume lost at this joint that it gives back itself",
        default=1.0,
        min=0.0,
        soft_max=1.0,
        max=10.0,
        subtype="FACTOR",
        update=_tag,
        override=OVERRIDABLE,
    )
    size: FloatProperty(
        name="Size",
        description="Length of skin that takes part, as a factor on the automatic length",
        default=1.0,
        min=0.05,
        soft_max=3.0,
        max=20.0,
        update=_tag,
        override=OVERRIDABLE,
    )
    use_auto_shares: BoolProperty(
        name="Automatic Direction",
        description="Let the preset choose in which direction the skin swells",
        default=True,
        update=_tag,
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
        update=_tag,
        override=OVERRIDABLE,
    )
    # Names of the Float Curve nodes in `TurgorObject.curves`, empty until the preset was Custom once.
    curve_along: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    curve_sideways: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    curve_inside: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})


class TurgorObject(bpy.types.PropertyGroup):
    """Settings of a character's mesh."""

    version: IntProperty(override=OVERRIDABLE, options={"HIDDEN"})
    joints: CollectionProperty(type=TurgorJoint, override=OVERRIDABLE | {"USE_INSERTION"})
    active_joint: IntProperty(name="Active Joint", options={"HIDDEN"})
    solver: EnumProperty(
        name="Solver",
        description="How the joints share the work",
        items=SOLVERS,
        update=_tag,
        override=OVERRIDABLE,
        options=set(),
    )
    keep_bone_scale: BoolProperty(
        name="Follow Bone Scale",
        description="Scaled or stretched bones change the volume to be kept. Off: the rest volume whatever they do",
        default=True,
        update=_tag,
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
        update=_tag,
        override=OVERRIDABLE,
    )
    # The mesh as it was bound: frame at which modifiers before the Armature were read, its topology, and the matrix
    # object_from_armature by rows, all zero when there is none yet.
    bound_frame: IntProperty(override=OVERRIDABLE, options={"HIDDEN"})
    bound_topology: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
    bound_placement: FloatVectorProperty(size=16, default=(0.0,) * 16, override=OVERRIDABLE, options={"HIDDEN"})
    curves: PointerProperty(type=bpy.types.ShaderNodeTree, override=OVERRIDABLE)
    carrier: PointerProperty(type=TurgorCarrier, override=OVERRIDABLE)


class TurgorPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__ or "turgor"

    route: EnumProperty(
        name="Route",
        description="How the correction reaches the mesh",
        items=ROUTES,
    )

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop(self, "route")


def register() -> None:
    bpy.types.Object.turgor = PointerProperty(type=TurgorObject, override=OVERRIDABLE)


def unregister() -> None:
    del bpy.types.Object.turgor
