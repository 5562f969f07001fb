"""Reduced keys local to joints: the error asked for, nothing moved beyond the bones that meet, names that say where."""

from __future__ import annotations

import importlib
from pathlib import Path

import bpy
import numpy as np
import pytest
from tube import LAST_FRAME, add_turgor, bend, place, rig, tube_mesh

REPOSITORY = Path(__file__).resolve().parents[2]
ELEPHANT = REPOSITORY / ".fixtures" / "elephant.blend"
ERROR = 1e-3


def _tube() -> tuple[bpy.types.Object, np.ndarray]:
    armature = rig(bone_count=5)
    ob = place("Tube", tube_mesh(), armature)
    bend(armature, 0.5)
    return ob, np.arange(1.0, LAST_FRAME + 1.0)


def _elephant() -> tuple[bpy.types.Object, np.ndarray]:
    if not ELEPHANT.is_file():
        pytest.skip("no fixtures written: run `make test`")
    bpy.ops.wm.open_mainfile(filepath=str(ELEPHANT))
    ob = next(ob for ob in bpy.context.scene.objects if ob.type == "MESH" and ob.find_armature() is not None)
    return ob, np.arange(1.0, 40.0, 6.0)


@pytest.mark.parametrize("unit_values", [False, True], ids=["signed", "unit"])
@pytest.mark.parametrize("build", [_tube, _elephant], ids=["tube", "elephant"])
def test_keys_hold_the_error_and_move_nothing_beyond_their_joint(addon, build, unit_values: bool):
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    ob, frames = build()
    add_turgor(ob)
    chosen = options.Options(
        "REDUCED",
        frames,
        tolerance=ERROR,
        tolerance_is_relative=True,
        local_keys=True,
        unit_values=unit_values,
        name="Baked",
    )
    made = job.Job(ob, chosen)
    assert list(made.run())
    assert made.report.max_error <= ERROR * made.report.size
    blocks = made.baked.data.shape_keys.key_blocks
    assert made.report.key_count == len(blocks) - 1 > 0
    holders = _holders(made.baked)
    rest, bones = _points(blocks[0]), ob.find_armature().data.bones
    ranks: dict[str, list[int]] = {}
    for key in blocks[1:]:
        bone, _, rank = key.name.rpartition(" ")
        ranks.setdefault(bone, []).append(int(rank))
        moved = np.flatnonzero((_points(key) != rest).any(axis=1))
        assert 0 < len(moved) < 0.7 * len(rest)
        meeting = {bone, *(above.name for above in bones[bone].parent_recursive)}
        assert all(meeting & holders[vertex] for vertex in moved)
        assert key.slider_min >= (0.0 if unit_values else -1.0)
    assert len(ranks) > 1
    assert all(found == list(range(1, len(found) + 1)) for found in ranks.values())


def _holders(ob: bpy.types.Object) -> list[set[str]]:
    """Bones that hold each vertex."""
    names = [group.name for group in ob.vertex_groups]
    return [{names[member.group] for member in vertex.groups} for vertex in ob.data.vertices]


def _points(key: bpy.types.ShapeKey) -> np.ndarray:
    points = np.empty((len(key.points), 3), np.float32)
    key.points.foreach_get("co", points.ravel())
    return points
