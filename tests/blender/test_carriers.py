"""Carriers: a mesh of its own for each, offsets of its own character and frame, zero where a frame fails."""

from __future__ import annotations

import ctypes
import importlib

import bpy
import library
import numpy as np
import pytest
import turgor
from body import add_spine, body, bow, curve
from measure import positions
from tube import LAST_FRAME, add_turgor, bend, carrier, character, place, rig, select, tube_mesh, volume_modifier
from turgor import _native

FRAME = 15


def _carriers() -> list[bpy.types.Object]:
    return [ob for ob in bpy.data.objects if ob.turgor.carrier.mesh is not None]


def _overrides(collection: bpy.types.Collection, count: int) -> list[tuple[bpy.types.Object, bpy.types.Object]]:
    """(mesh, armature) of each."""
    scene, found = bpy.context.scene, []
    for _ in range(count):
        made = collection.override_hierarchy_create(scene, bpy.context.view_layer, do_fully_editable=True)
        if made.name not in scene.collection.children:
            scene.collection.children.link(made)
        armature = next(member for member in made.all_objects if member.type == "ARMATURE")
        found.append((library.mesh_of(made.all_objects), armature))
    bpy.context.view_layer.update()
    return found


def _assert_meshes_are_their_own():
    local = [holder for holder in _carriers() if holder.library is None]
    meshes = [holder.turgor.carrier.mesh for holder in local]
    assert len(set(meshes)) == len(local)
    for holder, mesh in zip(local, meshes, strict=True):
        assert mesh.library is None
        assert holder.data == mesh
        sources = [target.id for variable in _tick(holder).variables for target in variable.targets]
        assert [source for source in sources if source in meshes] == [mesh]


def _tick(holder: bpy.types.Object) -> bpy.types.Driver:
    return next(curve.driver for curve in holder.animation_data.drivers if "show_group_selector" in curve.data_path)


def test_overrides_of_one_character_have_carriers_with_meshes_of_their_own(tmp_path):
    ob, armature = character()
    add_turgor(ob)
    pairs = _overrides(library.linked((ob, armature), tmp_path), 3)
    held = {carrier(mesh) for mesh, _ in pairs}
    assert len(held) == 3
    _assert_meshes_are_their_own()
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.context.scene.frame_set(FRAME)
    assert len([holder for holder in _carriers() if holder.library is None]) == 3
    _assert_meshes_are_their_own()


def test_an_override_in_a_fixed_pose_shows_one_shape(tmp_path):
    """However another one of the same character moves beside it, and on whichever threads both are evaluated."""
    ob, armature = character()
    add_turgor(ob)
    (moving, _), (still, still_rig) = _overrides(library.linked((ob, armature), tmp_path), 2)
    still_rig.animation_data.action = None
    still_rig.pose.bones[1].rotation_euler.x = 0.9
    scene = bpy.context.scene
    scene.frame_set(2)
    # Evaluated on every frame: a hair's breadth of a turn.
    shapes, ways = [], []
    for number in range(300):
        still_rig.pose.bones[2].rotation_euler.x = 1e-7 * (number % 2)
        scene.frame_set(1 + number * 7 % LAST_FRAME)
        shapes.append(positions(still))
        ways.append(positions(moving))
    assert max(np.abs(shape - shapes[0]).max() for shape in shapes) <= 1e-5
    by_frame = {}
    for number, way in enumerate(ways):
        assert np.array_equal(by_frame.setdefault(number * 7 % LAST_FRAME, way), way)


