"""Findings of what stands after Turgor Volume: what each modifier there changes of the volume, measured.

Looking at a place amid the stack takes an evaluation of its own, apart from the artist's scene: at once where there is
no window, else when nothing has moved for a while, and never where nothing asks for it.
"""

from __future__ import annotations

import bpy
import numpy as np

from .. import runtime
from ..logic import fingerprint, stack_volumes
from ..logic.character_figures import VolumeFigures
from ..logic.finding import Finding
from ..messages import message, signed_percent
from ..scene import later_modifiers, scene_drivers, shown_mesh
from ..states import VolumeBinding, VolumeState
from . import findings, measured, strokes

# Seconds without another frame before the stack is looked at.
SECONDS_TO_REST = 0.4
# Later modifiers that change less of the volume are not told; from the second figure on they are a warning.
NOTABLE_PERCENT, MUCH_PERCENT = findings.NOTABLE_PERCENT, 0.1


def follow(
    target: bpy.types.Object, character: VolumeState, bound: VolumeBinding, figures: VolumeFigures
) -> tuple[Finding, ...]:
    """What the mesh that is shown says of this frame; has the stack looked at where that takes more.

    Called when a panel is drawn; the findings of later modifiers go to `character.later_findings`.
    """
    shown = shown_mesh.positions(target)
    if shown is None or figures.computed_volumes is None:
        character.later_findings = ()
        return ()
    later = later_modifiers.later(target)
    if not later and later_modifiers.is_whole(target):
        character.later_findings = ()
        return measured.of_volume(target, bound.body.mesh, figures, shown)
    seen = fingerprint.fingerprint([shown], [(each.name, each.show_viewport, each.show_render) for each in later])
    if character.later_seen != seen:
        character.later_seen = seen
        strokes.when_quiet(target.session_uid, "later", _look, SECONDS_TO_REST)
    return ()


def _look(target: bpy.types.Object) -> None:
    """Measure the stack after each later modifier, and keep what was found."""
    character = runtime.character(target.session_uid)
    measure, bound = character.measure, character.binding
    if measure is None or bound is None:
        return
    figures = measure()
    if figures.computed_volumes is None:
        return
    scene = bpy.context.scene
    shown = shown_mesh.positions(target)
    try:
        with runtime.quiet(), character.frame_kept(), runtime.spine(target.session_uid).frame_kept():
            steps = later_modifiers.steps(target, scene.frame_current_final)
    except scene_drivers.SceneDriverError:
        return
    right_after, last = steps.posed[0][0], steps.posed[-1][0]
    # A pose that was changed by hand and not keyed is seen by the artist's scene only.
    is_of_frame = not later_modifiers.is_whole(target) or np.array_equal(last, shown)
    found: list[Finding] = []
    if is_of_frame:
        found += measured.of_volume(target, bound.body.mesh, figures, right_after)
        found += _of_later(target, steps)
    character.later_findings = tuple(found)
    _redraw()


def _of_later(target: bpy.types.Object, steps: later_modifiers.Steps) -> list[Finding]:
    found = []
    for place, name in enumerate(steps.names):
        modifier = target.modifiers.get(name)
        if modifier is None:
            continue
        is_subdivided = modifier.type in later_modifiers.SUBDIVIDING
        posed = stack_volumes.change(*steps.posed[place : place + 2], is_subdivided=is_subdivided)
        at_rest = 1.0
        if not later_modifiers.follows_others(modifier):
            at_rest = stack_volumes.change(*steps.rest[place : place + 2], is_subdivided=is_subdivided)
        if not posed or not at_rest:
            continue
        percent = 100.0 * (posed / at_rest - 1.0)
        if abs(percent) < NOTABLE_PERCENT:
            continue
        is_warning = abs(percent) >= MUCH_PERCENT and not is_subdivided
        text = message(
            "{modifier} changes the volume after Turgor Volume, by {percent}: move Turgor Volume below it",
            modifier=name,
            percent=signed_percent(percent, 3),
        )
        if abs(100.0 * (at_rest - 1.0)) >= NOTABLE_PERCENT:
            text = message(
                "{modifier} changes the volume after Turgor Volume, by {percent} beyond what it does at rest: move"
                " Turgor Volume below it",
                modifier=name,
                percent=signed_percent(percent, 3),
            )
        severity = "WARNING" if is_warning else "INFO"
        found.append(findings.finding(target, severity, "later_modifier", text, "MOVE_BELOW", name))
    return found


def _redraw() -> None:
    if bpy.app.background:
        return
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "VIEW_3D"}:
                area.tag_redraw()
