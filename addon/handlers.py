"""Handlers of Blender's events: each hands its event to `live`, and returns at once where nothing of ours is there."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import migrations, runtime
from .live import housekeeping, overlay_frames, profiles, pull, push, refining, route_choice, start, strokes
from .properties import carrier, refine
from .scene import node_group, stack


@persistent
def load_post(*_arguments: Any) -> None:
    runtime.forget_file()
    overlay_frames.forget()
    strokes.forget()
    migrations.migrate(housekeeping.characters())
    start.start()


@persistent
def blend_import_post(*_arguments: Any) -> None:
    if not _is_idle():
        migrations.migrate(housekeeping.characters())


@persistent
def frame_change_pre(*_arguments: Any) -> None:
    _start_once()


@persistent
def frame_change_post(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if not _is_idle():
        _finish(depsgraph)


@persistent
def depsgraph_update_post(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if _is_idle():
        return
    _start_once()
    if not runtime.session.is_rendering:
        route_choice.choose()
        start.follow(depsgraph)
    _finish(depsgraph)


@persistent
def save_pre(*_arguments: Any) -> None:
    if not _is_idle():
        with runtime.quiet():
            housekeeping.remove_orphans()
            push.clear_all()


@persistent
def save_post(*_arguments: Any) -> None:
    if not _is_idle() and runtime.session.route == "PUSH":
        push.write_all(bpy.context.evaluated_depsgraph_get())


@persistent
def render_init(*_arguments: Any) -> None:
    if not _is_idle():
        _start_once()
        start.bind_waiting()
        start.follow_scripts()
    runtime.session.is_rendering = True


@persistent
def render_end(*_arguments: Any) -> None:
    runtime.session.is_rendering = False


def follow_dragged_curve() -> float:
    """A timer: while the artist drags a point of a curve, Blender tells nobody."""
    ob = None if _is_idle() or runtime.session.is_rendering else getattr(bpy.context, "object", None)
    if ob is None or not start.follow_shown_curves(ob):
        return SECONDS_BETWEEN_LOOKS
    return SECONDS_BETWEEN_DRAGS


def _is_idle() -> bool:
    return runtime.session.is_quiet or not node_group.exists()


def _start_once() -> None:
    if not runtime.session.is_started and not runtime.session.is_quiet:
        start.start()


def _finish(depsgraph: bpy.types.Depsgraph) -> None:
    if not runtime.session.is_rendering:
        start.bind_waiting()
        if runtime.session.route == "PULL":
            overlay_frames.observe(depsgraph)
        if not bpy.app.background:
            _redraw_panels()
    if runtime.session.route == "PUSH":
        push.write_all(depsgraph, runtime.session.behind)
        if runtime.session.waiting and not runtime.session.is_rendering:
            # It found bindings that no longer fit.
            start.bind_waiting()
            push.write_all(depsgraph, runtime.session.behind)
    runtime.session.behind.clear()


def _redraw_panels() -> None:
    """Show the figures of this evaluation; not while playing, where Blender leaves panels alone too."""
    for window in bpy.context.window_manager.windows:
        if not window.screen.is_animation_playing:
            for area in window.screen.areas:
                has_sidebar = area.type == "VIEW_3D" and area.spaces.active.show_region_ui
                if has_sidebar or area.type == "PROPERTIES":
                    area.tag_redraw()


# How often the active object is looked at: without, and with curves that may be dragged.
SECONDS_BETWEEN_LOOKS = 0.5
SECONDS_BETWEEN_DRAGS = 1 / 30

HANDLERS = (
    ("load_post", load_post),
    ("blend_import_post", blend_import_post),
    ("frame_change_pre", frame_change_pre),
    ("frame_change_post", frame_change_post),
    ("depsgraph_update_post", depsgraph_update_post),
    ("save_pre", save_pre),
    ("save_post", save_post),
    ("render_init", render_init),
    ("render_complete", render_end),
    ("render_cancel", render_end),
)


def register() -> None:
    carrier.TurgorCarrier.on_tick = staticmethod(pull.on_tick)
    runtime.session.look = overlay_frames.look
    runtime.session.look_refined = refining.look
    runtime.session.find_modifier = stack.volume_modifier
    refine.TurgorRefine.on_preview = staticmethod(refining.follow)
    profiles.register()
    for event, handler in HANDLERS:
        getattr(bpy.app.handlers, event).append(handler)
    if not bpy.app.background:
        bpy.app.timers.register(follow_dragged_curve, persistent=True)


def unregister() -> None:
    if bpy.app.timers.is_registered(follow_dragged_curve):
        bpy.app.timers.unregister(follow_dragged_curve)
    strokes.forget()
    for event, handler in reversed(HANDLERS):
        # Others may have cleared the list.
        with suppress(ValueError):
            getattr(bpy.app.handlers, event).remove(handler)
    profiles.unregister()
    carrier.TurgorCarrier.on_tick = staticmethod(carrier.ignore_tick)
    refine.TurgorRefine.on_preview = staticmethod(refine.ignore_preview)
    overlay_frames.forget()
    runtime.session = runtime.Session()
