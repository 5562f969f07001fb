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
from ..messages import message, translated
from ..scene import baked_copy, spine_stack, stack
from .character import character_of
from .modal import ModalOperator, Progress, Steps
from .polling import in_edit_mode, is_allowed

REFUSALS = (options.BakeError, frame_range.FrameRangeError, whole_file.WriteError, TurgorError, ValueError, OSError)


class OBJECT_OT_turgor_bake(ModalOperator, bpy.types.Operator):
    bl_idname = "object.turgor_bake"
    bl_label = "Bake"
    bl_description = (
        "Make a copy that shows the same without Turgor, by shape keys or a point cache, as chosen below; Esc cancels,"
        " and the next bake goes on from there"
    )
    bl_options = {"REGISTER", "UNDO"}
    refusals = REFUSALS
    seconds_between_steps = 0.01
    cancelled = message("Bake cancelled; what was computed is kept for the next one")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = character_of(context)
        if ob is None or (stack.volume_modifier(ob) is None and spine_stack.spine_modifier(ob) is None):
            cls.poll_message_set("The active object has neither Turgor Volume nor Turgor Spine")
            return False
        running = None if runtime.session.bake is None else message("A bake is running")
        return is_allowed(cls, in_edit_mode(context.mode) or running)

    def begin(self, context: bpy.types.Context) -> Steps:
        self._target = character_of(context)
        with runtime.quiet():
            self._job = job.Job(self._target, options_of(self._target, context.scene))
        self._started = perf_counter()
        return Steps(quietly(self._job.run()))

    def status(self, progress: Progress) -> str:
        return f"Baking {self._target.name}: {self._text(progress)}  |  Esc: Cancel"

    def show(self, context: bpy.types.Context, progress: Progress) -> None:
        """Show how far the bake has come, in the panel too."""
        runtime.session.bake = runtime.Bake(progress[0], self._text(progress))
        super().show(context, progress)
        _redraw(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """End the bake and all that was shown of it, in the panel too."""
        try:
            super().cancel(context)
        finally:
            runtime.session.bake = None
            _redraw(context)

    def _text(self, progress: Progress) -> str:
        part, text = progress
        if part <= 0.0:
            return text
        left = (perf_counter() - self._started) * (1.0 - part) / part
        return f"{text}, {clock(left)} left"

    def finish(self, context: bpy.types.Context) -> set[str]:
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


CLASSES = (
    OBJECT_OT_turgor_bake,
    OBJECT_OT_turgor_bake_remove,
)


def options_of(target: bpy.types.Object, scene: bpy.types.Scene) -> options.Options:
    """Options of a bake from the settings of `target`. Raises frame_range.FrameRangeError, options.BakeError."""
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
