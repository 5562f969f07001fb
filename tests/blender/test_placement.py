"""Where armature and mesh stand, and at which scale, changes nothing of the shape; binding knows no frame."""

from __future__ import annotations

import importlib
from types import ModuleType

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import LAST_FRAME, LENGTH, add_turgor, character, select

FRAME = 15
# Of the tube's length: matrices and positions at other scales round differently.
SAME_SHAPE = 1e-6


@pytest.fixture
def placement(package: ModuleType) -> ModuleType:
    return importlib.import_module("addon.scene.placement")


def _shape(ob: bpy.types.Object, frame: int = FRAME) -> np.ndarray:
    """(N, 3) as seen in the scene."""
    bpy.context.scene.frame_set(frame)
    world = np.array(ob.matrix_world)
    return positions(ob) @ world[:3, :3].T + world[:3, 3]


def _apply_scale(ob):
    select([ob])
    assert bpy.ops.object.transform_apply(location=False, rotation=False, scale=True) == {"FINISHED"}


def _bones_in_centimetres(ob, rig):
    """As glTF and FBX come in: the armature's data at x 100, its object at x 0.01."""
    rig.scale = (100.0, 100.0, 100.0)
    _apply_scale(rig)
    rig.scale = (0.01, 0.01, 0.01)


def _mesh_in_centimetres(ob, rig):
    ob.data.transform(Matrix.Scale(100.0, 4))
    ob.scale = (0.01, 0.01, 0.01)


def _mesh_child_of_a_scaled_rig(ob, rig):
    _bones_in_centimetres(ob, rig)
    bpy.context.view_layer.update()
    ob.parent = rig
    ob.matrix_parent_inverse = rig.matrix_world.inverted()


def _mesh_data_moved(ob, rig):
    ob.data.transform(Matrix.Translation((3.0, 0.0, -1.0)))
    ob.location = (-3.0, 0.0, 1.0)


@pytest.mark.parametrize("rig_scale", [1.0, 100.0])
@pytest.mark.parametrize("object_scale", [1.0, 1e-12])
def test_armature_stands_where_its_matrix_says(placement, object_scale, rig_scale):
    ob, rig = character()
    for each, scale in ((ob, object_scale), (rig, object_scale * rig_scale)):
        each.location, each.rotation_euler, each.scale = (3.0, -2.0, 1.0), (0.3, 1.0, -2.0), (scale,) * 3
    bpy.context.view_layer.update()
    world_from_object, world_from_armature = (np.array(each.matrix_world, np.float64) for each in (ob, rig))
    found = placement.object_from_armature(ob, rig)
    error = np.abs(world_from_object @ found - world_from_armature)
    assert (error <= 1e-12 * np.abs(world_from_armature).max()).all()
    if rig_scale == 1.0:
        np.testing.assert_array_equal(found, np.eye(4))


@pytest.mark.parametrize("axes", [(0.0, 1.0, 1.0), (0.0, 0.0, 0.0)])
def test_armature_and_mesh_scaled_to_zero_stand_nowhere(placement, axes):
    ob, rig = character()
    ob.scale = rig.scale = axes
    bpy.context.view_layer.update()
    with pytest.raises(placement.PlacementError, match="scaled to zero"):
        placement.object_from_armature(ob, rig)


@pytest.mark.parametrize("preset", ["ISOTROPIC", "MUSCLE"])
@pytest.mark.parametrize(
    "change", [_bones_in_centimetres, _mesh_in_centimetres, _mesh_child_of_a_scaled_rig, _mesh_data_moved]
)
def test_scale_and_place_of_the_data_do_not_count(route, change, preset):
    ob, rig = character()
    add_turgor(ob)
    ob.turgor.joints["Bone1"].preset = preset
    expected = _shape(ob)
    bpy.ops.object.turgor_volume_remove()
    bpy.context.scene.frame_set(1)
    change(ob, rig)
    add_turgor(ob)
    ob.turgor.joints["Bone1"].preset = preset
    assert np.abs(_shape(ob) - expected).max() < SAME_SHAPE * LENGTH


def test_applied_scale_is_followed(route):
    ob, rig = character()
    _bones_in_centimetres(ob, rig)
    add_turgor(ob)
    expected = _shape(ob)
    bpy.context.scene.frame_set(1)
    _apply_scale(rig)
    bpy.context.view_layer.update()
    assert np.abs(_shape(ob) - expected).max() < SAME_SHAPE * LENGTH


def _growing_rig(ob, rig):
    """Alone on its rig's scale, so that every frame has another matrix from armature to object."""
    for frame, scale in ((1, 1.0), (LAST_FRAME, 3.0)):
        rig.scale = (scale, scale, scale)
        rig.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_set(1)


@pytest.mark.parametrize("first_frame", [1, 7, LAST_FRAME])
def test_a_frame_is_the_same_whichever_was_opened_first(route, tmp_path, first_frame):
    ob, rig = character()
    rest = volume(ob)
    _growing_rig(ob, rig)
    bpy.context.scene.frame_set(5)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    expected = positions(ob)
    assert relative_error(ob, rest) < VOLUME_TOLERANCE
    bpy.context.scene.frame_set(first_frame)
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.context.scene.frame_set(FRAME)
    assert (positions(bpy.data.objects["Tube"]) == expected).all()


def test_rebind_takes_the_place_of_now(route):
    ob, rig = character()
    _growing_rig(ob, rig)
    add_turgor(ob)
    at_first = list(ob.turgor.bound_placement)
    assert np.allclose(np.reshape(at_first, (4, 4)), np.eye(4))
    bpy.context.scene.frame_set(LAST_FRAME)
    assert list(ob.turgor.bound_placement) == at_first
    bpy.ops.object.turgor_volume_rebind()
    assert np.allclose(np.reshape(ob.turgor.bound_placement, (4, 4)), np.diag([3.0, 3.0, 3.0, 1.0]))


def test_undoing_a_rebind_takes_the_place_of_before(route):
    ob, rig = character()
    _growing_rig(ob, rig)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    expected = positions(ob)
    bpy.context.scene.frame_set(LAST_FRAME)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.object.turgor_volume_rebind()
    bpy.ops.ed.undo_push(message="rebound")
    bpy.context.scene.frame_set(FRAME)
    assert (positions(ob) != expected).any()
    bpy.ops.ed.undo()
    bpy.context.scene.frame_set(FRAME)
    assert (positions(bpy.data.objects["Tube"]) == expected).all()


def test_armature_scaled_to_zero_is_said_and_heals_by_rebind(route, runtime):
    ob, rig = character()
    rest = volume(ob)
    add_turgor(ob)
    rig.scale = (0.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    bpy.ops.object.turgor_volume_rebind()
    assert "Rebind" in runtime.character(ob.session_uid).problem
    rig.scale = (1.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    bpy.ops.object.turgor_volume_rebind()
    bpy.context.scene.frame_set(FRAME)
    assert relative_error(ob, rest) < VOLUME_TOLERANCE
