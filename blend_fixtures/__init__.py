"""Scene fixtures, modelled, rigged and animated by script.

`build("elephant")` works in the current, empty Blender file; `python -m blend_fixtures OUT_DIR` writes one .blend each.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy

from . import bent_cylinder, dolphin, elephant, four_bone_chain, giraffe, snake, three_segment_cylinder, twist_chain
from .character import Character
from .curve_rider import CurveRider

CHARACTERS: dict[str, Callable[[], Character]] = {
    "bent_cylinder": bent_cylinder.build,
    "three_segment_cylinder": three_segment_cylinder.build,
    "four_bone_chain": four_bone_chain.build,
    "twist_chain": twist_chain.build,
    "elephant": elephant.build,
    "giraffe": giraffe.build,
    "snake": snake.build,
}
CURVE_RIDERS: dict[str, Callable[[], CurveRider]] = {"dolphin": dolphin.build}
NAMES: tuple[str, ...] = (*CHARACTERS, *CURVE_RIDERS)

__all__ = ["CHARACTERS", "CURVE_RIDERS", "NAMES", "Character", "CurveRider", "build", "write"]


def build(name: str) -> Character | CurveRider:
    """The fixture, built into the current Blender file: its `body` and the `armature` or `curve` that bends it."""
    builders = {**CHARACTERS, **CURVE_RIDERS}
    if name not in builders:
        raise ValueError(f"no fixture is called {name!r}: there are {', '.join(NAMES)}")
    return builders[name]()


def write(name: str, directory: Path) -> Path:
    """Build one fixture in a fresh Blender file and save it as `directory/name.blend`."""
    path = directory.resolve() / f"{name}.blend"
    path.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    build(name)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    return path
