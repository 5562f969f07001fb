"""turgor export: characters for other programs, read again and compared with the live ones."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import bpy

from ..bake import exports, reimport
from ..scene import imported
from . import arguments as shared
from .characters import objects_with_turgor
from .outcome import CommandError, Outcome

NAME = "export"
HELP = "write glTF, FBX, USD or Alembic that keep the volume"
DESCRIPTION = (
    "The suffix of FILE names the format. The file is imported again and compared with the live characters on several"
    " frames: exit code 1 if any vertex or the volume is further off than asked for."
)
FORMATS = {".glb": "GLTF", ".gltf": "GLTF", ".fbx": "FBX", ".abc": "ALEMBIC"} | dict.fromkeys(
    (".usd", ".usda", ".usdc", ".usdz"), "USD"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("file", type=Path, metavar="FILE", help=f"to write: {', '.join(FORMATS)}")
    shared.add_objects(parser)
    add("--frames", type=shared.frames, metavar="A-B", help="first and last frame (default: the scene's)")
    add(
        "--error",
        type=float,
        default=0.01,
        metavar="PERCENT",
        help="largest of shape keys, in percent of the size; 0: one key per frame (default: %(default)s)",
    )
    add("--influences", type=int, default=4, metavar="N", help="bones per vertex, 0 for all (default: %(default)s)")
    add("--local", action="store_true", help="shape keys that move the skin around one joint each")
    add("--no-verify", action="store_true", help="do not import the file again")
    add(
        "--tolerance",
        type=float,
        metavar="PERCENT",
        help="how far any vertex may be off, in percent of the size (default: a little more than --error)",
    )
    add(
        "--volume-tolerance",
        type=float,
        default=reimport.VOLUME_PERCENT,
        metavar="PERCENT",
        help="how far the volume may be off; thin limbs lose more than --error says (default: %(default)s)",
    )


def run(arguments: argparse.Namespace) -> Outcome:
    """Ends in an empty file where it verifies. Raises outcome.CommandError and what `exports.export` raises."""
    targets, scene = objects_with_turgor(arguments.objects), bpy.context.scene
    kind = FORMATS.get(arguments.file.suffix.lower())
    if kind is None:
        raise CommandError(f"{arguments.file.name}: need a name that ends in one of {', '.join(FORMATS)}")
    if not targets:
        raise CommandError("No object has Turgor: there is nothing to export")
    if arguments.frames is not None:
        scene.frame_start, scene.frame_end = int(arguments.frames[0]), int(arguments.frames[-1])
    arguments.file.parent.mkdir(parents=True, exist_ok=True)
    settings = exports.Settings(
        kind, arguments.file.absolute(), 0.01 * arguments.error, arguments.influences, local_keys=arguments.local
    )
    replaced = arguments.file.exists()
    reports = exports.export(targets, settings)
    data: dict[str, Any] = {"frames": f"{scene.frame_start}-{scene.frame_end}", "format_name": kind}
    data["objects"] = [{"name": report.name, "keys": report.key_count, "notes": report.notes} for report in reports]
    lines = [f"{report.name}: {report.key_count} shape keys" for report in reports]
    lines += [f"  {note}" for report in reports for note in report.notes]
    if replaced:
        lines.append(f"{arguments.file.name} was there before and is replaced")
    if arguments.no_verify:
        return Outcome(True, data, lines)
    if any(note for report in reports for note in report.notes):
        lines.append("Modifiers after Turgor are not in the file: it cannot be compared, give --no-verify")
        return Outcome(False, data, lines)
    frames = reimport.compared_frames(scene)
    live = {ob.name: imported.live(ob, frames) for ob in targets}
    found = imported.compare(settings.path, kind, live)
    tolerance = arguments.tolerance
    if tolerance is None:
        tolerance = reimport.tolerance_percent(settings)
    data["verified"] = [{"name": name, **each._asdict()} for name, each in found.items()]
    lines += [
        f"{name}: imported again, largest error {100.0 * each.max_error_relative:.2g} % of the size,"
        f" volume within {100.0 * each.volume_error_relative:.2g} %"
        for name, each in found.items()
    ]
    off = [
        name
        for name, each in found.items()
        if 100.0 * each.max_error_relative > tolerance
        or 100.0 * each.volume_error_relative > arguments.volume_tolerance
    ]
    if off:
        lines.append(
            f"Further off than {tolerance:g} %, or {arguments.volume_tolerance:g} % of the volume: {', '.join(off)}"
        )
    return Outcome(not off, data, lines)
