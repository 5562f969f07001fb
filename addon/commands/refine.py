"""turgor refine: more faces where joints give volume back, in a copy of the file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import bpy

from ..live import refining
from ..logic.refined_levels import MOST_LEVELS
from ..logic.refined_region import Options
from ..scene import saving, stack
from . import arguments as shared
from .characters import objects_with_turgor
from .outcome import CommandError, Outcome

NAME = "refine"
HELP = "split faces where joints give volume back"
DESCRIPTION = (
    "Looks at the scene's frames, or its preview range. The refined characters go into the file given by --save; the"
    " opened one is never changed. Without --save it only tells how many vertices there would be. What is not given is"
    " as in the panel of each character."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    shared.add_objects(parser)
    add = parser.add_argument
    add("--threshold", type=_part, metavar="PART", help="least weight of a joint that loses volume, 0 to 1")
    add(
        "--levels", type=int, choices=range(1, MOST_LEVELS + 1), help="how often faces are split; the most if automatic"
    )
    add(
        "--automatic",
        action=argparse.BooleanOptionalAction,
        help="split only as often as the joints' profile curves need to be seen",
    )
    add("--method", choices=("linear", "smooth"), help="where new vertices lie")
    add("--save", type=Path, metavar="FILE", help="the .blend with the refined characters")


def run(arguments: argparse.Namespace) -> Outcome:
    """Raises outcome.CommandError, ValueError, OSError."""
    targets = [ob for ob in objects_with_turgor(arguments.objects) if stack.volume_modifier(ob) is not None]
    if not targets:
        raise CommandError("No object has Turgor Volume: there is nothing to refine")
    saving.check(arguments.save)
    objects = [_refined(ob, _options(arguments, ob)) for ob in targets]
    if arguments.save is not None:
        saving.save_copy(arguments.save)
    lines = [line for each in objects for line in _lines(each)]
    if arguments.save is None:
        lines.append("Nothing was written: give --save FILE")
    return Outcome(True, {"objects": objects}, lines)


def _options(arguments: argparse.Namespace, ob: bpy.types.Object) -> Options:
    found = refining.options_of(ob.turgor.refine)
    given = {
        "threshold": arguments.threshold,
        "levels": arguments.levels,
        "is_automatic": arguments.automatic,
        "is_smooth": None if arguments.method is None else arguments.method == "smooth",
    }
    return found._replace(**{name: value for name, value in given.items() if value is not None})


def _refined(ob: bpy.types.Object, options: Options) -> dict[str, Any]:
    before = len(ob.data.vertices)
    try:
        made = refining.refine(ob, options)
    except ValueError as error:
        raise CommandError(f"{ob.name}: {error}") from error
    return {
        "name": ob.name,
        "faces": made.all_face_count,
        "refined_faces": made.face_count,
        "vertices": before,
        "vertices_afterwards": made.vertex_count,
        "faces_short_of_levels": made.short_count,
        "levels": options.levels,
        "loose_modifiers": refining.loose_modifiers(ob.data) if made.face_count else [],
    }


def _lines(entry: dict[str, Any]) -> list[str]:
    lines = [
        f"{entry['name']}: {entry['refined_faces']:,} of {entry['faces']:,} faces refined,"
        f" {entry['vertices']:,} vertices before, {entry['vertices_afterwards']:,} now"
    ]
    if entry["faces_short_of_levels"]:
        lines.append(f"  {entry['faces_short_of_levels']:,} faces ask for more than {entry['levels']} levels")
    lines += [f"  {name} was bound to the mesh as it was: bind it again" for name in entry["loose_modifiers"]]
    return lines


def _part(text: str) -> float:
    """Raises argparse.ArgumentTypeError."""
    try:
        found = float(text)
    except ValueError:
        found = -1.0
    if not 0.0 <= found <= 1.0:
        raise argparse.ArgumentTypeError(f"{text!r}: need a number from 0 to 1")
    return found
