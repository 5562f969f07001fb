"""The characters of `blend_fixtures` keep the volume of their rest pose over their animation."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from measure import relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import add_turgor

from blend_fixtures import CHARACTERS

WRITTEN = sorted((Path(__file__).resolve().parents[2] / ".fixtures").glob("*.blend"))
FIXTURES = [path for path in WRITTEN if path.stem in CHARACTERS]
FRAME_COUNT = 12


@pytest.mark.skipif(not FIXTURES, reason="no fixtures written: run `make test`")
@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.stem)
def test_fixture_keeps_its_volume(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    meshes = [ob for ob in scene.objects if ob.type == "MESH" and ob.find_armature() is not None]
    assert meshes
    for ob in meshes:
        ob.find_armature().data.pose_position = "REST"
        bpy.context.view_layer.update()
        rest = volume(ob)
        ob.find_armature().data.pose_position = "POSE"
        add_turgor(ob)
        for frame in np.linspace(scene.frame_start, scene.frame_end, FRAME_COUNT):
            scene.frame_set(int(frame))
            assert relative_error(ob, rest) < VOLUME_TOLERANCE
