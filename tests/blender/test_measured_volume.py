"""A mesh with another volume than was computed is an error, told with its amount; rounding never is."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from body import add_spine, body, chain
from mathutils import Matrix
from measure import volume
from tube import LAST_FRAME, add_turgor, bend, character, select, set_strength, volume_modifier

FRAME = 15


def _error(state):
    return next((found for found in state.findings if found.id == "measured_volume"), None)


def _edit_node_group(ob: bpy.types.Object) -> None:
    """Somebody adds to the offsets in our node group."""
    modifier = next(each for each in ob.modifiers if each.name.startswith("Turgor"))
    nodes, links = modifier.node_group.nodes, modifier.node_group.links
    moved = next(node for node in nodes if node.bl_idname == "GeometryNodeSetPosition")
    source = moved.inputs["Offset"].links[0].from_socket
    scaled = nodes.new("ShaderNodeVectorMath")
    scaled.operation = "SCALE"
    scaled.inputs["Scale"].default_value = 0.9
    links.new(source, scaled.inputs[0])
    links.new(scaled.outputs["Vector"], moved.inputs["Offset"])


def _lose_offsets(ob: bpy.types.Object, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another writer wins: what the engine computed never reaches the carrier."""
    frame_by_kind = importlib.import_module("addon.live.frame_by_kind")
    live = importlib.import_module("addon.live.frame")

    def lossy(target: bpy.types.Object, address: int, vertex_count: int) -> bool:
        room = np.zeros((vertex_count, 3), np.float32)
        live.correct(target, room.ctypes.data, vertex_count)
        return False

    monkeypatch.setitem(frame_by_kind.FRAMES, "VOLUME", lossy)


