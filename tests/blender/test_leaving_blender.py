"""What leaves the modifier stack carries the correction: converted meshes, caches, motion blur."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
import pytest
from measure import mesh_positions, positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import add_turgor, character, select

FRAME = 15
FRAMES = (13, 14, FRAME)


def _at(ob: bpy.types.Object, frame: float) -> np.ndarray:
    bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
    return positions(ob)


def _drivers(ob: bpy.types.Object) -> list[str]:
    return [] if ob.animation_data is None else [curve.data_path for curve in ob.animation_data.drivers]


def _check_nothing_of_ours_is_left(ob: bpy.types.Object) -> None:
    assert not _drivers(ob)
    assert ob.turgor.version == 0
    assert sorted(bpy.data.objects.keys()) == ["Rig", "Tube"]
    assert not len(bpy.data.node_groups)


def test_conversion_to_a_mesh_keeps_the_pose(route):
    ob, _ = character()
    add_turgor(ob)
    expected = _at(ob, FRAME)
    select([ob])
    assert bpy.ops.object.convert(target="MESH") == {"FINISHED"}
    bpy.context.view_layer.update()
    converted = bpy.context.object
    assert (mesh_positions(converted.data) == expected).all()
    _check_nothing_of_ours_is_left(converted)


def _apply(name: str) -> None:
    assert bpy.ops.object.modifier_apply(modifier=name) == {"FINISHED"}
    bpy.context.view_layer.update()


def test_applied_after_the_armature_it_is_plain_skinning(route):
    ob, _ = character()
    plain = _at(ob, FRAME)
    add_turgor(ob)
    _at(ob, FRAME)
    _apply("Armature")
    _apply("Turgor Volume")
    assert (mesh_positions(ob.data) == plain).all()
    _check_nothing_of_ours_is_left(ob)


def test_applied_alone_it_is_the_offset_of_the_frame(route):
    ob, _ = character()
    rest = mesh_positions(ob.data)
    plain = _at(ob, FRAME)
    add_turgor(ob)
    offset = _at(ob, FRAME) - plain
    _apply("Turgor Volume")
    assert np.abs(mesh_positions(ob.data) - rest - offset).max() < 1e-6
    _check_nothing_of_ours_is_left(ob)


def _alembic(path: str) -> None:
    bpy.ops.wm.alembic_export(filepath=path, start=FRAMES[0], end=FRAMES[-1])


def _usd(path: str) -> None:
    bpy.ops.wm.usd_export(filepath=path, export_animation=True, export_armatures=False)


@pytest.mark.parametrize(
    ("write", "read", "suffix"),
    [(_alembic, bpy.ops.wm.alembic_import, "abc"), (_usd, bpy.ops.wm.usd_import, "usdc")],
    ids=["alembic", "usd"],
)
def test_caches_hold_every_frame(route, tmp_path, write: Callable[[str], None], read, suffix):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    expected = [_at(ob, frame) for frame in FRAMES]
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = FRAMES[0], FRAMES[-1]
    bpy.context.scene.frame_set(1)
    path = str(tmp_path / f"cache.{suffix}")
    write(path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    read(filepath=path)
    cached = next(ob for ob in bpy.data.objects if ob.type == "MESH")
    for frame, shape in zip(FRAMES, expected, strict=True):
        assert np.abs(_at(cached, frame) - shape).max() < 1e-6
        assert relative_error(cached, rest) < VOLUME_TOLERANCE


SHUTTER = 0.5


@pytest.fixture
def blurred():
    """A character that moves much within the shutter's time, in a picture of 160 by 120."""
    ob, rig = character(rings=61, segments=32)
    for bone in rig.pose.bones:
        bone.rotation_euler = (0.0, 0.0, 0.0)
        bone.keyframe_insert("rotation_euler", frame=10)
        bone.rotation_euler = (0.9, 0.5, 0.3)
        bone.keyframe_insert("rotation_euler", frame=FRAME)
        bone.rotation_euler = (1.6, 0.5, 0.3)
        bone.keyframe_insert("rotation_euler", frame=FRAME + 1)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    light = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    camera.location, camera.rotation_euler = (0.0, -9.0, 1.5), (np.pi / 2, 0.0, 0.0)
    for member in (camera, light):
        scene.collection.objects.link(member)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, SHUTTER
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.seed = 16, False, 1
    return ob


def _picture(folder) -> np.ndarray:
    scene = bpy.context.scene
    scene.frame_set(1)
    scene.frame_set(FRAME)
    scene.render.filepath = f"{folder}/blurred.png"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels * 255.0


def _baked(ob: bpy.types.Object) -> bpy.types.Object:
    """A plain object with the shapes of `ob` at the three times at which Cycles looks while the shutter is open."""
    times = (FRAME - SHUTTER / 2, FRAME, FRAME + SHUTTER / 2)
    shapes = [_at(ob, time) for time in times]
    bpy.context.scene.frame_set(FRAME)
    mesh = bpy.data.meshes.new_from_object(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    baked = bpy.data.objects.new("Baked", mesh)
    bpy.context.scene.collection.objects.link(baked)
    baked.shape_key_add(name="Basis")
    for time, shape in zip(times, shapes, strict=True):
        key = baked.shape_key_add(name=f"{time}")
        key.points.foreach_set("co", shape.ravel())
        for other in times:
            key.value = float(other == time)
            key.keyframe_insert("value", frame=other)
    return baked


def test_motion_blur_blurs_the_corrected_mesh(route, blurred, tmp_path):
    plain = _picture(tmp_path)
    add_turgor(blurred)
    corrected = _picture(tmp_path)
    baked = _baked(blurred)
    blurred.hide_render = True
    expected = _picture(tmp_path)
    baked.hide_render, blurred.hide_render = True, False
    bpy.context.scene.render.use_motion_blur = False
    sharp = _picture(tmp_path)
    assert np.abs(corrected - expected).mean() < 0.05
    assert np.abs(corrected - plain).mean() > 0.25
    assert np.abs(corrected - sharp).mean() > 0.25
