"""What viewports show of a character is what Blender evaluated, and nothing is worked out for nobody."""

from __future__ import annotations

import importlib
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from measure import positions
from tube import add_turgor, carrier, character, set_strength, tube_mesh, volume_modifier

FRAME = 15
# Of positions: both are float32.
ROUNDING = 1e-5


@pytest.fixture
def look(runtime):
    return lambda ob: runtime.session.look(ob)


def _at(frame: int) -> None:
    bpy.context.scene.frame_set(frame)
    bpy.context.view_layer.update()


@pytest.mark.parametrize("strength", [1.0, 0.4, 0.0])
def test_shown_skin_is_the_evaluated_one(route, look, strength):
    ob, _ = character()
    add_turgor(ob)
    set_strength(ob, strength)
    _at(FRAME)
    assert np.abs(look(ob).positions - positions(ob)).max() < ROUNDING


def test_shape_keys_are_part_of_the_shown_skin_and_of_its_rest(route, look):
    ob, _ = character()
    ob.shape_key_add(name="Basis")
    thick = ob.shape_key_add(name="Thick")
    for point in thick.points:
        point.co.x *= 1.5
        point.co.y *= 1.5
    add_turgor(ob)
    thick.value = 1.0
    _at(1)
    assert np.abs(look(ob).positions - positions(ob)).max() < ROUNDING
    # Frame 1 turns only the root: thick flesh at rest, not grown.
    found = look(ob).strain
    assert np.nanmax(np.abs(found)) < 1e-3


def test_the_same_frame_is_not_worked_out_again(route, look):
    ob, _ = character()
    add_turgor(ob)
    _at(FRAME)
    first = look(ob)
    assert look(ob) is first
    _at(FRAME - 1)
    assert look(ob) is not first


def test_before_shows_skinning_and_its_figures_follow(route, runtime, look):
    ob, _ = character()
    add_turgor(ob)
    _at(FRAME)
    after = runtime.character(ob.session_uid).figures
    _at(3)
    volume_modifier(ob).show_viewport = False
    _at(FRAME)
    assert np.abs(look(ob).positions - positions(ob)).max() < ROUNDING
    figures = runtime.character(ob.session_uid).figures
    assert figures.skinned_deviation == pytest.approx(after.skinned_deviation, abs=1e-9)
    assert figures.corrected_deviation == pytest.approx(after.corrected_deviation, abs=1e-6)
    assert volume_modifier(ob).show_render


def test_nothing_is_shown_where_the_armature_is_off(look):
    ob, _ = character()
    add_turgor(ob)
    ob.modifiers["Armature"].show_viewport = False
    _at(FRAME)
    assert look(ob) is None


def test_strain_of_a_straight_turn_is_none_and_of_a_bend_some(look):
    ob, _ = character(rings=41)
    add_turgor(ob)
    _at(1)
    assert np.nanmax(np.abs(look(ob).strain)) < 1e-4
    _at(FRAME)
    assert np.nanmax(np.abs(look(ob).strain)) > 0.05


def test_heat_of_the_displacement_is_the_carriers_offset_in_the_world(look):
    ob, rig = character()
    for thing in (ob, rig):
        thing.scale = (2.0, 2.0, 2.0)
    add_turgor(ob)
    _at(FRAME)
    world = np.array(ob.matrix_world)
    mesh = carrier(ob).evaluated_get(bpy.context.view_layer.depsgraph).data
    offsets = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.attributes["turgor_offset"].data.foreach_get("vector", offsets.ravel())
    found = look(ob).heat("DISPLACEMENT", "", world, 0.0, 1.0)
    assert found.highest == pytest.approx(2.0 * np.linalg.norm(offsets, axis=1).max(), rel=1e-4)
    assert found.lowest == 0.0


def test_weight_is_of_one_joint_and_absent_without_one(look):
    ob, _ = character()
    add_turgor(ob)
    # Under the law of flesh a bent joint's field lies amid its section, not at its head.
    ob.turgor.flesh = 0.0
    _at(FRAME)
    shown = look(ob)
    assert shown.heat("WEIGHT", "Bone1", np.eye(4), 0.0, 1.0).highest > 0.0
    assert shown.heat("WEIGHT", "no such bone", np.eye(4), 0.0, 1.0) is None
    head = bpy.data.objects["Rig"].pose.bones["Bone1"].head
    assert np.abs(shown.joint_field("Bone1").origin - np.array(head)).max() < ROUNDING
    assert np.abs(shown.joint_origin("Bone1") - np.array(head)).max() < ROUNDING


