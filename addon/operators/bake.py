"""Bake the active character, or take its bake away again."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from time import perf_counter

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from turgor import TurgorError

from .. import runtime
from ..bake import baking, job, options
from ..logic import compared_frames, frame_range, whole_file
from ..messages import message, of_error, translated
from ..scene import baked_copy, spine_stack, stack
from .character import character_of
from .polling import in_edit_mode, is_allowed

# Between two redraws of the window.
SECONDS_OF_WORK = 0.1
REFUSALS = (options.BakeError, frame_range.FrameRangeError, whole_file.WriteError, TurgorError, ValueError, OSError)


class OBJECT_OT_turgor_bake(bpy.types.Operator):
    bl_idname = "object.turgor_bake"
    bl_label = "Bake"
    bl_description = (
        "Make a copy that shows the same without Turgor, by shape keys or a point cache, as chosen below; Esc cancels,"
        " and the next bake goes on from there"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = character_of(context)
        if ob is None or (stack.volume_modifier(ob) is None and spine_stack.spine_modifier(ob) is None):
            cls.poll_message_set("The active object has neither Turgor Volume nor Turgor Spine")
            return False
        running = None if runtime.session.bake is None else message("A bake is running")
        return is_allowed(cls, in_edit_mode(context.mode) or running)

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not self._begin(context):
            return {"CANCELLED"}
        try:
            with closing(self._steps):
                for _ in self._steps:
                    pass
        except REFUSALS as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        return self._finish(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if bpy.app.background or context.window is None:
            return self.execute(context)
        if not self._begin(context):
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        self._tell(context, baking.Progress(0.0, "Begins"))
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Nothing else is let through: what is baked must not change under way."""
        if event.type == "ESC" and event.value == "PRESS":
            self._end(context)
            self.report({"INFO"}, "Bake cancelled; what was computed is kept for the next one")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        until = perf_counter() + SECONDS_OF_WORK
        try:
            while perf_counter() < until:
                progress = next(self._steps, None)
                if progress is None:
                    self._end(context)
                    return self._finish(context)
                self._tell(context, progress)
        except REFUSALS as error:
            self._end(context)
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender closes the window or the file."""
        self._end(context)

    def _begin(self, context: bpy.types.Context) -> bool:
        self._target = character_of(context)
        try:
            with runtime.quiet():
                self._job = job.Job(self._target, options_of(self._target, context.scene))
        except REFUSALS as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return False
        self._steps: Iterator[baking.Progress] = quietly(self._job.run())
        self._started = perf_counter()
        return True

    def _tell(self, context: bpy.types.Context, progress: baking.Progress) -> None:
        spent = perf_counter() - self._started
        left = spent * (1.0 - progress.part) / progress.part if progress.part > 0.0 else None
        text = progress.text if left is None else f"{progress.text}, {clock(left)} left"
        runtime.session.bake = runtime.Bake(progress.part, text)
        context.window_manager.progress_update(int(100 * progress.part))
        context.workspace.status_text_set(f"Baking {self._target.name}: {text}  |  Esc: Cancel")
        _redraw(context)

    def _end(self, context: bpy.types.Context) -> None:
        self._steps.close()
        runtime.session.bake = None
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        _redraw(context)

    def _finish(self, context: bpy.types.Context) -> set[str]:
        copy, target = self._job.baked, self._target
        lines = self._job.report.lines()
        for ob, other in ((copy, target), (target, copy)):
            if ob.library is None:
                ob.turgor_bake.other, ob.turgor_bake.report = other, "\n".join(lines)
        if target.turgor_bake.hide_original:
            target.hide_set(True)
            if target.library is None:
                target.hide_render = True
        if context.mode == "OBJECT":
            target.select_set(False)
            copy.select_set(True)
            context.view_layer.objects.active = copy
        for note in self._job.report.notes:
            self.report({"WARNING"}, note)
        self.report({"INFO"}, translated(message("Baked {what}", what=lines[0]), rpt_))
        return {"FINISHED"}


class OBJECT_OT_turgor_bake_remove(bpy.types.Operator):
    bl_idname = "object.turgor_bake_remove"
    bl_label = "Remove Bake"
    bl_description = "Delete the baked copy and show the live mesh again; files of caches and reports stay"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        if ob is None or not ob.turgor_bake.report or ob.turgor_bake.other is None:
            cls.poll_message_set("The active object has no bake")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        ob = context.object
        other = ob.turgor_bake.other
        is_live = stack.volume_modifier(ob) is not None or spine_stack.spine_modifier(ob) is not None
        live, copy = (ob, other) if is_live else (other, ob)
        live.turgor_bake.property_unset("other")
        live.turgor_bake.property_unset("report")
        live.hide_set(False)
        live.hide_render = False
        baked_copy.discard(copy)
        context.view_layer.objects.active = live
        live.select_set(True)
        return {"FINISHED"}


def options_of(target: bpy.types.Object, scene: bpy.types.Scene) -> options.Options:
    """As its settings say. Raises frame_range.FrameRangeError, options.BakeError."""
    saved = target.turgor_bake
    if saved.frames.strip():
        frames = frame_range.parse(saved.frames)
    else:
        frames = frame_range.steps(scene.frame_start, scene.frame_end, max(scene.frame_step, 1))
    is_kept = bool(bpy.data.filepath) or not saved.folder.startswith("//")
    return options.Options(
        method=saved.method,
        frames=frames,
        tolerance=0.01 * saved.error_percent if saved.unit == "PERCENT" else _in_object(target, saved.error_length),
        tolerance_is_relative=saved.unit == "PERCENT",
        unit_values=saved.unit_values,
        local_keys=saved.local_keys,
        influences=saved.influences,
        use_linear=saved.use_linear,
        most_keys=saved.most_keys,
        folder=Path(bpy.path.abspath(saved.folder)) if is_kept and saved.folder else None,
        verify=saved.verify,
        live_frames=0 if saved.every_frame else compared_frames.MOST_FRAMES,
        repair_folds=saved.repair_folds,
        name=f"{target.name} Baked",
    )


def _in_object(target: bpy.types.Object, length: float) -> float:
    """A length of the scene in units of the object, by the largest of its scales."""
    scales = np.linalg.svd(np.array(target.matrix_world, np.float64)[:3, :3], compute_uv=False)
    return length / float(scales[0]) if scales[0] > 0.0 else 0.0


def quietly(steps: Iterator[baking.Progress]) -> Iterator[baking.Progress]:
    """The add-on's handlers do nothing while a step runs."""
    with closing(steps):
        while True:
            with runtime.quiet():
                progress = next(steps, None)
            if progress is None:
                return
            yield progress


def clock(seconds: float) -> str:
    """0:07, 12:30, 1:02:03."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


def _redraw(context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "STATUSBAR"}:
                area.tag_redraw()
