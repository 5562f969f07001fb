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
from ..scene import frame, settings, shown_mesh
from . import engines, findings, spine_frame
from .binding import Bound
from .guard import guarded


def correct(target: bpy.types.Object, address: int, vertex_count: int) -> bool:
    """Correct the evaluated `target`; offsets, (N, 3) float32, go to `address`.

    False: there is nothing to show but plain skinning, offsets must be zero.
    """
    return guarded(
        runtime.session.characters, target, lambda known: _correct_bound(target, known, address, vertex_count)
    )


def _correct_bound(target: bpy.types.Object, known: runtime.Character, address: int, vertex_count: int) -> bool:
    bound: Bound | None = known.body
    if bound is None or bound.body.vertex_count != vertex_count:
        return False
    _correct(target, known, bound, address, vertex_count)
    return True


class Request(NamedTuple):
    """What the engine is asked for one frame."""

    engine: turgor.VolumeSkin
    pose_matrices: NDArray[np.float32]  # (B, 4, 4)
    options: dict[str, Any]  # more arguments of `VolumeSkin.deform`
    strengths: NDArray[np.float64]  # (J,) of the joints
    saved: settings.BodySettings


def read(target: bpy.types.Object, known: runtime.Character, bound: Bound) -> Request:
    """Of the evaluated `target`. Raises what says why it cannot be read."""
    now = engines.settled(target, known, bound)
    inputs = frame.read_inputs(target, target.modifiers[now.armature].object)
    try:
        pose_matrices = inputs.pose_matrices[bound.bones.pose_indices]
    except IndexError:
        raise frame.FrameError("Bones were removed from the armature: leave its edit mode, or press Rebind") from None
    options = {"object_from_armature": inputs.object_from_armature, "target_scale": now.saved.target_volume}
    if len(inputs.shape_values):
        options["shape_values"] = inputs.shape_values
    if bound.fleshed is not None and (added := spine_frame.added_offsets(target, bound.body.vertex_count)) is not None:
        options |= {"added_offsets": added, "fleshed": bound.fleshed}
    if now.saved.repair_folds:
        options["repair_folds"] = True
    return Request(now.engine, pose_matrices, options, now.strengths, now.saved)


def _correct(target: bpy.types.Object, known: runtime.Character, bound: Bound, address: int, vertex_count: int) -> None:
    started = perf_counter()
    asked = read(target, known, bound)
    ready = perf_counter()
    report = asked.engine.deform_into_address(address, vertex_count, asked.pose_matrices, **asked.options)
    done = perf_counter()
    if not runtime.session.is_rendering:
        _remember(target, known, bound, asked, lambda: report)
        known.timing = runtime.Timing(1e3 * (ready - started), 1e3 * (done - ready), 0.0)


def observe(target: bpy.types.Object) -> None:
    """Figures of the evaluated `target` at a frame at which nothing asks for offsets: our modifier is off."""
    known = runtime.session.characters.get(target.original.session_uid)
    bound: Bound | None = None if known is None else known.body
    if bound is None:
        return
    try:
        asked = read(target, known, bound)
    except Exception:  # said in the panel when the modifier is on
        known.measure = known.inspect = None
        return
    _remember(target, known, bound, asked, lambda: asked.engine.deform(asked.pose_matrices, **asked.options).report)
    known.timing = None


def _remember(
    target: bpy.types.Object,
    known: runtime.Character,
    bound: Bound,
    asked: Request,
    report: Callable[[], turgor.Report],
) -> None:
    known.name = target.name
    uid = target.original.session_uid
    known.measure = measure = runtime.Once(lambda: _figures(uid, known, report(), bound, asked))
    known.inspect = runtime.Once(lambda: _inspect(uid, known, measure(), bound, asked.strengths))


def _figures(
    uid: int, known: runtime.Character, report: turgor.Report, bound: Bound, asked: Request
) -> runtime.Figures:
    """When a panel is drawn, on the main thread: after all that the viewport shows was evaluated."""
    found = figures.frame_figures(
        report,
        bound.body.rest_volume,
        asked.strengths,
        asked.options["target_scale"],
        _shown_volumes(uid, known, bound),
    )
    names = [bound.bones.names[bone] for bone in bound.body.joint_bones]
    rows = zip(found.lost, found.regained, found.is_capped, strict=True)
    by_bone = {name: runtime.JointFigures(*row) for name, row in zip(names, rows, strict=True)}
    folds = None
    if asked.options.get("repair_folds"):
        folds = runtime.Folds(report.folds_found, report.folds_left, len(report.blocked_vertices))
    return runtime.Figures(found.corrected_deviation, found.skinned_deviation, found.shown_deviation, by_bone, folds)


def _shown_volumes(uid: int, known: runtime.Character, bound: Bound) -> NDArray[np.float64] | None:
    target = runtime.object_of(uid, known, bpy.data.objects)
    positions = None if target is None else shown_mesh.positions(target)
    if positions is None or len(positions) != bound.body.vertex_count or not np.isfinite(positions).all():
        return None
    return bound.body.mesh.component_volumes(positions)


def _inspect(
    uid: int, known: runtime.Character, figures: runtime.Figures, bound: Bound, strengths: NDArray[np.float64]
) -> tuple[runtime.Finding, ...]:
    """When a panel is drawn, on the main thread."""
    target = runtime.object_of(uid, known, bpy.data.objects)
    if target is None:
        return ()
    names = [bound.bones.names[bone] for bone in bound.body.joint_bones]
    found = findings.of_figures(target, figures, dict(zip(names, strengths.tolist(), strict=True)))
    runtime.log_findings(known, target.name, found)
    return found