def _move_by_handler(ob: bpy.types.Object, monkeypatch: pytest.MonkeyPatch) -> None:
    name = ob.name

    def swell(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        data = bpy.data.objects[name].evaluated_get(depsgraph).data.attributes["position"].data
        found = np.empty(3 * len(data), np.float32)
        data.foreach_get("vector", found)
        data.foreach_set("vector", found * np.float32(1.001))

    bpy.app.handlers.frame_change_post.append(swell)


HARMS = {
    "node group edited": lambda ob, _: _edit_node_group(ob),
    "offsets lost": _lose_offsets,
    "moved by a handler": _move_by_handler,
}


@pytest.mark.parametrize("harm", HARMS)
def test_another_volume_than_was_computed_is_an_error(runtime, monkeypatch, harm):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    state = runtime.character(ob.session_uid)
    assert _error(state) is None
    HARMS[harm](ob, monkeypatch)
    bpy.context.scene.frame_set(FRAME + 1)
    found = _error(state)
    assert found is not None
    assert found.severity == "ERROR"
    assert abs(state.figures.corrected_deviation) < 1e-9
    told = float(found.text.values["measured"].removesuffix(" %"))
    assert told == pytest.approx(100.0 * (volume(ob) / rest - 1.0), abs=1e-4)
    assert abs(told) > 0.05


def test_it_is_measured_right_after_ours_whatever_stands_later(runtime, monkeypatch):
    ob, _ = character()
    add_turgor(ob)
    ob.modifiers.new("Smooth", "SMOOTH")
    bpy.context.scene.frame_set(FRAME)
    state = runtime.character(ob.session_uid)
    assert state.figures.shown_deviation < -1.0
    assert _error(state) is None
    _edit_node_group(ob)
    bpy.context.scene.frame_set(FRAME + 1)
    assert _error(state) is not None


def _as_it_is(ob, rig):
    pass


def _dual_quaternions(ob, rig):
    ob.modifiers["Armature"].use_deform_preserve_volume = True


def _far_from_its_origin(ob, rig):
    ob.data.transform(Matrix.Translation((900.0, -400.0, 50.0)))
    ob.matrix_world = Matrix.Translation((-900.0, 400.0, -50.0))


def _far_from_the_world(ob, rig):
    ob.location = rig.location = (5000.0, 3000.0, -100.0)


def _imported_scale(ob, rig):
    rig.scale = (0.01, 0.01, 0.01)
    rig.data.transform(Matrix.Scale(100.0, 4))


def _tiny(ob, rig):
    ob.data.transform(Matrix.Scale(1e-4, 4))
    rig.data.transform(Matrix.Scale(1e-4, 4))


def _many_shape_keys(ob, rig):
    ob.shape_key_add(name="Basis")
    rng = np.random.default_rng(5)
    for number in range(30):
        key = ob.shape_key_add(name=f"Key{number}")
        key.value = rng.uniform(0.0, 1.0)
        for point in key.data:
            point.co.x += 0.002 * rng.standard_normal()


def _strength(ob, rig):
    set_strength(ob, 0.5)


def _weak_joint(ob, rig):
    ob.turgor.joints["Bone1"].strength = 0.3


def _off(ob, rig):
    volume_modifier(ob).show_viewport = False


def _armature_off(ob, rig):
    ob.modifiers["Armature"].show_viewport = False


def _open(ob, rig):
    ob.modifiers["Armature"].vertex_group = "Bone1"


SOUND = (
    _as_it_is,
    _dual_quaternions,
    _far_from_its_origin,
    _far_from_the_world,
    _imported_scale,
    _tiny,
    _many_shape_keys,
    _open,
)
CHANGED_LATER = (_strength, _weak_joint, _off, _armature_off)


@pytest.mark.parametrize("make", SOUND + CHANGED_LATER, ids=lambda make: make.__name__)
@pytest.mark.parametrize("is_open", [False, True])
def test_rounding_and_what_is_meant_are_no_error(route, runtime, make, is_open):
    ob, rig = character(is_open=is_open)
    bend(rig, 2.0)
    if make in SOUND:
        make(ob, rig)
        bpy.context.view_layer.update()
    add_turgor(ob)
    if make in CHANGED_LATER:
        make(ob, rig)
    state = runtime.character(ob.session_uid)
    for frame in (1, 5, 12, LAST_FRAME):
        bpy.context.scene.frame_set(frame)
        assert _error(state) is None
        assert state.problem is None


def test_the_bound_is_small(runtime):
    """An error of a hundredth of a per cent is seen."""
    stack_volumes = importlib.import_module("addon.logic.stack_volumes")
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    mesh = runtime.character(ob.session_uid).binding.body.mesh
    points = np.asarray(mesh.rest_positions)
    bound = stack_volumes.rounding_volume(mesh, points, float(np.abs(points).max()))
    assert bound / mesh.volume(points) < 1e-4
    rng = np.random.default_rng(1)
    step = stack_volumes.ROUNDINGS * stack_volumes.HALF_ULP * np.abs(points).max()
    for _ in range(20):
        moved = points + step * rng.uniform(-1.0, 1.0, points.shape)
        assert abs(mesh.volume(moved) - mesh.volume(points)) <= bound


@pytest.mark.parametrize("keep_volume", [False, True])
def test_the_figure_of_a_spine_is_measured_too(route, runtime, keep_volume):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    ob.turgor_spine.keep_volume = keep_volume
    rest = volume(ob)
    bend(rig, 0.7)
    state = runtime.spine(ob.session_uid)
    for frame in (1, FRAME, LAST_FRAME):
        bpy.context.scene.frame_set(frame)
        assert state.figures.shown_deviation == pytest.approx(100.0 * (volume(ob) / rest - 1.0), abs=2e-5)
        assert _error(state) is None
    _edit_node_group(ob)
    bpy.context.scene.frame_set(FRAME)
    assert _error(state).severity == "ERROR"
    assert state.figures.shown_deviation == pytest.approx(100.0 * (volume(ob) / rest - 1.0), abs=2e-5)
    ob.modifiers.new("Subdivision", "SUBSURF")
    bpy.context.scene.frame_set(LAST_FRAME)
    assert state.figures.shown_deviation is None


def test_measuring_over_frames_measures_meshes(route, runtime):
    """Of each frame right after ours and at the end, as this folder's own measure finds them; nothing else changes."""
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    smooth = ob.modifiers.new("Smooth", "SMOOTH")
    bpy.context.scene.frame_set(7)
    select([ob])
    assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}
    motion = runtime.character(ob.session_uid).motion
    assert bpy.context.scene.frame_current == 7
    assert np.abs(motion.measured_deviations).max() < 1e-4
    assert motion.is_measured
    assert (motion.seen_deviations == motion.final_deviations).all()
    for place in (0, 9, LAST_FRAME - 1):
        bpy.context.scene.frame_set(int(motion.frames[place]))
        assert motion.final_deviations[place] == pytest.approx(100.0 * (volume(ob) / rest - 1.0), abs=2e-5)
    smooth.show_viewport = False
    ob.modifiers.new("Subdivision", "SUBSURF")
    bpy.context.view_layer.update()
    assert bpy.ops.object.turgor_volume_measure() == {"FINISHED"}
    motion = runtime.character(ob.session_uid).motion
    assert not motion.is_measured
    assert np.isnan(motion.final_deviations).all()
    assert (motion.seen_deviations == motion.corrected_deviations).all()