def test_callbacks_do_nothing_without_characters(monkeypatch, package):
    overlay = importlib.import_module("addon.overlays.volume")
    monkeypatch.setattr(overlay, "shown", lambda _context: pytest.fail("looked at the scene"))
    overlay.draw_in_space()
    overlay.draw_on_top()


def test_nothing_is_worked_out_for_characters_that_show_nothing(monkeypatch, runtime):
    overlay = importlib.import_module("addon.overlays.volume")
    ob, _ = character()
    add_turgor(ob)
    _at(FRAME)
    monkeypatch.setattr(overlay, "shown", lambda _context: [(ob, runtime.character(ob.session_uid))])
    monkeypatch.setattr(runtime.session, "look", lambda _ob: pytest.fail("worked out a frame"))
    overlay.draw_in_space()
    overlay.draw_on_top()


def _has_gpu() -> bool:
    import gpu

    if hasattr(gpu, "init"):
        gpu.init()
    else:
        scene = bpy.context.scene
        scene.render.engine = "BLENDER_WORKBENCH"
        scene.render.resolution_x = scene.render.resolution_y = 8
        scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        scene.collection.objects.link(scene.camera)
        bpy.ops.render.render()
    return gpu.platform.backend_type_get() not in {"NONE", "UNKNOWN"}


@pytest.mark.parametrize("is_perspective", [True, False])
def test_skin_is_drawn_in_its_colors_over_itself(is_perspective):
    """Over the depths of the same surface, from anywhere, and hidden by what stands before it."""
    import gpu
    from mathutils import Matrix

    heat, skin = (importlib.import_module(f"addon.overlays.{name}") for name in ("heat", "over_skin"))
    ob, _ = character(rings=41)
    add_turgor(ob)
    _at(FRAME)
    ob.turgor.display.heat, ob.turgor.display.opacity = "DISPLACEMENT", 1.0
    if not _has_gpu():
        pytest.fail("no graphics in the background")
    size, near, far = 64, 0.1, 100.0
    # From +X, up is Z.
    view = Matrix(((0, 1, 0, 0), (0, 0, 1, -2), (1, 0, 0, -8), (0, 0, 0, 1)))
    if is_perspective:
        depth = (0, 0, -(far + near) / (far - near), -2 * far * near / (far - near))
        projection = Matrix(((2, 0, 0, 0), (0, 2, 0, 0), depth, (0, 0, -1, 0)))
    else:
        projection = Matrix(((0.3, 0, 0, 0), (0, 0.3, 0, 0), (0, 0, -2 / (far - near), -1), (0, 0, 0, 1)))
    context = SimpleNamespace(region_data=SimpleNamespace(is_perspective=is_perspective, view_matrix=view))

    def picture(bias_sign: float) -> np.ndarray:
        target = gpu.types.GPUOffScreen(size, size, format="RGBA32F")
        with target.bind():
            buffer = gpu.state.active_framebuffer_get()
            buffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
            with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
                gpu.matrix.load_matrix(view)
                gpu.matrix.load_projection_matrix(projection)
                heat.draw(context, ob)
                # The depths stand; the same surface again, a little farther, has no place before itself.
                skin.BIAS, before = bias_sign * skin.BIAS, skin.BIAS
                ob.turgor.display.heat = "STRAIN"
                heat.draw(context, ob)
                ob.turgor.display.heat = "DISPLACEMENT"
                skin.BIAS = before
            pixels = np.array(buffer.read_color(0, 0, size, size, 4, 0, "FLOAT").to_list())
        target.free()
        return pixels

    nearer, farther = picture(5.0), picture(-5.0)
    is_skin = farther[..., 3] > 0.5
    assert 0.02 < is_skin.mean() < 0.9
    # Strain is blue to orange over white, displacement dark to yellow: what is farther leaves the picture alone.
    assert farther[is_skin][:, :3].mean() < 0.6
    assert np.abs(nearer[is_skin] - farther[is_skin]).mean() > 0.1
    heat.keep_only(set())


def test_two_characters_have_their_own(look):
    ob, rig = character()
    other = bpy.data.objects.new("Other", tube_mesh("Other"))
    bpy.context.scene.collection.objects.link(other)
    for group in ob.vertex_groups:
        other.vertex_groups.new(name=group.name).add(range(len(other.data.vertices)), 0.5, "REPLACE")
    other.modifiers.new("Armature", "ARMATURE").object = rig
    add_turgor(ob, other)
    _at(FRAME)
    assert look(ob) is not look(other)
    for each in (ob, other):
        assert np.abs(look(each).positions - positions(each)).max() < ROUNDING
