"""The Bake button: what it leaves, what it refuses, what survives a killed bake."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from body import add_spine, body, chain
from measure import positions
from tube import LAST_FRAME, add_turgor, character, select


def baked_tube(**chosen) -> bpy.types.Object:
    """A character, active, with settings of its bake."""
    ob, _ = character()
    add_turgor(ob)
    for name, value in chosen.items():
        setattr(ob.turgor_bake, name, value)
    return ob


def press() -> bpy.types.Object:
    assert bpy.ops.object.turgor_bake() == {"FINISHED"}
    return bpy.context.object


@pytest.mark.parametrize("method", ["ABSOLUTE", "CORRECTIVE", "REDUCED", "DRIVEN", "POINT_CACHE"])
def test_the_button_makes_the_copy_and_hides_the_original(route, tmp_path, method):
    ob = baked_tube(method=method, folder=str(tmp_path), frames="3-9x2")
    copy = press()
    assert copy != ob
    assert copy.turgor_bake.other == ob
    assert ob.turgor_bake.other == copy
    assert ob.hide_get()
    assert ob.hide_render
    assert not copy.hide_get()
    assert copy.turgor.version == 0
    assert "4 frames (3-9x2)" in copy.turgor_bake.report
    bpy.context.scene.frame_set(7)
    limit = 2e-3 if method == "DRIVEN" else 1.01e-3 if method == "REDUCED" else 1e-6
    ob.hide_set(False)
    size = np.linalg.norm(np.ptp(positions(ob), axis=0))
    assert np.linalg.norm(positions(copy) - positions(ob), axis=1).max() <= limit * size


def test_the_folder_may_lie_beside_the_file():
    ob = baked_tube()
    assert ob.turgor_bake.folder.startswith("//")
    assert ob.turgor_bake.bl_rna.properties["folder"].is_path_supports_blend_relative


def test_without_a_range_the_scenes_frames_are_baked(tmp_path):
    baked_tube(folder=str(tmp_path))
    bpy.context.scene.frame_start, bpy.context.scene.frame_end, bpy.context.scene.frame_step = 2, 8, 3
    keys = press().data.shape_keys.key_blocks
    assert keys.keys() == ["Basis", "Frame 2", "Frame 5", "Frame 8"]
    assert [key.value for key in keys[1:]] == [1.0, 0.0, 0.0] or not any(key.mute for key in keys)


def test_an_error_in_scene_units_is_held_on_a_scaled_object(tmp_path):
    ob = baked_tube(method="REDUCED", folder=str(tmp_path), unit="LENGTH", error_length=0.05)
    scaled = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(scaled)
    for member in (ob, ob.modifiers["Armature"].object):
        member.parent = scaled
    scaled.scale = (10.0, 10.0, 10.0)
    bpy.context.view_layer.update()
    copy = press()
    ob.hide_set(False)
    for frame in range(1, LAST_FRAME + 1):
        bpy.context.scene.frame_set(frame)
        assert 10.0 * np.linalg.norm(positions(copy) - positions(ob), axis=1).max() <= 0.05


def test_remove_shows_the_live_mesh_again(tmp_path):
    ob = baked_tube(folder=str(tmp_path))
    before = {name: len(getattr(bpy.data, name)) for name in ("objects", "meshes", "actions", "shape_keys")}
    press()
    assert bpy.ops.object.turgor_bake_remove() == {"FINISHED"}
    assert bpy.context.object == ob
    assert not ob.hide_get()
    assert not ob.hide_render
    assert not ob.turgor_bake.report
    assert {name: len(getattr(bpy.data, name)) for name in before} == before


def test_undo_takes_the_bake_back_and_redo_brings_it_again(tmp_path):
    baked_tube(folder=str(tmp_path))
    bpy.ops.ed.undo_push(message="before")
    press()
    bpy.ops.ed.undo_push(message="Bake")
    bpy.ops.ed.undo()
    assert sorted(bpy.data.objects.keys())[0] == "Rig"
    assert "Tube Baked" not in bpy.data.objects
    assert not bpy.data.objects["Tube"].hide_render
    bpy.ops.ed.redo()
    assert "Tube Baked" in bpy.data.objects
    assert len(bpy.data.objects["Tube Baked"].data.shape_keys.key_blocks) == LAST_FRAME + 1


def test_a_bake_is_the_same_after_saving_and_without_the_extension(addon, tmp_path):
    baked_tube(method="REDUCED", folder=str(tmp_path))
    copy = press()
    bpy.context.scene.frame_set(13)
    expected = positions(copy)
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    addon.unregister()
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.context.scene.frame_set(2)
    bpy.context.scene.frame_set(13)
    found = positions(bpy.data.objects["Tube Baked"])
    addon.register()
    assert np.array_equal(found, expected)


def test_a_linked_character_is_baked_into_the_open_file(addon, tmp_path):
    ob = baked_tube()
    bpy.context.scene.frame_set(15)
    expected = positions(ob)
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Tube", "Rig"]
    for member in wanted.objects:
        bpy.context.scene.collection.objects.link(member)
    bpy.context.scene.frame_set(15)
    linked = next(member for member in wanted.objects if member.type == "MESH")
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    made = job.Job(linked, options.Options("CORRECTIVE", np.array([14.0, 15.0, 16.0]), name="Local"))
    assert list(made.run())
    assert made.baked.library is None
    assert made.baked.data.library is None
    bpy.context.scene.frame_set(15)
    assert np.abs(positions(made.baked) - expected).max() < 1e-5


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        ({"frames": "9-1"}, "swap them"),
        ({"frames": "soon"}, "need numbers and ranges"),
        ({"method": "POINT_CACHE"}, "save the file first"),
        ({"method": "POINT_CACHE", "frames": "1,2,5"}, "even steps"),
        ({"method": "REDUCED", "unit": "LENGTH", "error_length": 1e-7}, "below what numbers"),
    ],
    ids=["backwards", "words", "unsaved", "uneven", "too small"],
)
def test_what_cannot_be_baked_is_refused_and_changes_nothing(tmp_path, chosen, words):
    if "uneven" in words or "frames" in chosen:
        chosen = chosen | {"folder": str(tmp_path)}
    ob = baked_tube(**chosen)
    before = [len(getattr(bpy.data, name)) for name in ("objects", "meshes", "actions", "scenes")]
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.object.turgor_bake()
    assert [len(getattr(bpy.data, name)) for name in ("objects", "meshes", "actions", "scenes")] == before
    assert not ob.hide_render


def test_a_folder_that_is_a_file_is_told(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    baked_tube(method="POINT_CACHE", folder=str(tmp_path / "file"))
    with pytest.raises(RuntimeError, match="need a folder"):
        bpy.ops.object.turgor_bake()


def test_bodies_without_armature_have_no_correctives(tmp_path):
    ob = body()
    add_spine(ob, chain())
    select([ob])
    ob.turgor_bake.folder, ob.turgor_bake.method = str(tmp_path), "REDUCED"
    with pytest.raises(RuntimeError, match="before an Armature, there is none"):
        bpy.ops.object.turgor_bake()
    ob.turgor_bake.method = "POINT_CACHE"
    assert press().modifiers[0].type == "MESH_CACHE"


def test_a_cancelled_bake_leaves_nothing_but_its_chunks(runtime, tmp_path):
    ob = baked_tube()
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    before = sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()), sorted(bpy.data.scenes.keys())
    handlers = {
        event: len(getattr(bpy.app.handlers, event)) for event in ("frame_change_post", "depsgraph_update_post")
    }
    frames = np.arange(1.0, 201.0)
    count = len(list(job.Job(ob, options.Options("ABSOLUTE", frames, folder=tmp_path, name="Whole")).run()))
    bpy.data.objects.remove(bpy.data.objects["Whole"])
    bpy.data.orphans_purge()
    for stop in range(1, count, 2):
        steps = job.Job(ob, options.Options("ABSOLUTE", frames, folder=tmp_path, name="Cut")).run()
        has_ended = [next(steps, steps) is steps for _ in range(stop)]
        if has_ended[-1]:
            # It is cut into steps by the clock: this one had fewer.
            assert stop > 1
            bpy.data.objects.remove(bpy.data.objects["Cut"])
            bpy.data.orphans_purge()
            break
        steps.close()
        assert (
            sorted(bpy.data.objects.keys()),
            sorted(bpy.data.meshes.keys()),
            sorted(bpy.data.scenes.keys()),
        ) == before
        assert {event: len(getattr(bpy.app.handlers, event)) for event in handlers} == handlers
    again = job.Job(ob, options.Options("ABSOLUTE", frames, folder=tmp_path, name="Again"))
    list(again.run())
    assert again.report.resumed_chunks == again.chunk_count
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]
