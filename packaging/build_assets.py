"""Writes the shipped presets of joints as assets: one .blend for the asset browser, made by Blender itself."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path
from types import ModuleType

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
    scratch = bpy.data.node_groups.new("Scratch", "ShaderNodeTree").nodes.new("ShaderNodeFloatCurve")

    def table(curve: object) -> np.ndarray:
        curve_points.write(scratch.mapping, curve.points)
        sampled = curve_points.sample(scratch.mapping, 65)
        return np.concatenate([sampled[:0:-1], sampled]) if curve.is_symmetric else sampled

    for path in sorted(PRESETS.glob("*.py")):
        text = path.read_text(encoding="utf-8")
        curves = joint_preset.from_text(text).first.curves
        tables = [table(curve) for curve in curves] or [np.zeros(2)] * 3
        name = bpy.path.display_name(path.stem)
        joint_assets.create(name, text, profile_picture.picture(tables))
    bpy.data.node_groups.remove(scratch.id_data)
    output.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(output), compress=True)


if __name__ == "__main__":
    main()
