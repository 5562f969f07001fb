"""Installs the extension zip as an artist does, by Blender's own operator."""

from __future__ import annotations

import importlib
from pathlib import Path

import bpy


def install(archive: Path, resources: Path) -> None:
    """Installs and enables the zip; fails unless the engine then comes out of it."""
    bpy.ops.extensions.package_install_files(
        filepath=str(archive.resolve()), repo="user_default", enable_on_install=True
    )
    engine = Path(str(importlib.import_module("turgor").__file__))
    if not engine.is_relative_to(resources):
        raise SystemExit(f"the engine was loaded from {engine}, not from {archive}: the zip brings no wheel")
