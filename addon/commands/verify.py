"""turgor verify: copies that were baked, beside the live characters."""

from __future__ import annotations

import argparse
from typing import Any

import bpy
import numpy as np

from ..bake import job
from ..bake.options import Options
from ..logic import frame_range
from ..logic.bake_report import BakeReport
from . import arguments as shared
from .bake import follow
from .characters import baked_copies, objects_with_turgor
from .outcome import CommandError, Outcome

NAME = "verify"
HELP = "compare baked copies with the live characters"
DESCRIPTION = (
    "For a file that `bake --save` wrote. The copy is compared with the live character, as Blender evaluates it, and on"
    " every frame with the positions that Turgor computes. Exit code 1 if any vertex is further off than --error, or if"
    " the two have other numbers of vertices."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    shared.add_objects(parser)
    shared.add_frames(parser, "those that were baked")
    parser.add_argument(
        "--error",
        type=float,
        default=0.0001,
        metavar="PERCENT",
        help="how far any vertex may be off, in percent of the size (default: %(default)s)",
    )
    shared.add_live_frames(parser)
    shared.add_part(parser, "compare the share of the frames")
    shared.add_progress(parser)


def run(arguments: argparse.Namespace) -> Outcome:
    """Raises outcome.CommandError, BakeError, turgor.TurgorError."""
    targets = objects_with_turgor(arguments.objects)
    pairs = [(copy, ob) for copy, ob in baked_copies() if ob in targets]
    missing = [ob.name for ob in targets if arguments.objects and ob not in (live for _, live in pairs)]
    if missing or not pairs:
        raise CommandError(f"No baked copy of {', '.join(missing) or 'anything'}: bake with --save first")
    reports = []
    for copy, ob in pairs:
        frames = _frames(arguments, copy)
        if len(frames):
            reports.append(_compared(arguments, ob, copy, frames))
    is_near = all(100.0 * each.max_error_relative <= arguments.error for each in reports)
    is_seen = all(each.live_errors for each in reports)
    lines = [line for each in reports for line in (each.name, *(f"  {found}" for found in _lines(each)))]
    if not is_near:
        lines.append(f"Further off than {arguments.error:g} %")
    return Outcome(is_near and is_seen, {"objects": [_entry(each) for each in reports]}, lines)


def _frames(arguments: argparse.Namespace, copy: bpy.types.Object) -> np.ndarray:
    """The share of those asked for, or of those that were baked."""
    baked = copy.turgor_bake.frames.strip()
    frames = shared.chosen_frames(arguments, bpy.context.scene)
    if arguments.frames is None and baked:
        frames = frame_range.parse(baked)
    if arguments.part is None:
        return frames
    share = arguments.part.of(len(frames))
    return frames[share.start : share.stop]


def _compared(
    arguments: argparse.Namespace, ob: bpy.types.Object, copy: bpy.types.Object, frames: np.ndarray
) -> BakeReport:
    options = Options("ABSOLUTE", frames, repair_folds=copy.turgor_bake.repair_folds, live_frames=arguments.live_frames)
    made = job.Job(ob, options)
    follow(made.verify(copy), arguments.progress)
    return made.report


def _entry(report: BakeReport) -> dict[str, Any]:
    names = ("name", "frames", "live_frames", "size", "max_error_relative", "volume_error_relative", "notes")
    found = report.as_dict()
    return {name: found[name] for name in names}


def _lines(report: BakeReport) -> list[str]:
    return [*report.comparison(), f"Volume within {100.0 * report.volume_error_relative:+.2g} %", *report.notes]
