"""Bad input: the mesh as Blender shows it, one message in the log and the panel, no exception."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import RINGS, SEGMENTS, add_turgor, character, select, set_strength, subdivide, tube_mesh

FRAME = 15


def _plain(ob: bpy.types.Object) -> np.ndarray:
    set_strength(ob, 0.0)
    bpy.context.view_layer.update()
    plain = positions(ob)
    set_strength(ob, 1.0)
    bpy.context.view_layer.update()
    return plain


def _play(frames: range = range(10, 16)) -> None:
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        bpy.context.view_layer.update()


def _check_message(ob: bpy.types.Object, runtime, logged, words: str, counted: int = 1) -> None:
    assert words in runtime.character(ob.session_uid).problem
    assert len([line for line in logged() if words in line]) == counted


def _missing_armature(ob, rig):
    bpy.data.objects.remove(rig)


def _not_a_number(ob, rig):
    rig.animation_data_clear()
    rig.pose.bones["Bone1"].rotation_euler.x = math.nan


def _flat_object(ob, rig):
    ob.scale = (1.0, 0.0, 1.0)


def _second_armature_after(ob, rig):
    second = ob.modifiers.new("Second", "ARMATURE")
    second.object, second.show_viewport = rig, False
    return second


def _masked_by_selected_bones(ob, rig):
    mask = ob.modifiers.new("Mask", "MASK")
    mask.mode, mask.armature = "ARMATURE", rig
    ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _no_groups(ob, rig):
    ob.vertex_groups.clear()
    ob.update_tag()


def _cloth(ob, rig):
    ob.modifiers.new("Cloth", "CLOTH")
    ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _deforming_parent(ob, rig):
    ob.parent, ob.parent_type = rig, "ARMATURE"


UNSUPPORTED = [
    (_masked_by_selected_bones, "Mask"),
    (_cloth, "Cloth simulates"),
    (_deforming_parent, "Rig deforms the mesh"),
]


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (_missing_armature, "armature"),
        (_not_a_number, "finite"),
        (_flat_object, "scale"),
        (_second_armature_after, "Second deforms again"),
        (_no_groups, "vertex group"),
        *UNSUPPORTED,
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_harm_is_said_once_and_the_mesh_stays_as_skinned(route, runtime, warnings_logged, harm, words):
    ob, rig = character()
    add_turgor(ob)
    harm(ob, rig)
    bpy.context.view_layer.update()
    _play()
    _check_message(ob, runtime, warnings_logged, words)
    live = positions(ob)
    assert np.array_equal(live, _plain(ob), equal_nan=True)


@pytest.mark.parametrize(("harm", "words"), UNSUPPORTED, ids=lambda value: getattr(value, "__name__", ""))
def test_what_is_not_supported_cannot_be_added_and_says_why(harm, words):
    ob, rig = character()
    harm(ob, rig)
    bpy.context.view_layer.update()
    modifiers = list(ob.modifiers)
    select([ob])
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.object.turgor_volume_add()
    assert list(ob.modifiers) == modifiers


# Without cloth, which shows what frames before left it.
@pytest.mark.parametrize("harm", [harm for harm, _ in UNSUPPORTED if harm is not _cloth])
def test_the_mesh_is_as_blender_shows_it_without_us(harm):
    ob, rig = character()
    harm(ob, rig)
    bpy.context.scene.frame_set(FRAME)
    expected = positions(ob)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    ob, rig = character()
    add_turgor(ob)
    harm(ob, rig)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    assert (positions(ob) == expected).all()


def test_healed_character_is_corrected_again(route, runtime):
    ob, rig = character()
    rest = volume(ob)
    add_turgor(ob)
    _deforming_parent(ob, rig)
    bpy.context.view_layer.update()
    _play()
    assert runtime.character(ob.session_uid).problem is not None
    ob.parent_type = "OBJECT"
    bpy.context.view_layer.update()
    _play()
    assert runtime.character(ob.session_uid).problem is None
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_changed_topology_waits_for_rebind(route, runtime, warnings_logged):
    ob, _ = character()
    add_turgor(ob)
    subdivide(ob)
    bpy.context.view_layer.update()
    _play()
    _check_message(ob, runtime, warnings_logged, "Rebind")
    assert runtime.character(ob.session_uid).needs_rebind
    assert (positions(ob) == _plain(ob)).all()
    assert bpy.ops.object.turgor_volume_rebind() == {"FINISHED"}
    bpy.context.scene.frame_set(1)
    rest = volume(ob)
    bpy.context.scene.frame_set(FRAME)
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_same_counts_other_faces_wait_for_rebind(route, runtime):
    ob, _ = character()
    add_turgor(ob)
    order = np.arange(RINGS * SEGMENTS).reshape(RINGS, SEGMENTS)[:, ::-1].ravel()
    other = tube_mesh("Other")
    moved = positions(ob)[order]
    other.attributes["position"].data.foreach_set("vector", moved.ravel())
    other.polygons[0].flip()
    ob.data = other
    bpy.context.view_layer.update()
    _play()
    assert runtime.character(ob.session_uid).problem is not None
    assert (positions(ob) == _plain(ob)).all()


def test_new_weights_are_bound_without_asking(route, runtime):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    select([ob])
    ob.vertex_groups["Bone1"].add(range(120), 0.7, "REPLACE")
    ob.data.update_tag()
    bpy.context.view_layer.update()
    _play()
    assert runtime.character(ob.session_uid).problem is None
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_new_rest_pose_is_bound_without_asking(route):
    ob, rig = character()
    rest = volume(ob)
    add_turgor(ob)
    select([rig])
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones["Bone1"].head.x += 0.2
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    _play()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_renamed_bone_keeps_its_settings(route):
    ob, rig = character()
    add_turgor(ob)
    ob.turgor.joints["Bone1"].preset = "MUSCLE"
    rig.data.bones["Bone1"].name = "Elbow"
    bpy.context.view_layer.update()
    _play()
    assert ob.turgor.joints["Elbow"].preset == "MUSCLE"


def test_zero_length_bones_do_no_harm(route):
    ob, rig = character()
    rest = volume(ob)
    select([rig])
    bpy.ops.object.mode_set(mode="EDIT")
    stub = rig.data.edit_bones.new("Stub")
    stub.head, stub.tail = (0, 0, 2), (0, 0, 2.0001)
    stub.parent = rig.data.edit_bones["Bone1"]
    bpy.ops.object.mode_set(mode="OBJECT")
    ob.vertex_groups.new(name="Stub").add(range(60, 90), 0.5, "REPLACE")
    add_turgor(ob)
    _play()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_nothing_is_added_without_an_armature():
    ob = bpy.data.objects.new("Loose", tube_mesh())
    bpy.context.scene.collection.objects.link(ob)
    select([ob])
    assert not bpy.ops.object.turgor_volume_add.poll()


def test_mesh_without_vertices(route, runtime, warnings_logged):
    ob, rig = character()
    empty = bpy.data.objects.new("Empty", bpy.data.meshes.new("Empty"))
    bpy.context.scene.collection.objects.link(empty)
    empty.vertex_groups.new(name="Bone0")
    empty.modifiers.new("Armature", "ARMATURE").object = rig
    add_turgor(ob, empty)
    _play()
    assert [modifier.name for modifier in empty.modifiers] == ["Armature"]
    assert len([line for line in warnings_logged() if "no vertices" in line]) == 1
    assert runtime.character(ob.session_uid).problem is None
