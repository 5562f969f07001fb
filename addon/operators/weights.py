"""Automatic weights: parent meshes to an armature with them, or give them to selected bones in Weight Paint."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, FloatProperty, IntProperty
from turgor import TurgorError

from .. import runtime
from ..live.automatic_weights import Job, Options, WeightError
from ..messages import message
from ..scene import weight_groups
from .modal import ModalOperator, Progress, Threaded


class _Weights(ModalOperator):
    """Settings, and a run beside the window: the engine works in a thread, the timer asks how far it is."""

    bl_options = {"REGISTER", "UNDO"}
    refusals = (WeightError, TurgorError)
    seconds_between_steps = 0.05
    cancelled = message("Cancelled, weights are as they were")

    resolution: IntProperty(
        name="Resolution",
        description=(
            "Voxels along the longest side of the body, 0 for as many as it needs; parts two voxels apart are apart"
        ),
        default=0,
        min=0,
        max=1024,
        soft_max=512,
    )
    falloff: FloatProperty(
        name="Falloff",
        description="How fast a bone's hold falls with distance",
        default=12.0,
        min=0.5,
        max=32.0,
        soft_max=24.0,
    )
    smoothing: FloatProperty(
        name="Smoothing",
        description="Length over which weights pass from bone to bone, in distances to the nearest bone",
        default=0.83,
        min=0.0,
        max=10.0,
        soft_max=2.0,
    )
    max_influences: IntProperty(
        name="Max Influences",
        description="Bones that may hold a vertex; 0 for any number",
        default=4,
        min=0,
        max=255,
        soft_max=16,
    )
    use_symmetry: BoolProperty(
        name="Symmetry",
        description="Vertices that mirror each other across the armature's X axis get mirrored weights",
        default=False,
    )
    keep_locked: BoolProperty(
        name="Keep Locked",
        description="Locked vertex groups keep their weights, the others share what is left",
        default=True,
    )

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        for name in ("resolution", "falloff", "smoothing", "max_influences", "use_symmetry", "keep_locked"):
            layout.prop(self, name)

    def begin(self, context: bpy.types.Context) -> Threaded:
        self._job = self._job_of(context)
        return Threaded(self._job.run)

    def status(self, progress: Progress) -> str:
        return iface_("Turgor Weights: {percent} %  |  Esc: Cancel").format(percent=int(100 * progress[0]))

    def finish(self, context: bpy.types.Context) -> set[str]:
        with runtime.quiet():
            self._before_writing()
            self._job.write()
        if self._job.fallback_count:
            text = rpt_("{count} vertices lie in parts that no bone reaches: they follow the nearest part")
            self.report({"WARNING"}, text.format(count=self._job.fallback_count))
        return {"FINISHED"}

    def _job_of(self, context: bpy.types.Context) -> Job:
        """Read the meshes and bones that are weighted. Raises WeightError."""
        raise NotImplementedError

    def _options(self) -> Options:
        return Options(
            self.resolution, self.falloff, self.smoothing, self.max_influences, self.use_symmetry, self.keep_locked
        )

    def _before_writing(self) -> None:
        """What has to stand before there are groups."""


class OBJECT_OT_turgor_weights_parent(_Weights, bpy.types.Operator):
    bl_idname = "object.turgor_weights_parent"
    bl_label = "With Turgor Weights"
    bl_description = (
        "Parent the selected meshes to the active armature, with weights by distances inside of the body;"
        " open, broken and several meshes get weights too"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave the edit or paint mode first")
            return False
        if context.object is None or context.object.type != "ARMATURE" or not _meshes(context):
            cls.poll_message_set("Select meshes, then the armature")
            return False
        return True

    def _job_of(self, context: bpy.types.Context) -> Job:
        return Job(context.object, _meshes(context), self._options())

    def _before_writing(self) -> None:
        """Groups, modifier and parent as Blender's own makes them."""
        bpy.ops.object.parent_set(type="ARMATURE_NAME")


class PAINT_OT_turgor_weights(_Weights, bpy.types.Operator):
    bl_idname = "paint.turgor_weights"
    bl_label = "Turgor Weights from Bones"
    bl_description = (
        "Give the selected bones weights by distances inside of the body, on the selected vertices"
        " if Vertex Selection is on"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        if ob is None or ob.type != "MESH" or ob.mode != "WEIGHT_PAINT":
            cls.poll_message_set("Go to Weight Paint on a mesh first")
            return False
        if _rig(ob) is None:
            cls.poll_message_set("The mesh has no Armature modifier with an armature")
            return False
        return True

    def _job_of(self, context: bpy.types.Context) -> Job:
        rig = _rig(context.object)
        deform = set(weight_groups.deform_bone_names(rig))
        return Job(rig, [context.object], self._options(), weight_groups.selected_bone_names(rig) & deform or None)


def _meshes(context: bpy.types.Context) -> list[bpy.types.Object]:
    return [ob for ob in context.selected_editable_objects if ob.type == "MESH" and len(ob.data.vertices)]


def _rig(ob: bpy.types.Object) -> bpy.types.Object | None:
    rigs = (modifier.object for modifier in ob.modifiers if modifier.type == "ARMATURE")
    return next((rig for rig in rigs if rig is not None), None)


CLASSES = (OBJECT_OT_turgor_weights_parent, PAINT_OT_turgor_weights)


def draw_parent(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    ob = context.object
    if ob is not None and ob.type == "ARMATURE":
        menu.layout.separator()
        menu.layout.operator_context = "INVOKE_DEFAULT"
        menu.layout.operator(OBJECT_OT_turgor_weights_parent.bl_idname)


def draw_paint(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator_context = "INVOKE_DEFAULT"
    menu.layout.operator(PAINT_OT_turgor_weights.bl_idname)


def register() -> None:
    bpy.types.VIEW3D_MT_object_parent.append(draw_parent)
    bpy.types.VIEW3D_MT_paint_weight.append(draw_paint)


def unregister() -> None:
    bpy.types.VIEW3D_MT_paint_weight.remove(draw_paint)
    bpy.types.VIEW3D_MT_object_parent.remove(draw_parent)
