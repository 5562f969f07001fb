"""turgor report: the volume of every frame, with and without Turgor."""

from __future__ import annotations

import argparse
from typing import Any

import bpy
import numpy as np
import turgor

from .. import runtime
from ..bake.options import BakeError
from ..bake.spine_frames import SpineFrames
from ..live import measuring, stack_measures
from ..messages import signed_percent
from ..scene import stack
from . import arguments as shared
from .characters import objects_with_turgor
from .outcome import CommandError, Outcome

NAME = "report"
HELP = "volume of every frame, with and without Turgor"
DESCRIPTION = (
    "Deviations in percent of the volume that should be there. With --tolerance, exit code 1 if any frame deviates by"
    " more."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    shared.add_objects(parser)
    shared.add_frames(parser)
    parser.add_argument("--tolerance", type=float, metavar="PERCENT", help="largest deviation with Turgor")


def run(arguments: argparse.Namespace) -> Outcome:
    """Raises outcome.CommandError."""
    frames = shared.chosen_frames(arguments, bpy.context.scene)
    targets = objects_with_turgor(arguments.objects)
    if not targets:
        raise CommandError("No object has Turgor: there is nothing to report")
    objects = [
        _volume(ob, frames, use_test_motion=arguments.frames is None)
        if stack.volume_modifier(ob) is not None
        else _spine(ob, frames)
        for ob in targets
    ]
    worst = max(each["largest_deviation"] for each in objects)
    is_fine = arguments.tolerance is None or worst <= arguments.tolerance
    lines = [line for each in objects for line in _lines(each)]
    if not is_fine:
        lines.append(f"Deviates by {worst:.2g} %, more than {arguments.tolerance:g} %")
    return Outcome(is_fine, {"objects": objects}, lines)


def _volume(ob: bpy.types.Object, frames: np.ndarray, *, use_test_motion: bool) -> dict[str, Any]:
    try:
        motion = measuring.measure(ob, frames.tolist(), use_test_motion=use_test_motion, is_evaluated=True)
    except ValueError as error:
        raise CommandError(f"{ob.name}: {error}") from error
    character = runtime.character(ob.session_uid)
    return _entry(
        ob.name,
        "VOLUME",
        character.binding.body.rest_volume,
        motion.frames,
        motion.corrected_deviations,
        motion.skinned_deviations,
        motion.measured_deviations,
        motion.final_deviations,
    )


def _spine(ob: bpy.types.Object, frames: np.ndarray) -> dict[str, Any]:
    """A spine keeps the volume at rest; without it nothing bends, so there is one figure only."""
    try:
        source = SpineFrames(ob)
    except BakeError as error:
        raise CommandError(str(error)) from error
    mesh = turgor.Mesh(source.rest.positions, source.rest.face_offsets, source.rest.face_corners)
    rest = float(np.abs(mesh.component_volumes(source.rest.positions)).sum())
    found = [float(np.abs(mesh.component_volumes(sample.positions)).sum()) for sample in source.samples(frames)]
    deviations = 100.0 * (np.array(found) / rest - 1.0) if rest else np.zeros(len(found))
    try:
        seen = stack_measures.volumes(ob, source.own, mesh, frames.tolist())
    except ValueError as error:
        raise CommandError(f"{ob.name}: {error}") from error
    measured, final = (stack_measures.deviations(each, rest) for each in seen)
    return _entry(ob.name, "SPINE", rest, frames, deviations, None, measured, final)


def _entry(
    name: str,
    modifier: str,
    rest_volume: float,
    frames: np.ndarray | None,
    with_turgor: np.ndarray,
    without_turgor: np.ndarray | None,
    measured: np.ndarray | None,
    final: np.ndarray | None,
) -> dict[str, Any]:
    """Frames are None where nothing moves and a test range of motion was measured: then no mesh was evaluated."""
    shown = with_turgor if measured is None else np.concatenate([with_turgor, measured[np.isfinite(measured)]])
    return {
        "name": name,
        "modifier": modifier,
        "rest_volume": float(rest_volume),
        "frames": None if frames is None else frames.tolist(),
        "with_turgor": with_turgor.tolist(),
        "without_turgor": None if without_turgor is None else without_turgor.tolist(),
        "measured": _plain(measured),
        "measured_at_end": _plain(final),
        "largest_deviation": float(np.abs(shown).max(initial=0.0)),
    }


def _plain(deviations: np.ndarray | None) -> list[float | None] | None:
    """Without NaN, which JSON has no word for."""
    return None if deviations is None else [each if np.isfinite(each) else None for each in deviations.tolist()]


def _lines(entry: dict[str, Any]) -> list[str]:
    count = len(entry["with_turgor"])
    frames = [f"pose {number + 1}" for number in range(count)]
    if entry["frames"] is not None:
        frames = [f"frame {frame:g}" for frame in entry["frames"]]
    without = entry["without_turgor"]
    lines = [f"{entry['name']} ({entry['modifier']}), {count} frames, deviation of the volume"]
    if entry["frames"] is None:
        lines[0] += ", nothing moves: each joint was turned in turn"
    for number, frame in enumerate(frames):
        line = f"  {frame}: {signed_percent(entry['with_turgor'][number], 6)}"
        line += _measured_text(entry, number)
        lines.append(line if without is None else f"{line}, without Turgor {signed_percent(without[number], 2)}")
    return lines


def _measured_text(entry: dict[str, Any], number: int) -> str:
    """What was measured on the mesh, right after Turgor and, where that is another figure, after all modifiers."""
    if entry["measured"] is None:
        return ""
    measured, final = entry["measured"][number], entry["measured_at_end"][number]
    text = "" if measured is None else f", measured {signed_percent(measured, 6)}"
    return text if final in (None, measured) else f"{text}, after all modifiers {signed_percent(final, 6)}"
