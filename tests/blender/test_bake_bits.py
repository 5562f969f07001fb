"""A bake computes what the live engine does, to the last bit: poses sampled apart, many frames at a time."""

from __future__ import annotations

import importlib
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
import pytest
from body import add_spine
from numpy.typing import NDArray
from tube import LAST_FRAME, add_turgor, bend, character, place, rig, set_strength

from blend_fixtures import CHARACTERS

FIXTURES = [
    path
    for path in sorted((Path(__file__).resolve().parents[2] / ".fixtures").glob("*.blend"))
    if path.stem in CHARACTERS
]


def _assert_bits(ob: bpy.types.Object, frames: NDArray[np.float64]) -> None:
    volume_frames = importlib.import_module("addon.bake.volume_frames")
    source = volume_frames.VolumeFrames(ob)
    samples = list(source.samples(frames))
    count = len(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices)
    baked = np.full((len(frames), count, 3), np.nan, np.float32)
    source.compute(samples, baked, np.zeros((len(frames), 3), np.int32))
    for frame, row in zip(frames, baked, strict=True):
        assert np.array_equal(row, _live(ob, frame)), (ob.name, frame)
    assert len({row.tobytes() for row in baked}) > 1


def _live(ob: bpy.types.Object, frame: float) -> NDArray[np.float32]:
    """(N, 3) by the engine, in double precision until the end, as the getter asks it."""
    live = importlib.import_module("addon.live.frame")
    runtime = importlib.import_module("addon.runtime")
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
    state = runtime.character(ob.session_uid)
    target = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    asked = live.read(target, state, state.binding)
    found = asked.engine.deform(asked.pose_matrices, **asked.options)
    effect = importlib.import_module("addon.scene.modifier_inputs").read_input(
        target.modifiers["Turgor Volume"], importlib.import_module("addon.scene.node_group").STRENGTH
    )
    room = np.zeros(found.offsets.shape, np.float32)
    asked.engine.deform_into_address(room.ctypes.data, len(room), asked.pose_matrices, **asked.options)
    assert np.array_equal(room, found.offsets)
    return (found.skinned + effect * found.offsets.astype(np.float64)).astype(np.float32)


@pytest.mark.skipif(not FIXTURES, reason="no fixtures written: run `make test`")
@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.stem)
def test_fixtures(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    for ob in [ob for ob in scene.objects if ob.type == "MESH" and ob.find_armature() is not None]:
        add_turgor(ob)
        _assert_bits(ob, np.arange(scene.frame_start, scene.frame_end + 1, 3.0))


def _of_tetrahedra(shells: list[tuple[int, int, int, int]]) -> bpy.types.Mesh:
    points = [(0, 0, 2), (1, 0, 2.1), (1, 1, 2.5), (0.9, 0.2, 1), (-2, 0, 2), (-2, 2, 2.3), (-1.7, 0.2, 0.5)]
    mesh = bpy.data.meshes.new("Shared")
    mesh.from_pydata(
        points, [], [face for a, b, c, d in shells for face in ((a, c, b), (a, b, d), (b, c, d), (c, a, d))]
    )
    return mesh


@pytest.mark.parametrize("shells", [[(0, 1, 2, 3), (0, 5, 4, 6)], [(0, 5, 4, 6), (0, 1, 2, 3)]])
def test_shells_that_share_a_point(shells):
    armature = rig()
    ob = place("Shared", _of_tetrahedra(shells), armature)
    bend(armature)
    add_turgor(ob)
    ob.location, armature.location = (3.0, -2.0, 1.0), (3.0, -2.0, 1.0)
    _assert_bits(ob, np.arange(1.0, LAST_FRAME + 1.0))


@pytest.mark.parametrize("is_dual", [False, True], ids=["linear", "dual"])
def test_seams_that_open_moved_objects_and_part_of_the_strength(is_dual: bool):
    ob, armature = character()
    mesh = ob.data
    corners = [vertex for polygon in mesh.polygons for vertex in polygon.vertices]
    places = [mesh.vertices[vertex].co[:] for vertex in corners]
    starts = np.cumsum([0, *(len(polygon.vertices) for polygon in mesh.polygons)])
    split = bpy.data.meshes.new("Split")
    split.from_pydata(places, [], [tuple(range(a, b)) for a, b in pairwise(starts.tolist())])
    weights = [[(group.group, group.weight) for group in mesh.vertices[vertex].groups] for vertex in corners]
    names = [group.name for group in ob.vertex_groups]
    ob.data = split
    for name in names:
        ob.vertex_groups.new(name=name)
    for number, row in enumerate(weights):
        for group, weight in row:
            # Twins at one place are not held alike.
            ob.vertex_groups[group].add([number], weight * (1.0 if number % 5 else 0.6) + 0.1 * (number % 3), "REPLACE")
    ob.modifiers["Armature"].use_deform_preserve_volume = is_dual
    ob.location, armature.scale = (1.0, 2.0, -3.0), (1.5, 1.5, 1.5)
    add_turgor(ob)
    set_strength(ob, 0.7)
    _assert_bits(ob, np.arange(1.0, LAST_FRAME + 1.0, 0.5))


def test_flesh_along_a_spine_is_added():
    ob, armature = character()
    add_spine(ob, armature)
    add_turgor(ob)
    runtime = importlib.import_module("addon.runtime")
    assert runtime.character(ob.session_uid).binding.fleshed is not None
    _assert_bits(ob, np.arange(1.0, LAST_FRAME + 1.0))
