"""Automatic weights: parent meshes to an armature with them, or give them to selected bones in Weight Paint."""

from __future__ import annotations

import threading

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, FloatProperty, IntProperty
from turgor import CancelledError, TurgorError

from .. import runtime
from ..live.automatic_weights import Job, Options, WeightError
from ..messages import of_error, translated
from ..scene import weight_groups

REFUSALS = (WeightError, TurgorError)


class _Weights:
    """Settings, and a run beside the window: the engine works in a thread, the timer asks how far it is."""

    bl_options = {"REGISTER", "UNDO"}

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

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            job = self._job(context)
            job.run()
        except REFUSALS as error:
            return self._refuse(error)
        return self._finish(context, job)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self._running = self._job(context)
        except REFUSALS as error:
            return self._refuse(error)
        self._part, self._is_cancelled, self._error = 0.0, False, None
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        self._thread.start()
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Nothing else is let through: what was read must not change under way."""
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, rpt_("Cancelled, weights are as they were"))
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        if self._thread.is_alive():
            context.window_manager.progress_update(int(100 * self._part))
            text = iface_("Turgor Weights: {percent} %  |  Esc: Cancel").format(percent=int(100 * self._part))
            context.workspace.status_text_set(text)
            return {"RUNNING_MODAL"}
        self._end(context)
        if self._error is not None:
            return self._refuse(self._error)
        return self._finish(context, self._running)

    def cancel(self, context: bpy.types.Context) -> None:
        """Also where Blender closes the window or the file."""
        self._is_cancelled = True
        self._thread.join()
        self._end(context)

    def _work(self) -> None:
        def progress(part: float) -> bool:
            self._part = part
            return not self._is_cancelled

        try:
            self._running.run(progress)
        except CancelledError:
            pass
        except REFUSALS as error:
            self._error = error

    def _end(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _refuse(self, error: Exception) -> set[str]:
        self.report({"ERROR"}, translated(of_error(error), rpt_))
        return {"CANCELLED"}

    def _options(self) -> Options:
        return Options(
            self.resolution, self.falloff, self.smoothing, self.max_influences, self.use_symmetry, self.keep_locked
        )

    def _finish(self, context: bpy.types.Context, job: Job) -> set[str]:
        with runtime.quiet():
            self._before_writing(context, job)
            job.write()
        if job.fallback_count:
            text = rpt_("{count} vertices lie in parts that no bone reaches: they follow the nearest part")
            self.report({"WARNING"}, text.format(count=job.fallback_count))
        return {"FINISHED"}

    def _before_writing(self, context: bpy.types.Context, job: Job) -> None:
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

    def _job(self, context: bpy.types.Context) -> Job:
        return Job(context.object, _meshes(context), self._options())

    def _before_writing(self, context: bpy.types.Context, job: Job) -> None:
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

    def _job(self, context: bpy.types.Context) -> Job:
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
