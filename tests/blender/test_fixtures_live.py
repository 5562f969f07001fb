"""The characters of `blend_fixtures` keep the volume of every shell over every frame of their animation."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from measure import positions
from numpy.typing import NDArray
from test_exact import VOLUME_TOLERANCE
from tube import add_turgor

from blend_fixtures import CHARACTERS
from demo import enclosed_volume, evaluated

WRITTEN = sorted((Path(__file__).resolve().parents[2] / ".fixtures").glob("*.blend"))
FIXTURES = [path for path in WRITTEN if path.stem in CHARACTERS]
# A product and a sum of Blender's Armature are rounded too, not only what is stored.
ROUNDINGS = 3.0


@pytest.mark.skipif(not FIXTURES, reason="no fixtures written: run `make test`")
@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.stem)
def test_every_shell_keeps_its_volume_on_every_frame(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    meshes = [ob for ob in scene.objects if ob.type == "MESH" and ob.find_armature() is not None]
    assert meshes
    for ob in meshes:
        shells = evaluated.undeformed_shells(ob)
        ob.find_armature().data.pose_position = "REST"
        bpy.context.view_layer.update()
        rest = shells.volumes(positions(ob).astype(np.float64))
        ob.find_armature().data.pose_position = "POSE"
        add_turgor(ob)
        worst = np.zeros(shells.count)
        for frame in range(scene.frame_start, scene.frame_end + 1):
            scene.frame_set(frame)
            shown = positions(ob).astype(np.float64)
            error = np.abs(shells.volumes(shown) - rest) / np.abs(rest)
            allowed = np.maximum(VOLUME_TOLERANCE, ROUNDINGS * _rounding(shells, shown) / np.abs(rest))
            worst = np.maximum(worst, error / allowed)
        assert worst.max() < 1.0


def _rounding(shells: enclosed_volume.Shells, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(K,) most that rounding coordinates to single precision can change the volume of each shell."""
    half_ulp = np.abs(np.spacing(points.astype(np.float32))).astype(np.float64) / 2.0
    area = _areas(shells, points)
    largest = np.array([half_ulp[shells.vertex_shells == shell].max() for shell in range(shells.count)])
    return np.sqrt(3.0) * largest * area


def _areas(shells: enclosed_volume.Shells, points: NDArray[np.float64]) -> NDArray[np.float64]:
    welded = np.zeros((shells.welded.max() + 1, 3))
    welded[shells.welded] = points
    centres = np.array([welded[rim].mean(axis=0) for rim in shells.rims]).reshape(-1, 3)
    places = np.concatenate([welded, centres])
    a, b = places[shells.first], places[shells.second]
    corners = np.bincount(shells.face_of_edge)
    means = np.stack([np.bincount(shells.face_of_edge, axis) / corners for axis in a.T], axis=1)[shells.face_of_edge]
    parts = np.linalg.norm(np.cross(a - means, b - means), axis=1) / 2.0
    return np.bincount(shells.face_shells[shells.face_of_edge], parts, minlength=shells.count)