def test_carriers_that_share_a_mesh_in_a_file_are_parted_when_it_is_opened(tmp_path):
    armature = rig()
    parts = [place(name, tube_mesh(name, at_x=x), armature) for name, x in (("One", 0.0), ("Other", 3.0))]
    bend(armature)
    add_turgor(*parts)
    bpy.context.scene.frame_set(FRAME)
    expected = [positions(part) for part in parts]
    one, other = (carrier(part) for part in parts)
    other.data = other.turgor.carrier.mesh = one.data
    path = str(tmp_path / "shared.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    _assert_meshes_are_their_own()
    for name, shape in zip(("One", "Other"), expected, strict=True):
        assert np.array_equal(positions(bpy.data.objects[name]), shape)


class _FailingEngine:
    """Writes half a frame of rubbish, then fails."""

    def __init__(self, error: BaseException) -> None:
        self._error = error

    def deform_into_address(self, address: int, vertex_count: int, *_: object, **__: object):
        ctypes.memset(address, 0x41, 12 * (vertex_count // 2))
        raise self._error


@pytest.mark.parametrize(
    "error", [turgor.TurgorError("no"), turgor.FaultError("index"), KeyboardInterrupt(), MemoryError()]
)
def test_a_frame_that_fails_is_plain_skinning_and_says_so(route, runtime, monkeypatch, error):
    ob, _ = character()
    scene = bpy.context.scene
    plain = []
    for frame in (FRAME, FRAME + 1):
        scene.frame_set(frame)
        plain.append(positions(ob))
    add_turgor(ob)
    scene.frame_set(FRAME)
    corrected = positions(ob)
    assert np.abs(corrected - plain[0]).max() > 1e-3
    live = importlib.import_module("addon.live.frame")
    asked = live.read
    monkeypatch.setattr(live, "read", lambda *arguments: asked(*arguments)._replace(engine=_FailingEngine(error)))
    for frame, shape in ((FRAME + 1, plain[1]), (FRAME, plain[0])):
        scene.frame_set(frame)
        assert np.array_equal(positions(ob), shape)
    known = runtime.character(ob.session_uid)
    assert known.problem is not None
    assert known.figures is None
    monkeypatch.undo()
    scene.frame_set(FRAME + 1)
    scene.frame_set(FRAME)
    assert known.problem is None
    if route == "PULL":
        assert np.array_equal(positions(ob), corrected)


def test_a_fault_of_the_engine_is_an_error_that_python_code_expects():
    with pytest.raises(turgor.TurgorError, match=r"lib\.rs[^$]*on purpose"):
        _native._fault("on purpose")


@pytest.mark.parametrize("count", [0, 1, 251, 253, 1000])
def test_room_for_another_number_of_vertices_is_left_alone_and_told(runtime, count):
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    target = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    live = importlib.import_module("addon.live.frame")
    room = np.full((1200, 3), 7.0, np.float32)
    assert len(ob.data.vertices) == 252
    assert live.correct(target, room.ctypes.data, count) is False
    assert (room == 7.0).all()
    assert "252" in runtime.character(ob.session_uid).problem
    assert live.correct(target, room.ctypes.data, 252) is True
    assert runtime.character(ob.session_uid).problem is None
    assert (room[252:] == 7.0).all()
    assert np.abs(room[:252]).max() < 1.0


@pytest.mark.parametrize("count", [0, 1, 491, 493, 1000])
def test_room_for_another_number_of_vertices_along_a_spine_is_left_alone_and_told(runtime, count):
    ob, spine = body(), curve()
    add_spine(ob, spine)
    bow(spine)
    target = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    live = importlib.import_module("addon.live.spine_frame")
    room = np.full((1200, 3), 7.0, np.float32)
    assert len(ob.data.vertices) == 492
    assert live.flesh_frame(target, room.ctypes.data, count) is False
    assert (room == 7.0).all()
    assert "492" in runtime.spine(ob.session_uid).problem
    assert live.flesh_frame(target, room.ctypes.data, 492) is True
    assert (room[492:] == 7.0).all()


def test_figures_are_those_of_the_object_even_where_names_are_equal(tmp_path, runtime):
    """A linked character and a local one of the same name; the modifier of one is off."""
    ob, armature = character()
    add_turgor(ob)
    linked = library.shown(library.linked((ob, armature), tmp_path))
    local, _ = character(linked.name)
    assert local.name == linked.name
    add_turgor(local)
    bpy.context.scene.frame_set(FRAME)
    volume_modifier(local).show_viewport = False
    bpy.context.scene.frame_set(FRAME - 1)
    knowns = [runtime.character(each.session_uid) for each in (linked, local)]
    for each, known in zip((linked, local), knowns, strict=True):
        assert runtime.object_of(each.session_uid, known, bpy.data.objects) == each
    select([local])
    assert all(known.figures is not None for known in knowns)
