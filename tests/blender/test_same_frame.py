"""Frame N looks the same however it was reached, bit for bit."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
from measure import positions
from tube import LAST_FRAME, add_turgor, character

FRAME = 13
CHILD = """
import sys, importlib
sys.path[:0] = sys.argv[1:3]
import bpy, numpy
importlib.import_module("addon").register()
bpy.ops.wm.open_mainfile(filepath=sys.argv[3])
from measure import positions
bpy.context.scene.frame_set(int(sys.argv[5]))
numpy.save(sys.argv[4], positions(bpy.data.objects["Tube"]))
sys.stdout.flush()
import os
os._exit(0)
"""


def _at(frame: int) -> np.ndarray:
    bpy.context.scene.frame_set(frame)
    return positions(bpy.data.objects["Tube"])


def test_scrubbing_and_jumping_agree(route):
    ob, _ = character()
    add_turgor(ob)
    jumped = _at(FRAME)
    for frame in [*range(1, LAST_FRAME + 1), 3, 17, 1]:
        _at(frame)
    assert (_at(FRAME) == jumped).all()
    bpy.context.scene.frame_set(FRAME - 1, subframe=0.5)
    assert (_at(FRAME) == jumped).all()


def test_saving_and_loading_agree(route, tmp_path):
    ob, _ = character()
    add_turgor(ob)
    expected = _at(FRAME)
    for frame_when_saved in (1, FRAME, LAST_FRAME):
        bpy.context.scene.frame_set(frame_when_saved)
        path = str(tmp_path / f"{frame_when_saved}.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        assert (_at(FRAME) == expected).all()
        bpy.ops.wm.open_mainfile(filepath=path)
        assert (positions(bpy.data.objects["Tube"]) == _at(frame_when_saved)).all()
        assert (_at(FRAME) == expected).all()


def test_another_session_agrees(tmp_path):
    ob, _ = character()
    add_turgor(ob)
    expected = _at(FRAME)
    path, result = tmp_path / "saved.blend", tmp_path / "positions.npy"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    here = Path(__file__).parent
    arguments = [str(here.parents[1]), str(here), str(path), str(result), str(FRAME)]
    subprocess.run([sys.executable, "-c", CHILD, *arguments], check=True, timeout=120)
    assert (np.load(result) == expected).all()


def test_undo_and_redo_agree(route):
    ob, _ = character()
    bpy.ops.ed.undo_push(message="before")
    plain = _at(FRAME)
    add_turgor(ob)
    expected = _at(FRAME)
    bpy.ops.ed.undo_push(message="added")
    bpy.data.objects["Rig"].location.x = 1.0
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    assert (_at(FRAME) == expected).all()
    bpy.ops.ed.undo()
    assert (_at(FRAME) == plain).all()
    bpy.ops.ed.redo()
    assert (_at(FRAME) == expected).all()
