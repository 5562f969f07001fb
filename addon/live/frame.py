"""One frame of one character: evaluated data -> engine -> offsets. Safe on a worker thread; never raises."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any, NamedTuple

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..logic import figures
from ..logic.character_figures import Folds, Timing, VolumeFigures
from ..logic.finding import Finding
from ..logic.lazy import Lazy
from ..scene import frame, modifier_inputs, node_group, placement, settings, shown_mesh, stack, twin
from ..states import VolumeBinding, VolumeState
from . import engines, evaluated_frame, findings, joint_names, later_findings, spine_frame, twins
from .guard import guarded


def correct(target: bpy.types.Object, address: int, vertex_count: int) -> bool:
    """Correct the evaluated `target`; offsets, (N, 3) float32, go to `address`.

    False: there is nothing to show but plain skinning, offsets must be zero.
    """
    return guarded(
        runtime.session.characters, target, lambda character: _correct_bound(target, character, address, vertex_count)
    )


def _correct_bound(target: bpy.types.Object, character: VolumeState, address: int, vertex_count: int) -> bool:
    bound = character.binding
    if bound is None:
        return False
    if bound.evaluated is not None and target.original.mode == "EDIT":
        return False  # its twins share the mesh that is being edited
    try:
        _correct(target, character, bound, address, vertex_count)
    except twin.StepError:
        runtime.session.waiting.add(target.original.session_uid)
        return False
    return True


class Request(NamedTuple):
    """What the engine is asked for one frame."""

    engine: turgor.VolumeSkin
    pose_matrices: NDArray[np.float32]  # (B, 4, 4)
    options: dict[str, Any]  # more arguments of `VolumeSkin.deform`
    strengths: NDArray[np.float64]  # (J,) of the joints
    saved: settings.BodySettings


def read(target: bpy.types.Object, character: VolumeState, bound: VolumeBinding, *, is_off: bool = False) -> Request:
    """Read what the engine needs for one frame from the evaluated `target`. is_off: our modifier is off there.

    Raises frame.FrameError, another ValueError or turgor.TurgorError, which say why it cannot be read.
    """
    if bound.evaluated is not None:
        twins.check(target, character, bound)
    now = engines.settled(target, character, bound)
    rig = None if now.armature is None else target.modifiers[now.armature].object
    inputs = frame.read_inputs(target, rig, bound.bones)
    pose_matrices, place = inputs.pose_matrices, inputs.object_from_armature
    if bound.weighed is not None and placement.is_elsewhere(target, place, bound.placement, bound.weighed):
        # Other weights hold it there: from the next evaluation on it is read as Blender evaluates it.
        raise twin.StepError(f"{target.name} was moved along its bones just now: evaluate the scene once more")
    options = {"object_from_armature": place, "target_scale": now.saved.target_volume}
    if len(inputs.shape_values) and (bound.evaluated is None or not bound.evaluated.has_body):
        options["shape_values"] = inputs.shape_values
    if bound.evaluated is not None:
        options |= evaluated_frame.options(target, bound, is_off=is_off)
    elif (
        bound.fleshed is not None and (added := spine_frame.added_offsets(target, bound.body.vertex_count)) is not None
    ):
        options |= {"added_offsets": added, "fleshed": bound.fleshed}
    if now.saved.repair_folds:
        options["repair_folds"] = True
    return Request(now.engine, pose_matrices, options, now.strengths, now.saved)


def _correct(
    target: bpy.types.Object, character: VolumeState, bound: VolumeBinding, address: int, vertex_count: int
) -> None:
    started = perf_counter()
    asked = read(target, character, bound)
    ready = perf_counter()
    report = asked.engine.deform_into_address(address, vertex_count, asked.pose_matrices, **asked.options)
    done = perf_counter()
    if not runtime.session.is_rendering:
        _remember(target, character, bound, asked, lambda: report)
        character.timing = Timing(1e3 * (ready - started), 1e3 * (done - ready), 0.0)


def observe(target: bpy.types.Object) -> None:
    """Figures of the evaluated `target` at a frame at which nothing asks for offsets: our modifier is off."""
    character = runtime.session.characters.get(target.original.session_uid)
    if character is None or character.binding is None:
        return
    bound = character.binding
    try:
        asked = read(target, character, bound, is_off=True)
    except Exception:  # said in the panel when the modifier is on
        character.measure = character.inspect = None
        return
    _remember(target, character, bound, asked, lambda: asked.engine.deform(asked.pose_matrices, **asked.options).report)
    character.timing = None


def _remember(
    target: bpy.types.Object,
    character: VolumeState,
    bound: VolumeBinding,
    asked: Request,
    report: Callable[[], turgor.Report],
) -> None:
    character.name = target.name
    uid = target.original.session_uid
    character.measure = measure = Lazy(lambda: _figures(uid, character, report(), bound, asked))
    character.inspect = Lazy(lambda: _inspect(uid, character, measure(), bound, asked.strengths))


def _figures(
    uid: int, character: VolumeState, report: turgor.Report, bound: VolumeBinding, asked: Request
) -> VolumeFigures:
    """Figures of a frame. Called on the main thread when a panel is drawn, after the viewport's mesh was evaluated."""
    found = figures.frame_figures(
        report,
        bound.body.rest_volume,
        asked.strengths,
        asked.options["target_scale"],
        _shown_volumes(uid, character, bound),
    )
    joints = figures.of_joints(found, joint_names.of_rows(bound.bones, bound.body.joint_bones))
    folds = None
    if asked.options.get("repair_folds"):
        folds = Folds(report.folds_found, report.folds_left, len(report.blocked_vertices))
    return VolumeFigures(
        found.corrected_deviation,
        found.skinned_deviation,
        found.shown_deviation,
        joints,
        folds,
        *_computed(uid, character, bound, report, asked),
        found.target_volume,
    )


