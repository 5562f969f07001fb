"""A file with characters, the zip of the extension, and an executable that stands for Blender's."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("bpy", reason="runs inside Blender's Python module")

REPOSITORY = Path(__file__).resolve().parents[2]
# Enough points that a chunk takes a while.
SCENE = """
import os, sys
sys.path[:0] = sys.argv[1:3]
import bpy, addon
bpy.ops.wm.read_factory_settings(use_empty=True)
addon.register()
from tube import add_turgor, character
ob, _ = character(rings=600, segments=64)
add_turgor(ob)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[3])
os._exit(0)
"""


@pytest.fixture(scope="session")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("farm") / "shot.blend"
    folders = [str(REPOSITORY), str(REPOSITORY / "tests/blender")]
    subprocess.run([sys.executable, "-c", SCENE, *folders, str(path)], check=True, stdout=subprocess.DEVNULL)
    return path


@pytest.fixture(scope="session")
def archive() -> Path:
    archives = sorted((REPOSITORY / "dist").glob("turgor-*.zip"))
    if not archives:
        pytest.skip("no zip in dist/: run `make package`")
    return archives[-1]


@pytest.fixture(scope="session")
def blender(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Blender's executable, or what stands for it: BLENDER names a real one."""
    if "BLENDER" in os.environ:
        return Path(os.environ["BLENDER"])
    path = tmp_path_factory.mktemp("bin") / "blender"
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{Path(__file__).with_name("blender_of_bpy.py")}" "$@"\n')
    path.chmod(0o755)
    return path
