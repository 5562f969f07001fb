"""The line around what a picture shows."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("bpy", reason="demo.outline reads pictures with Blender")
from demo.outline import outline, read_picture, write_picture

SQUARE = np.zeros((40, 60), np.float32)
SQUARE[10:30, 20:40] = 1.0


def test_outline_runs_along_the_border_only():
    line = outline(SQUARE)
    assert line.shape == SQUARE.shape
    assert (line[10, 20:40] == 1.0).all()
    assert (line[14:26, 24:36] == 0.0).all()
    assert (line[:6] == 0.0).all()


def test_what_reaches_the_edge_of_the_picture_has_no_border_there():
    half = np.zeros((40, 60), np.float32)
    half[:, :30] = 1.0
    assert outline(half)[:, :25].max() == 0.0
    assert (outline(half)[:, 30] == 1.0).all()


def test_pictures_are_written_as_they_were_read(tmp_path):
    pixels = np.random.default_rng(1).integers(0, 256, (8, 12, 4)).astype(np.float32) / 255.0
    pixels[..., 3] = 1.0
    write_picture(tmp_path / "picture.png", pixels)
    assert np.abs(read_picture(tmp_path / "picture.png") - pixels).max() < 1e-6