def _computed(
    uid: int, character: VolumeState, bound: VolumeBinding, report: turgor.Report, asked: Request
) -> tuple[NDArray[np.float64] | None, float]:
    """Volumes that the mesh right after ours should have, (K,), where it shows all of what was computed; its reach."""
    target = runtime.object_of(uid, character, bpy.data.objects)
    ours = None if target is None else stack.volume_modifier(target)
    if target is None or ours is None or not ours.show_viewport:
        return None, 0.0
    # Where Blender evaluates the stack, ours shows what was computed whether an Armature is on, or there, or not.
    armature = None if bound.evaluated is not None else stack.armature_modifier(target)
    if armature is not None and not armature.show_viewport:
        return None, 0.0
    is_whole = modifier_inputs.read_input(ours, node_group.STRENGTH) == 1.0
    reach = float(np.abs(asked.options["object_from_armature"][:3, 3]).max())
    return (report.corrected_volumes if is_whole else None), reach


def _shown_volumes(uid: int, character: VolumeState, bound: VolumeBinding) -> NDArray[np.float64] | None:
    target = runtime.object_of(uid, character, bpy.data.objects)
    positions = None if target is None else shown_mesh.positions(target)
    if positions is None or len(positions) != bound.body.vertex_count or not np.isfinite(positions).all():
        return None
    return bound.body.mesh.component_volumes(positions)


def _inspect(
    uid: int, character: VolumeState, figures: VolumeFigures, bound: VolumeBinding, strengths: NDArray[np.float64]
) -> tuple[Finding, ...]:
    """Find and log what is off in a frame. Called on the main thread when a panel is drawn."""
    target = runtime.object_of(uid, character, bpy.data.objects)
    if target is None:
        return ()
    names = joint_names.of_rows(bound.bones, bound.body.joint_bones)
    found = findings.of_figures(target, figures, dict(zip(names, strengths.tolist(), strict=True)))
    found += later_findings.follow(target, character, bound, figures)
    runtime.log_findings(character, target.name, found)
    return found
