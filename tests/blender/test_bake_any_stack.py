"""Bakes, measures and exports of characters whose stack Blender evaluates."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import evaluated_mesh, mesh_positions
from stacks import KINDS, new
from test_bake import EXACT_TOLERANCE, FRAMES, bake, size, worst  # noqa: F401
from test_exact import VOLUME_TOLERANCE
from test_exports import READERS, nearest, over_frames, world, world_volume
from tube import LAST_FRAME, add_turgor, character, select, volume_modifier


def _between(*kinds: str) -> bpy.types.Object:
    ob, _ = character()
    for kind in kinds:
        KINDS[kind](ob)
    add_turgor(ob)
    ob.modifiers.move(list(ob.modifiers).index(volume_modifier(ob)), len(ob.modifiers) - 1)
    bpy.context.view_layer.update()
    return ob


def _without_armature() -> bpy.types.Object:
    ob, _ = character()
    ob.modifiers.remove(ob.modifiers["Armature"])
    KINDS["lattice"](ob)
    add_turgor(ob)
    return ob


BODIES = {
    "smoothed": lambda: _between("corrective smooth"),
    "lattice and keys": lambda: _between("lattice", "keyed"),
    "two rigs": lambda: _between("second rig"),
    "no armature": _without_armature,
}


@pytest.mark.parametrize("method", ["ABSOLUTE", "POINT_CACHE"])
@pytest.mark.parametrize("kind", BODIES)
def test_bakes_show_the_live_mesh(bake, kind, method):  # noqa: F811
    ob = BODIES[kind]()
    bpy.context.scene.frame_set(7)
    before = mesh_positions(evaluated_mesh(ob)).copy()
    baked, report = bake(ob, method)
    assert bpy.context.scene.frame_current == 7
    assert (mesh_positions(evaluated_mesh(ob)) == before).all()
    assert [modifier.type for modifier in baked.modifiers] == ([] if method == "ABSOLUTE" else ["MESH_CACHE"])
    assert worst(ob, baked, FRAMES) <= EXACT_TOLERANCE
    assert report.max_error <= EXACT_TOLERANCE * report.size
    assert abs(report.volume_error_relative) <= EXACT_TOLERANCE


@pytest.mark.parametrize("method", ["CORRECTIVE", "REDUCED"])
def test_correctives_before_a_plain_armature_show_the_live_mesh(bake, method):  # noqa: F811
    ob = _between("corrective smooth", "lattice")
    tolerance = 1e-3 * size(ob)
    baked, report = bake(ob, method, tolerance=tolerance)
    assert [modifier.type for modifier in baked.modifiers] == ["ARMATURE"]
    assert worst(ob, baked, FRAMES) <= (EXACT_TOLERANCE if method == "CORRECTIVE" else 1e-3)
    assert report.max_error <= max(tolerance, EXACT_TOLERANCE * report.size)


@pytest.mark.parametrize("method", ["CORRECTIVE", "DRIVEN"])
def test_keys_that_cannot_follow_are_refused(bake, method):  # noqa: F811
    ob = _between("lattice")
    if method == "CORRECTIVE":
        ob.modifiers["Armature"].use_multi_modifier = True
        bpy.context.view_layer.update()
    refusal = importlib.import_module("addon.bake.options").BakeError
    with pytest.raises(refusal, match="choose absolute keys or a point cache"):
        bake(ob, method, tolerance=1e-3)


@pytest.mark.parametrize("kind", BODIES)
def test_measured_figures_are_exact(runtime, kind):
    ob = BODIES[kind]()
    select([ob])
    assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}
    motion = runtime.character(ob.session_uid).motion
    assert len(motion.corrected_deviations) == LAST_FRAME
    assert np.abs(motion.corrected_deviations).max() < 100.0 * VOLUME_TOLERANCE
    assert np.abs(motion.skinned_deviations).max() > 1.0


def test_adding_measures_a_mesh_without_bones(runtime):
    ob = _without_armature()
    motion = runtime.character(ob.session_uid).motion
    assert motion.frames is not None
    assert motion.joint_names == ()


def test_refining_looks_at_what_is_shown(runtime):
    ob = _between("corrective smooth")
    found = importlib.import_module("addon.live.refining").find(ob)
    assert (found.need.gamma > 0.0).any()


def test_a_scene_driver_of_a_modifier_is_told(bake):  # noqa: F811
    ob = _between("corrective smooth")
    modifier = new(ob, "SMOOTH", iterations=2)
    ob.modifiers.move(list(ob.modifiers).index(modifier), 1)
    driver = ob.driver_add(f'modifiers["{modifier.name}"].factor').driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.targets[0].id_type = "SCENE"
    variable.targets[0].id, variable.targets[0].data_path = bpy.context.scene, "frame_current"
    bpy.context.view_layer.update()
    refusal = importlib.import_module("addon.bake.options").BakeError
    with pytest.raises(refusal, match="Context Property"):
        bake(ob, "ABSOLUTE")


@pytest.mark.parametrize("kind", ["GLTF", "FBX", "USD", "ALEMBIC"])
def test_exports_keep_shape_and_volume(tmp_path, kind):
    exports = importlib.import_module("addon.bake.exports")
    ob = _between("corrective smooth", "lattice")
    expected = over_frames(ob, kind)
    path = tmp_path / f"character{exports.SUFFIXES[kind]}"
    exports.export([ob], exports.Settings(kind, path, error_relative=1e-5))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    READERS[kind](str(path))
    meshes = [other for other in bpy.data.objects if other.type == "MESH" and len(other.data.vertices) > 200]
    assert len(meshes) == 1
    for frame, (points, inside) in expected.items():
        bpy.context.scene.frame_set(frame)
        found = world(meshes[0])
        length = float(np.linalg.norm(np.ptp(points, axis=0)))
        assert nearest(points, found) < 1e-3 * length
        assert abs(world_volume(meshes[0]) / inside - 1.0) < 1e-3
