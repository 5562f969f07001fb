"""What was exported, imported again and compared with the live characters, by a Blender of its own.

Importers change the file that is open: here nothing of it does. The other Blender has factory settings and runs
`scene/imported.py` alone, without the extension.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy

from ..messages import message
from ..scene import imported
from .exports import WITH_KEYS, Settings

# Frames that are compared, at most.
COMPARED_FRAMES = 9
# How far the volume may be off: thin limbs lose more than the error of their vertices says.
VOLUME_PERCENT = 0.1
# A Blender that takes longer than this many seconds hangs.
LONGEST = 600.0
_CHILD = "import sys; sys.path.append({addon!r}); from scene import imported; imported.answer({folder!r})"


class ReimportError(ValueError):
    """The file could not be compared; says why."""


def compared_frames(scene: bpy.types.Scene) -> list[int]:
    """Evenly over the scene's range, the first and the last among them."""
    first, last = scene.frame_start, max(scene.frame_start, scene.frame_end)
    return sorted({first + (last - first) * part // (COMPARED_FRAMES - 1) for part in range(COMPARED_FRAMES)})


def tolerance_percent(settings: Settings) -> float:
    """How far a vertex may be off, of the size."""
    return imported.FLOOR_PERCENT + (100.0 * settings.error_relative if settings.format in WITH_KEYS else 0.0)


def compare(targets: Sequence[bpy.types.Object], settings: Settings) -> dict[str, imported.Difference]:
    """By name of the object. The scene is as it was. Raises ReimportError."""
    scene = bpy.context.scene
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        live = {ob.name: imported.live(ob, compared_frames(scene)) for ob in targets}
    finally:
        scene.frame_set(frame, subframe=subframe)
    with TemporaryDirectory() as folder:
        imported.ask(Path(folder), settings.path, settings.format, live)
        _run(_CHILD.format(addon=str(Path(__file__).parents[1]), folder=folder))
        answer = Path(folder) / imported.ANSWER
        if not answer.is_file():
            raise ReimportError(message("{file} was not compared: Blender ended early", file=settings.path.name))
        found = json.loads(answer.read_text())
    if isinstance(found, str):
        raise ReimportError(found)
    return {name: imported.Difference(*each) for name, each in found.items()}


def _run(script: str) -> None:
    if bpy.app.binary_path:
        command = [bpy.app.binary_path, "--background", "--factory-startup", "--python-expr", script]
    else:
        command = [sys.executable, "-c", f"import bpy; {script}"]
    try:
        subprocess.run(command, capture_output=True, timeout=LONGEST, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ReimportError(message("The file was not compared: {reason}", reason=str(error))) from error
