"""Rendered pixels show the corrected mesh: an animation render equals that of the exact mesh, not of plain skinning."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from body import add_spine
from measure import evaluated_mesh
from tube import add_turgor, character, set_strength

FRAMES = (12, 13)
# Of 255, per channel: sampling noise is the same in both pictures, edges may differ by one sample.
SAME, OTHER = 0.05, 0.25


EEVEE = "BLENDER_EEVEE" if bpy.app.version >= (5, 0, 0) else "BLENDER_EEVEE_NEXT"


@pytest.fixture(params=["BLENDER_WORKBENCH", "CYCLES"])
def scene(request):
    return stage(request.param)


def stage(engine: str) -> bpy.types.Scene:
    """A character before a camera."""
    character(rings=61, segments=32)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    light = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    camera.location, camera.rotation_euler = (0.0, -9.0, 1.5), (np.pi / 2, 0.0, 0.0)
    for member in (camera, light):
        scene.collection.objects.link(member)
    scene.camera = camera
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    scene.render.image_settings.file_format = "PNG"
    scene.frame_start, scene.frame_end = FRAMES
    if engine == "CYCLES":
        scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.seed = 4, False, 1
    return scene


def _animation(scene, folder, frames=FRAMES) -> np.ndarray:
    scene.frame_set(1)
    scene.render.filepath = f"{folder}/"
    bpy.ops.render.render(animation=True)
    pictures = []
    for frame in frames:
        image = bpy.data.images.load(f"{folder}/{frame:04d}.png")
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        pictures.append(pixels * 255.0)
        bpy.data.images.remove(image)
    return np.array(pictures)


def _applied(ob: bpy.types.Object, frame: int) -> bpy.types.Object:
    """The corrected mesh of one frame as a plain object."""
    bpy.context.scene.frame_set(frame)
    mesh = bpy.data.meshes.new_from_object(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    reference = bpy.data.objects.new("Reference", mesh)
    bpy.context.scene.collection.objects.link(reference)
    return reference


def test_pixels_show_the_correction(route, scene, tmp_path):
    ob = bpy.data.objects["Tube"]
    add_turgor(ob)
    corrected = _animation(scene, tmp_path / "corrected")
    set_strength(ob, 0.0)
    plain = _animation(scene, tmp_path / "plain")
    set_strength(ob, 1.0)
    ob.hide_render = True
    for index, frame in enumerate(FRAMES):
        reference = _applied(ob, frame)
        exact = _animation(scene, tmp_path / f"exact{frame}")
        bpy.data.objects.remove(reference)
        assert np.abs(corrected[index] - exact[index]).mean() < SAME
        assert np.abs(corrected[index] - plain[index]).mean() > OTHER


def test_eevee_shows_the_correction(addon, tmp_path):
    """On one route and one frame: without a graphics card it takes many times longer than the others."""
    scene = stage(EEVEE)
    scene.eevee.taa_render_samples = 1
    scene.render.resolution_percentage = 50
    scene.frame_start = scene.frame_end = FRAMES[0]
    ob = bpy.data.objects["Tube"]
    add_turgor(ob)
    corrected = _animation(scene, tmp_path / "corrected", FRAMES[:1])
    set_strength(ob, 0.0)
    plain = _animation(scene, tmp_path / "plain", FRAMES[:1])
    set_strength(ob, 1.0)
    ob.hide_render = True
    _applied(ob, FRAMES[0])
    exact = _animation(scene, tmp_path / "exact", FRAMES[:1])
    assert np.abs(corrected - exact).mean() < SAME
    assert np.abs(corrected - plain).mean() > OTHER


def test_pixels_show_the_fleshed_body(route, scene, tmp_path):
    """Turgor Spine along the bones of the rig, without an Armature modifier."""
    ob, rig = bpy.data.objects["Tube"], bpy.data.objects["Rig"]
    ob.modifiers.clear()
    add_spine(ob, rig)
    fleshed = _animation(scene, tmp_path / "fleshed")
    ob.modifiers["Turgor Spine"].show_render = False
    still = _animation(scene, tmp_path / "still")
    ob.hide_render = True
    for index, frame in enumerate(FRAMES):
        reference = _applied(ob, frame)
        exact = _animation(scene, tmp_path / f"exact{frame}")
        bpy.data.objects.remove(reference)
        assert np.abs(fleshed[index] - exact[index]).mean() < SAME
        assert np.abs(fleshed[index] - still[index]).mean() > OTHER


def _subdivided(ob, *, levels=1, render_levels=1):
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = levels, render_levels


def _other_levels(ob):
    _subdivided(ob, render_levels=2)


def _other_levels_by_simplify(ob):
    _subdivided(ob, levels=2, render_levels=2)
    bpy.context.scene.render.use_simplify, bpy.context.scene.render.simplify_subdivision = True, 1


def _same_count_other_shape(ob):
    modifier = ob.modifiers.new("Cast", "CAST")
    modifier.factor, modifier.show_render = 0.3, False


@pytest.mark.parametrize("add_modifier", [_other_levels, _other_levels_by_simplify, _same_count_other_shape])
def test_another_mesh_in_renders_is_plain_skinning_and_said(route, scene, tmp_path, runtime, add_modifier):
    ob = bpy.data.objects["Tube"]
    add_modifier(ob)
    ob.modifiers.move(1, 0)
    plain = _animation(scene, tmp_path / "plain")
    add_turgor(ob)
    assert "plain skinning" in runtime.character(ob.session_uid).findings[0].text
    assert np.abs(_animation(scene, tmp_path / "rendered") - plain).mean() < SAME


def test_renders_made_equal_again_are_corrected(route, scene, tmp_path, runtime):
    ob = bpy.data.objects["Tube"]
    _same_count_other_shape(ob)
    ob.modifiers.move(1, 0)
    add_turgor(ob)
    ob.modifiers["Cast"].show_render = True
    bpy.context.view_layer.update()
    assert runtime.character(ob.session_uid).bind_findings == ()
    corrected = _animation(scene, tmp_path / "corrected")
    set_strength(ob, 0.0)
    assert np.abs(corrected - _animation(scene, tmp_path / "plain")).mean() > OTHER


def test_armature_off_in_renders_only(route, scene, tmp_path):
    ob = bpy.data.objects["Tube"]
    add_turgor(ob)
    ob.modifiers["Armature"].show_render = False
    off = _animation(scene, tmp_path / "off")
    rest = bpy.data.objects.new("Rest", ob.data)
    scene.collection.objects.link(rest)
    ob.hide_render = True
    assert np.abs(off - _animation(scene, tmp_path / "rest")).mean() < SAME
    assert len(evaluated_mesh(ob).vertices)
