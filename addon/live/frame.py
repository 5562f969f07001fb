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
from ..logic import figures, joints
from ..logic.profiles import Profiles, Tables
from ..properties.profiles import PRESET_NAMES
from ..scene import frame, settings
from . import findings, spine_frame
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
    _correct(target, known, bound, address)
    return True


class Request(NamedTuple):
    """What the engine is asked for one frame."""

    engine: turgor.VolumeSkin
    pose_matrices: NDArray[np.float32]  # (B, 4, 4)
    options: dict[str, Any]  # more arguments of `VolumeSkin.deform`
    strengths: NDArray[np.float64]  # (J,) of the joints
    saved: settings.BodySettings


def read(target: bpy.types.Object, bound: Bound) -> Request:
    """Of the evaluated `target`. Raises what says why it cannot be read."""
    inputs = frame.read_frame(target)
    saved = settings.read_settings(target)
    pose_matrices, options = _asked(target, bound, inputs, saved)
    engine = engine_of(target, saved, bound)
    return Request(engine, pose_matrices, options, bound.body.joint_strengths, saved)


def read_alike(target: bpy.types.Object, rig: bpy.types.Object, bound: Bound, other: Request) -> Request:
    """The same, both evaluated, where settings are those of another frame: they are not read again."""
    pose_matrices, options = _asked(target, bound, frame.read_inputs(target, rig), other.saved)
    return Request(other.engine, pose_matrices, options, other.strengths, other.saved)


def _asked(
    target: bpy.types.Object, bound: Bound, inputs: frame.FrameInputs, saved: settings.BodySettings
) -> tuple[NDArray[np.float32], dict[str, Any]]:
    try:
        pose_matrices = inputs.pose_matrices[bound.bones.pose_indices]
    except IndexError:
        raise frame.FrameError("Bones were removed from the armature: leave its edit mode, or press Rebind") from None
    options = {"object_from_armature": inputs.object_from_armature, "target_scale": saved.target_volume}
    if len(inputs.shape_values):
        options["shape_values"] = inputs.shape_values
    if bound.fleshed is not None and (added := spine_frame.added_offsets(target, bound.body.vertex_count)) is not None:
        options |= {"added_offsets": added, "fleshed": bound.fleshed}
    if saved.repair_folds:
        options["repair_folds"] = True
    return pose_matrices, options


def _correct(target: bpy.types.Object, known: runtime.Character, bound: Bound, address: int) -> None:
    started = perf_counter()
    asked = read(target, bound)
    ready = perf_counter()
    report = asked.engine.deform_into_address(address, bound.body.vertex_count, asked.pose_matrices, **asked.options)
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
        asked = read(target, bound)
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
    known.measure = measure = runtime.Once(lambda: _figures(report(), bound, asked))
    uid = target.original.session_uid
    known.inspect = runtime.Once(lambda: _inspect(known, uid, measure(), bound, asked.strengths))


def engine_of(target: bpy.types.Object, saved: settings.BodySettings, bound: Bound) -> turgor.VolumeSkin:
    """The engine under these settings of the character; the same object while they are equal."""
    return bound.body.with_settings(
        settings_key(saved, bound),
        lambda: _joints(target, saved, bound),
        saved.solver.lower(),
        saved.keep_bone_scale,
    )


def settings_key(saved: settings.BodySettings, bound: Bound) -> object:
    """Equal while the engine is."""
    arrays = tuple(array.tobytes() for array in saved.joints)
    return arrays, saved.seconds, saved.solver, saved.keep_bone_scale, bound.curves.stamps


def _joints(target: bpy.types.Object, saved: settings.BodySettings, bound: Bound) -> list[turgor.Joint]:
    index = {name: number for number, name in enumerate(bound.bones.names)}
    arrays, tables = saved.joints, bound.curves.tables
    strengths = joints.effective_strengths(arrays.strengths, arrays.is_muted, arrays.is_solo)
    found = []
    for place, name in enumerate(settings.joint_names(target)):
        if name not in index:
            continue
        first = Profiles(
            PRESET_NAMES[arrays.presets[place]],
            PRESET_NAMES[arrays.curve_sources[place]],
            None if arrays.use_auto_shares[place] else tuple(arrays.shares[place].tolist()),
            tables.get((place, False)),
        )
        second = saved.seconds.get(place)
        by_value = arrays.blend_modes[place] == settings.BLEND_BY_VALUE
        joint = joints.JointSettings(
            index[name],
            float(strengths[place]),
            float(arrays.sizes[place]),
            first,
            None if second is None else _second(second, tables.get((place, True))),
            float(arrays.blends[place]) if by_value else None,
            float(arrays.fold_losses[place]),
        )
        found.append(joints.engine_joint(joint))
    return found


def _second(saved: settings.SecondSet, tables: Tables | None) -> Profiles:
    shares = None if saved.use_auto_shares else saved.shares
    return Profiles(saved.preset, saved.curve_source, shares, tables)


def _figures(report: turgor.Report, bound: Bound, asked: Request) -> runtime.Figures:
    found = figures.frame_figures(report, bound.body.rest_volume, asked.strengths, asked.options["target_scale"])
    names = [bound.bones.names[bone] for bone in bound.body.joint_bones]
    rows = zip(found.lost, found.regained, found.is_capped, strict=True)
    by_bone = {name: runtime.JointFigures(*row) for name, row in zip(names, rows, strict=True)}
    folds = None
    if asked.options.get("repair_folds"):
        folds = runtime.Folds(report.folds_found, report.folds_left, len(report.blocked_vertices))
    return runtime.Figures(found.corrected_deviation, found.skinned_deviation, by_bone, folds)


def _inspect(
    known: runtime.Character, uid: int, figures: runtime.Figures, bound: Bound, strengths: NDArray[np.float64]
) -> tuple[runtime.Finding, ...]:
    """When a panel is drawn, on the main thread."""
    target = next((ob for ob in bpy.data.objects if ob.session_uid == uid), None)
    if target is None:
        return ()
    names = [bound.bones.names[bone] for bone in bound.body.joint_bones]
    found = findings.of_figures(target, figures, dict(zip(names, strengths.tolist(), strict=True)))
    runtime.log_findings(known, target.name, found)
    return found
