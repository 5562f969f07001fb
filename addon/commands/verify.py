"""turgor verify: copies that were baked, frame by frame beside the live characters."""

from __future__ import annotations

import argparse
from typing import Any

import bpy
import numpy as np

from ..bake import job
from ..bake.options import Options
from ..logic import frame_range
from . import arguments as shared
from .bake import follow
from .characters import baked_copies, objects_with_turgor
from .outcome import CommandError, Outcome

NAME = "verify"
HELP = "compare baked copies with the live characters"
DESCRIPTION = "For a file that `bake --save` wrote. Exit code 1 if any vertex on any frame is further off than --error."


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
    shared.add_part(parser, "compare the share of the frames")
    shared.add_progress(parser)


def run(arguments: argparse.Namespace) -> Outcome:
    """Raises outcome.CommandError, BakeError, turgor.TurgorError."""
    targets = objects_with_turgor(arguments.objects)
    pairs = [(copy, ob) for copy, ob in baked_copies() if ob in targets]
    missing = [ob.name for ob in targets if arguments.objects and ob not in (live for _, live in pairs)]
    if missing or not pairs:
        raise CommandError(f"No baked copy of {', '.join(missing) or 'anything'}: bake with --save first")
    entries = []
    for copy, ob in pairs:
        frames = _frames(arguments, copy)
        if len(frames):
            entries.append(_compared(arguments, ob, copy, frames))
    is_fine = all(100.0 * each["max_error_relative"] <= arguments.error for each in entries)
    lines = [
        f"{each['name']}: largest error {100.0 * each['max_error_relative']:.2g} % of the size,"
        f" volume within {100.0 * each['volume_error_relative']:+.2g} %"
        for each in entries
    ]
    if not is_fine:
        lines.append(f"Further off than {arguments.error:g} %")
    return Outcome(is_fine, {"objects": entries}, lines)


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
) -> dict[str, Any]:
    made = job.Job(ob, Options("ABSOLUTE", frames, repair_folds=copy.turgor_bake.repair_folds))
    follow(made.verify(copy), arguments.progress)
    found = made.report.as_dict()
    return {name: found[name] for name in ("name", "frames", "size", "max_error_relative", "volume_error_relative")}
