"""turgor bake: a copy that shows the same without Turgor, made by one machine or by many."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .. import runtime
from ..bake import job
from ..bake.baking import Progress
from ..bake.options import Options
from ..logic import frame_range
from ..scene import saving
from . import arguments as shared
from .characters import baked_copies, objects_with_turgor
from .outcome import CommandError, Outcome

NAME = "bake"
HELP = "make copies that show the same without Turgor"
DESCRIPTION = (
    "Copies with shape keys or a point cache go into the file given by --save; the opened one is never changed."
    " Reports, caches and finished chunks go into the output folder: a bake that was killed goes on from there, and so"
    " does one whose chunks were computed by other machines with --part."
)
METHODS = ("absolute", "corrective", "reduced", "driven", "point-cache")
OF_SIZE = "in percent of the size (default: %(default)s)"
# What may be other on each run, or in another place.
NOT_IN_DATA = {"format", "seconds", "resumed_chunks", "source"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    shared.add_objects(parser)
    shared.add_frames(parser)
    add = parser.add_argument
    add("--method", choices=METHODS, default="absolute", help="what keeps the result (default: %(default)s)")
    add("--error", type=float, default=0.1, metavar="PERCENT", help=f"largest of reduced and driven keys, {OF_SIZE}")
    add("--unit-values", action="store_true", help="reduced keys with values from 0 to 1 only")
    shared.add_switch(parser, "--local", "reduced keys that move the skin around one joint each")
    add("--most-keys", type=int, default=64, metavar="N", help="driven keys at most (default: %(default)s)")
    add("--influences", type=int, default=0, metavar="N", help="bones per vertex where corrective keys go; 0: all")
    add("--linear", action="store_true", help="where corrective keys go, bones are blended linearly")
    shared.add_switch(parser, "--repair-folds", "repair folds, also where the character does not")
    add("--output", type=Path, metavar="FOLDER", help="for reports, caches, chunks (default: turgor_bake by the file)")
    add("--save", type=Path, metavar="FILE", help="the .blend with the copies")
    shared.add_switch(parser, "--overwrite", "overwrite files of other characters and scenes in that folder")
    add("--no-verify", action="store_true", help="do not play the copies and compare them")
    shared.add_live_frames(parser)
    add("--chunk-frames", type=int, default=0, metavar="N", help="frames of a chunk, the same for all parts")
    shared.add_part(parser, "compute the share of the chunks")
    shared.add_progress(parser)


def run(arguments: argparse.Namespace) -> Outcome:
    """Raises outcome.CommandError, BakeError, whole_file.WriteError, turgor.TurgorError."""
    scene = bpy.context.scene
    targets = objects_with_turgor(arguments.objects)
    if not targets:
        raise CommandError("No object has Turgor: there is nothing to bake")
    frames = shared.chosen_frames(arguments, scene)
    folder = output_folder(arguments)
    if arguments.part is None:
        if arguments.save is None and arguments.method != "point-cache":
            raise CommandError("Shape keys are kept in a file: give --save FILE, or --part K/N for chunks only")
        saving.check(arguments.save)
        taken = [copy.name for copy, ob in baked_copies() if ob in targets]
        if taken:
            raise CommandError(f"The file has a bake already: remove {', '.join(taken)} first")
    reports = []
    for number, ob in enumerate(targets):
        options = options_of(arguments, ob, frames, folder)
        made = job.Job(ob, options)
        steps = made.run(clears=False) if arguments.part is None else made.compute(arguments.part.of(made.chunk_count))
        follow(steps, arguments.progress, number, len(targets))
        reports.append(made)
        if arguments.part is None:
            _remember(ob, made, frames, repair_folds=arguments.repair_folds)
    if arguments.part is not None:
        return _of_chunks(arguments, reports)
    if arguments.save is not None:
        for ob in targets:
            saving.hide(ob)
        saving.save_copy(arguments.save)
    # Not before: a process that ends while it saves has lost nothing.
    for made in reports:
        made.clear()
    entries = [_entry(made) for made in reports]
    lines = [line for made in reports for line in (made.report.name, *(f"  {each}" for each in made.report.lines()))]
    return Outcome(True, {"objects": entries}, lines)


def output_folder(arguments: argparse.Namespace) -> Path:
    """Raises CommandError for a file that was never saved."""
    if arguments.output is not None:
        return arguments.output.absolute()
    if not bpy.data.filepath:
        raise CommandError("The file has no name yet: give --output FOLDER")
    return Path(bpy.data.filepath).parent / "turgor_bake"


def options_of(arguments: argparse.Namespace, ob: bpy.types.Object, frames: np.ndarray, folder: Path | None) -> Options:
    """Raises CommandError."""
    return Options(
        method=arguments.method.upper().replace("-", "_"),
        frames=frames,
        tolerance=0.01 * arguments.error,
        tolerance_is_relative=True,
        unit_values=arguments.unit_values,
        local_keys=arguments.local,
        influences=arguments.influences,
        use_linear=arguments.linear,
        most_keys=arguments.most_keys,
        folder=folder,
        overwrite=arguments.overwrite,
        live_frames=arguments.live_frames,
        verify=not arguments.no_verify,
        repair_folds=arguments.repair_folds,
        name=f"{ob.name} Baked",
        chunk_frames=arguments.chunk_frames,
    )


def follow(steps: Iterator[Progress], style: str, number: int = 0, count: int = 1) -> None:
    """Do the work of one of `count` objects."""
    with runtime.quiet(), closing(steps):
        for progress in steps:
            if style == "openjd":
                print(f"openjd_progress: {100.0 * (number + progress.part) / count:.1f}")
                print(f"openjd_status: {progress.text}")
                sys.stdout.flush()


def _remember(ob: bpy.types.Object, made: job.Job, frames: np.ndarray, *, repair_folds: bool) -> None:
    """Keep on the copy and its character what the bake was, for the panel and for the command `verify`."""
    copy, lines = made.baked, "\n".join(made.report.lines())
    copy.turgor_bake.frames = frame_range.text_of(frames)
    copy.turgor_bake.repair_folds = repair_folds
    for each, other in ((copy, ob), (ob, copy)):
        if each.library is None:
            each.turgor_bake.other, each.turgor_bake.report = other, lines


def _of_chunks(arguments: argparse.Namespace, jobs: list[job.Job]) -> Outcome:
    entries = [
        {"name": made.report.name, "chunks": list(arguments.part.of(made.chunk_count)), "chunk_count": made.chunk_count}
        for made in jobs
    ]
    lines = [f"{each['name']}: {len(each['chunks'])} of {each['chunk_count']} chunks are there" for each in entries]
    return Outcome(True, {"part": "{}/{}".format(*arguments.part), "objects": entries}, lines)


def _entry(made: job.Job) -> dict[str, Any]:
    return {name: value for name, value in made.report.as_dict().items() if name not in NOT_IN_DATA}
