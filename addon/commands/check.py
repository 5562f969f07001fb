"""turgor check: whether the file will render right on this machine."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import Any

import bpy
import turgor

from .. import runtime
from ..live import binding, spine_binding, twins
from ..logic.finding import Finding
from ..messages import of_error
from ..properties.character import DATA_VERSION
from ..scene import baked_copy, scene_drivers, stack
from . import arguments as shared
from .characters import objects_with_turgor, subjects_of
from .outcome import Outcome

NAME = "check"
HELP = "tell whether the file will render right on this machine"
DESCRIPTION = (
    "Looks at the engine, at missing files, and at everything that is off with each character, on several frames."
    " Exit code 1 if anything would show plain skinning or is not as it should be; 0 if there are hints only."
)
OFF = ("ERROR", "WARNING")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    shared.add_objects(parser)
    shared.add_frames(parser, "first, middle and last of the scene")


def run(arguments: argparse.Namespace) -> Outcome:
    """Raises outcome.CommandError."""
    scene = bpy.context.scene
    first, last = scene.frame_start, max(scene.frame_start, scene.frame_end)
    frames = [first, (first + last) // 2, last] if arguments.frames is None else arguments.frames.tolist()
    targets = objects_with_turgor(arguments.objects)
    subjects = [subject for ob in targets for subject in subjects_of(ob)]
    for subject in subjects:
        (binding if subject.modifier == "VOLUME" else spine_binding).refresh_state(subject.object)
    found: list[dict[Finding, float | None]] = [{} for _ in subjects]
    for frame in sorted(set(frames)):
        scene.frame_set(int(frame // 1), subframe=frame % 1.0)
        for subject, seen in zip(subjects, found, strict=True):
            # Of the frame where it is seen first; what holds on any frame has none.
            always = (*subject.state.bind_findings, *subject.state.standing_findings)
            for each in subject.state.findings:
                seen.setdefault(each, None if each in always else float(frame))
    for subject, seen in zip(subjects, found, strict=True):
        seen |= dict.fromkeys(_unsampled(subject.object))
    of_file = file_findings()
    objects = [
        {
            "name": subject.object.name,
            "modifier": subject.modifier,
            "findings": [{**asdict(each), "frame": frame} for each, frame in seen.items()],
        }
        for subject, seen in zip(subjects, found, strict=True)
    ]
    session = runtime.session
    every = [*of_file, *(each for seen in found for each in seen)]
    data: dict[str, Any] = {
        "blender": bpy.app.version_string,
        "engine": turgor.__version__,
        "route": session.route,
        "route_reason": session.route_reason,
        "findings": [asdict(each) for each in of_file],
        "objects": objects,
    }
    return Outcome(not any(each.severity in OFF for each in every), data, _lines(of_file, objects, data))


def _unsampled(ob: bpy.types.Object) -> list[Finding]:
    """Findings about drivers for which a bake would be refused, though renders are as they should be."""
    spine = ob.turgor_spine
    armature = stack.armature_modifier(ob)
    followed = (ob, spine.rig, spine.curve, None if armature is None else armature.object, *twins.of(ob))
    try:
        scene_drivers.check(bpy.context.scene, [each for each in followed if each is not None])
    except scene_drivers.SceneDriverError as error:
        return [Finding("scene_driver", "INFO", of_error(error))]
    return []


def file_findings() -> list[Finding]:
    """What is off with the file as a whole."""
    found = []
    for library in bpy.data.libraries:
        if library.is_missing:
            text = f"Linked file {library.filepath} is missing: characters from it are not in the picture"
            found.append(Finding("missing_library", "ERROR", text, subject=library.name))
    if bpy.app.autoexec_fail:
        text = f"Python in the file was not run ({bpy.app.autoexec_fail_message}): allow it with --enable-autoexec"
        found.append(Finding("scripts_blocked", "WARNING", text))
    for ob in bpy.data.objects:
        for path in baked_copy.point_caches(ob):
            if not Path(path).is_file():
                text = f"Point cache {path} of {ob.name} is missing: it stands still"
                found.append(Finding("missing_point_cache", "ERROR", text, subject=ob.name))
        if ob.type == "MESH" and max(ob.turgor.version, 0) > DATA_VERSION:
            text = f"{ob.name} was saved by a newer Turgor: update the extension on this machine"
            found.append(Finding("newer_file", "WARNING", text, subject=ob.name))
    return found


def _lines(of_file: list[Finding], objects: list[dict[str, Any]], data: dict[str, Any]) -> list[str]:
    lines = [f"Blender {data['blender']}, engine {data['engine']}"]
    if data["route"]:
        lines[0] += f", route {data['route']} ({data['route_reason']})"
    lines += [f"{each.severity}: {each.text}" for each in of_file]
    for each in objects:
        lines.append(f"{each['name']} ({each['modifier']})" + ("" if each["findings"] else ": fine"))
        for finding in each["findings"]:
            at = "" if finding["frame"] is None else f"frame {finding['frame']:g}: "
            lines.append(f"  {finding['severity']}: {at}{finding['text']}")
    if not objects:
        lines.append("No object has Turgor")
    return lines
