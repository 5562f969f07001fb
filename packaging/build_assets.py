"""Writes the shipped presets of joints as assets: one .blend for the asset browser, made by Blender itself."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np

ADDON = Path(__file__).resolve().parent.parent / "addon"
PRESETS = ADDON / "presets" / "turgor" / "joint"


def parts_of_addon() -> tuple[ModuleType, ...]:
    """What knows presets and assets, without the start of the add-on, which needs the engine."""
    package = ModuleType("addon")
    package.__path__ = [str(ADDON)]
    sys.modules.setdefault("addon", package)
    names = ("logic.joint_preset", "logic.profile_picture", "scene.curve_points", "scene.joint_assets")
    return tuple(importlib.import_module(f"addon.{name}") for name in names)


def main() -> None:
    """Writes the file named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path)
    output = parser.parse_args().output
    joint_preset, profile_picture, curve_points, joint_assets = parts_of_addon()

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scratch: Any = bpy.data.node_groups.new("Scratch", "ShaderNodeTree")
    mapping = scratch.nodes.new("ShaderNodeFloatCurve").mapping

    def table(curve: Any) -> np.ndarray:
        curve_points.write(mapping, curve.points)
        sampled = curve_points.sample(mapping, 65)
        return np.concatenate([sampled[:0:-1], sampled]) if curve.is_symmetric else sampled

    for path in sorted(PRESETS.glob("*.py")):
        text = path.read_text(encoding="utf-8")
        curves = joint_preset.from_text(text).first.curves
        # What the engine draws by itself has no curves here, and Blender's own icon.
        picture = profile_picture.picture([table(curve) for curve in curves]) if curves else None
        joint_assets.create(path.stem.replace("_", " "), text, picture)
    bpy.data.node_groups.remove(scratch)
    output.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(output), compress=True)


if __name__ == "__main__":
    main()
