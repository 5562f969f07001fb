"""Adding, copying, deleting: nothing is shared by accident and nothing stays behind."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import library
import pytest
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import add_turgor, carrier, character, select, volume_modifier

FRAME = 15


def _listing() -> dict[str, list[str]]:
    return {
        collection.identifier: sorted(item.name for item in getattr(bpy.data, collection.identifier))
        for collection in bpy.data.bl_rna.properties
        if collection.type == "COLLECTION"
    }


def _drivers(ob: bpy.types.Object) -> Iterator[str]:
    if ob.animation_data is not None:
        yield from (curve.data_path for curve in ob.animation_data.drivers)


def test_modifier_stands_right_after_the_armature():
    ob, _ = character()
    ob.modifiers.new("Subdivision", "SUBSURF")
    add_turgor(ob)
    assert [modifier.name for modifier in ob.modifiers] == ["Armature", "Turgor Volume", "Subdivision"]


@pytest.mark.parametrize("preset", ["ISOTROPIC", "CUSTOM"])
def test_removal_leaves_no_trace(route, preset):
    ob, _ = character()
    before = _listing()
    add_turgor(ob)
    ob.turgor.joints[1].preset = preset
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    assert bpy.ops.object.turgor_volume_remove() == {"FINISHED"}
    assert _listing() == before
    assert not list(_drivers(ob))
    assert ob.turgor.version == 0
    assert not len(ob.turgor.joints)
    assert [modifier.name for modifier in ob.modifiers] == ["Armature"]


def test_removing_the_modifier_by_its_cross_leaves_no_trace(route):
    ob, _ = character()
    before = _listing()
    add_turgor(ob)
    bpy.ops.object.modifier_remove(modifier=volume_modifier(ob).name)
    bpy.context.view_layer.update()
    assert _listing() == before
    assert ob.turgor.version == 0


def test_removed_character_leaves_nothing_in_the_saved_file(route, tmp_path):
    ob, _ = character()
    add_turgor(ob)
    select([ob])
    bpy.ops.object.delete()
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert sorted(bpy.data.objects.keys()) == ["Rig"]
    assert not len(bpy.data.node_groups)


def test_duplicate_gets_a_carrier_and_curves_of_its_own(route):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    ob.turgor.joints[1].preset = "CUSTOM"
    bpy.context.view_layer.update()
    select([ob])
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    bpy.context.view_layer.update()
    assert carrier(copy) != carrier(ob)
    assert copy.turgor.curves not in (None, ob.turgor.curves)
    for frame in (1, FRAME):
        bpy.context.scene.frame_set(frame)
        assert relative_error(copy, rest) < VOLUME_TOLERANCE
        assert (positions(copy) == positions(ob)).all()
    select([ob])
    bpy.ops.object.turgor_volume_remove()
    bpy.context.scene.frame_set(FRAME)
    assert relative_error(copy, rest) < VOLUME_TOLERANCE


def test_saved_file_without_the_extension_shows_plain_skinning(route, addon, tmp_path):
    ob, _ = character()
    bpy.context.scene.frame_set(FRAME)
    plain = positions(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    assert (positions(ob) != plain).any()
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    addon.unregister()
    bpy.ops.wm.open_mainfile(filepath=path)
    assert (positions(bpy.data.objects["Tube"]) == plain).all()
    addon.register()
    bpy.context.scene.frame_set(FRAME)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    assert (positions(bpy.data.objects["Tube"]) != plain).any()


def test_goes_and_comes_back_where_another_add_on_cleared_the_handlers(route, addon):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    bpy.app.handlers.frame_change_post.clear()
    addon.unregister()
    addon.register()
    bpy.context.scene.frame_set(FRAME)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_undoing_the_addition_is_one_step(route):
    ob, _ = character()
    bpy.ops.ed.undo_push(message="before")
    before = _listing()
    add_turgor(ob)
    bpy.ops.ed.undo_push(message="added")
    bpy.ops.ed.undo()
    assert _listing() == before


def test_appended_character_works(route, tmp_path):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(path) as (_, into):
        into.objects = ["Tube"]
    for loaded in [into.objects[0], bpy.data.objects["Rig"]]:
        bpy.context.scene.collection.objects.link(loaded)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    assert relative_error(into.objects[0], rest) < VOLUME_TOLERANCE


def test_instance_of_a_linked_character(tmp_path):
    ob, rig = character()
    rest = volume(ob)
    add_turgor(ob)
    collection = library.linked((ob, rig), tmp_path)
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(instance)
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    assert relative_error(collection.all_objects["Tube"], rest) < VOLUME_TOLERANCE


def test_a_character_that_is_only_linked_is_exact_or_says_why_not(route, runtime, tmp_path):
    """Push has to write offsets, and a linked carrier cannot be written."""
    ob, rig = character()
    rest = volume(ob)
    add_turgor(ob)
    tube = library.shown(library.linked((ob, rig), tmp_path))
    bpy.context.scene.frame_set(FRAME)
    if route == "PUSH":
        assert "choose pull" in runtime.character(tube.session_uid).problem
    else:
        assert relative_error(tube, rest) < VOLUME_TOLERANCE


@pytest.mark.parametrize("where", ["in the library", "on the override"])
def test_linked_and_overridden_character(route, tmp_path, where):
    ob, rig = character()
    rest = volume(ob)
    if where == "in the library":
        add_turgor(ob)
    tube = library.overridden(library.linked((ob, rig), tmp_path))
    scene = bpy.context.scene
    if where == "on the override":
        add_turgor(tube)
    scene_file = str(tmp_path / "scene.blend")
    for _ in range(2):
        scene.frame_set(FRAME)
        assert relative_error(tube, rest) < VOLUME_TOLERANCE
        bpy.ops.wm.save_as_mainfile(filepath=scene_file)
        bpy.ops.wm.open_mainfile(filepath=scene_file)
        scene = bpy.context.scene
        tube = library.opened_override()
