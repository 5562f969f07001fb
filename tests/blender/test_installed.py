"""The built zip, installed by Blender's own operator into an empty home, as an artist does."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
CHILD = """
import importlib, os, sys
import bpy, numpy
# The engine must come out of the zip, not out of this environment.
sys.path[:] = [sys.argv[1], *(path for path in sys.path if not path.endswith("site-packages"))]
bpy.ops.extensions.package_install_files(filepath=sys.argv[2], repo="user_default", enable_on_install=True)
bpy.ops.wm.read_homefile(use_empty=True)
import turgor
assert turgor.__file__.startswith(os.environ["BLENDER_USER_RESOURCES"]), turgor.__file__
from measure import relative_error, volume
from tube import add_turgor, character
ob, _ = character()
rest = volume(ob)
add_turgor(ob)
bpy.context.scene.frame_set(15)
print("RELATIVE ERROR", relative_error(ob, rest))
print("ROUTE", importlib.import_module("bl_ext.user_default.turgor.runtime").session.route)
sys.stdout.flush()
os._exit(0)
"""


def _archive() -> Path:
    archives = sorted((REPOSITORY / "dist").glob("turgor-*.zip"))
    if not archives:
        pytest.skip("no zip in dist/: run `make package`")
    return archives[-1]


def test_installed_zip_corrects_a_character(tmp_path):
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(tmp_path)}
    arguments = [sys.executable, "-c", CHILD, str(Path(__file__).parent), str(_archive())]
    done = subprocess.run(arguments, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = dict(line.rsplit(" ", 1) for line in done.stdout.splitlines() if line.startswith(("RELATIVE", "ROUTE")))
    assert float(lines["RELATIVE ERROR"]) < 1e-6
    assert lines["ROUTE"] == "PULL"
