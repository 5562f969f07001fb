"""Installs the extension zip as an artist does, by Blender's own operators."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy

MODULE = "bl_ext.user_default.turgor"


@contextmanager
def installed(archive: Path, resources: Path) -> Iterator[None]:
    """Within it the zip is installed and enabled; fails unless the engine then comes out of it."""
    path = str(archive.resolve())
    bpy.ops.extensions.package_install_files(filepath=path, repo="user_default", enable_on_install=True)
    engine = Path(str(importlib.import_module("turgor").__file__))
    if not engine.is_relative_to(resources):
        raise SystemExit(f"the engine was loaded from {engine.parent}, not from {archive}: uninstall it there")
    try:
        yield
    finally:
        bpy.ops.preferences.addon_disable(module=MODULE)
