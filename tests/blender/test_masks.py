"""Masks: pinned vertices are as skinned, the volume stays exact, and the mesh follows the brush."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from itertools import pairwise

import bpy
import library
import numpy as np
import pytest
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import RINGS, SEGMENTS, add_turgor, character, select, set_strength

FRAME = 15
COUNT = RINGS * SEGMENTS
LEFT = [index for index in range(COUNT) if index % SEGMENTS < SEGMENTS // 2]


def _group(ob: bpy.types.Object, name: str, vertices: Iterable[int], weight: float = 1.0) -> bpy.types.VertexGroup:
    group = ob.vertex_groups.get(name) or ob.vertex_groups.new(name=name)
    group.add(list(vertices), weight, "REPLACE")
    ob.data.update_tag()
    bpy.context.view_layer.update()
    return group


def _shown(ob: bpy.types.Object, frame: int = FRAME) -> np.ndarray:
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(frame)
    return positions(ob)


def _skinned(ob: bpy.types.Object) -> np.ndarray:
    set_strength(ob, 0.0)
    plain = _shown(ob)
    set_strength(ob, 1.0)
    return plain


def _findings(runtime, ob: bpy.types.Object) -> list[str]:
    return [found.id for found in runtime.character(ob.session_uid).findings]


@pytest.fixture
def engines(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Engines that were made."""
    module = importlib.import_module("addon.logic.body")
    made: list[object] = []
    bind = module.bind

    def counted(*read: object) -> object:
        made.append(bind(*read))
        return made[-1]

    monkeypatch.setattr(module, "bind", counted)
    return made


def _paint(ob: bpy.types.Object, name: str, vertices: Iterable[int], weight: float = 1.0) -> np.ndarray:
    """Positions after a dab and a moment."""
    _group(ob, name, vertices, weight)
    while importlib.import_module("addon.live.strokes").finish() is not None:
        pass
    bpy.context.view_layer.update()
    return positions(ob)


@pytest.mark.parametrize("solver", ["SIMULTANEOUS", "SEQUENTIAL"])
def test_pinned_vertices_are_as_skinned_and_the_volume_is_exact(route, solver):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    ob.turgor.solver = solver
    free = _shown(ob)
    _group(ob, "Fixed", LEFT)
    ob.turgor.pin_group = "Fixed"
    pinned, plain = _shown(ob), _skinned(ob)
    assert (pinned[LEFT] == plain[LEFT]).all()
    assert (free[LEFT] != plain[LEFT]).any()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_a_mask_and_the_inverse_of_its_complement_are_one(route):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    _group(ob, "Some", LEFT, 0.75)
    _group(ob, "Others", set(range(COUNT)) - set(LEFT), 1.0)
    _group(ob, "Others", LEFT, 0.25)
    ob.turgor.vertex_group = "Some"
    some = _shown(ob)
    ob.turgor.vertex_group, ob.turgor.invert_vertex_group = "Others", True
    assert (_shown(ob) == some).all()
    ob.turgor.vertex_group, ob.turgor.invert_vertex_group, ob.turgor.pin_group = "", False, "Others"
    assert np.abs(_shown(ob) - some).max() < 1e-6
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_a_mask_of_all_vertices_is_none(route):
    ob, _ = character()
    add_turgor(ob)
    free = _shown(ob)
    _group(ob, "All", range(COUNT))
    ob.turgor.vertex_group = "All"
    assert np.abs(_shown(ob) - free).max() < 1e-6
    ob.turgor.vertex_group = ""
    assert (_shown(ob) == free).all()


def test_frames_are_the_same_in_any_order(route):
    ob, _ = character()
    add_turgor(ob)
    _group(ob, "Some", LEFT)
    ob.turgor.vertex_group = "Some"
    forwards = {frame: _shown(ob, frame) for frame in (3, 9, 15)}
    for frame in (15, 3, 9):
        assert (_shown(ob, frame) == forwards[frame]).all()


def test_choosing_a_mask_makes_no_new_engine(route, engines):
    ob, _ = character()
    add_turgor(ob)
    _group(ob, "Some", LEFT)
    engines.clear()
    for name, is_inverted in (("Some", False), ("Some", True), ("", False)):
        ob.turgor.vertex_group, ob.turgor.invert_vertex_group = name, is_inverted
        _shown(ob)
    assert not engines


def test_the_mesh_follows_the_brush_as_if_the_mode_was_left(route, engines, tmp_path):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    select([ob])
    bpy.context.scene.frame_set(FRAME)
    assert bpy.ops.object.turgor_mask_paint(mask="pin_group") == {"FINISHED"}
    assert ob.mode == "WEIGHT_PAINT"
    name = ob.turgor.pin_group
    assert ob.vertex_groups.active.name == name
    bpy.context.view_layer.update()
    before = positions(ob)
    engines.clear()
    shown = [_paint(ob, name, dab) for dab in (LEFT[:20], LEFT[20:60], LEFT[60:])]
    assert all((one != other).any() for one, other in pairwise([before, *shown]))
    assert relative_error(ob, rest) < VOLUME_TOLERANCE
    bpy.ops.object.mode_set(mode="OBJECT")
    assert (_shown(ob) == shown[-1]).all()
    assert not engines
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert (_shown(bpy.data.objects["Tube"]) == shown[-1]).all()
    assert not [group for group in bpy.data.node_groups if "Groups" in group.name]
    assert len(bpy.data.scenes) == 1


def test_the_last_dab_is_never_lost(route, runtime):
    """A mesh that takes long to read is read less often."""
    ob, _ = character()
    add_turgor(ob)
    select([ob])
    bpy.context.scene.frame_set(FRAME)
    bpy.ops.object.turgor_mask_paint(mask="vertex_group")
    bpy.context.view_layer.update()
    name = ob.turgor.vertex_group
    before = _paint(ob, name, LEFT[:5], 0.5)
    for part in range(20):
        runtime.character(ob.session_uid).mask_seconds = 0.05
        _group(ob, name, LEFT, part / 40)
    last = _paint(ob, name, LEFT[:5], 0.9)
    assert (last != before).any()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert (_shown(ob) == last).all()


def test_skin_weights_are_bound_when_the_brush_is_lifted(route):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    select([ob])
    bpy.context.scene.frame_set(FRAME)
    ob.vertex_groups.active = ob.vertex_groups["Bone1"]
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    _group(ob, "Bone1", range(120), 0.7)
    strokes = importlib.import_module("addon.live.strokes")
    assert strokes.finish(is_stroking=True) is not None
    assert strokes.finish() is None
    bpy.context.view_layer.update()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE
    live = positions(ob)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert (_shown(ob) == live).all()


def test_nothing_changes_when_a_mask_is_begun(route):
    ob, _ = character()
    add_turgor(ob)
    select([ob])
    free = _shown(ob)
    for mask in ("vertex_group", "pin_group"):
        bpy.ops.object.turgor_mask_paint(mask=mask)
        assert np.abs(_shown(ob) - free).max() < 1e-6
        bpy.ops.object.mode_set(mode="OBJECT")


def test_masks_of_a_subdivided_mesh(route):
    ob, _ = character()
    subdivision = ob.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = subdivision.render_levels = 1
    ob.modifiers.move(1, 0)
    bpy.context.view_layer.update()
    rest = volume(ob)
    add_turgor(ob)
    _group(ob, "Fixed", LEFT)
    ob.turgor.pin_group = "Fixed"
    pinned, plain = _shown(ob), _skinned(ob)
    assert (pinned[LEFT] == plain[LEFT]).all()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_a_renamed_group_is_followed_and_a_deleted_one_told(route, runtime):
    ob, _ = character()
    add_turgor(ob)
    free = _shown(ob)
    _group(ob, "Some", LEFT)
    ob.turgor.vertex_group = ob.turgor.pin_group = "Some"
    ob.turgor.pin_group = ""
    masked = _shown(ob)
    ob.vertex_groups["Some"].name = "Other"
    ob.update_tag()
    assert (_shown(ob) == masked).all()
    assert ob.turgor.vertex_group == "Other"
    ob.vertex_groups.remove(ob.vertex_groups["Other"])
    ob.update_tag()
    assert (_shown(ob) == free).all()
    assert "mask_group_missing" in _findings(runtime, ob)
    select([ob])
    bpy.ops.object.turgor_volume_fix(fix="CLEAR_GROUP", subject="Other", kind="VOLUME")
    _shown(ob)
    assert ob.turgor.vertex_group == ""
    assert "mask_group_missing" not in _findings(runtime, ob)


def test_all_pinned_is_plain_skinning_and_told(route, runtime):
    ob, _ = character()
    add_turgor(ob)
    _group(ob, "Fixed", range(COUNT))
    ob.turgor.pin_group = "Fixed"
    assert (_shown(ob) == _skinned(ob)).all()
    assert "all_pinned" in _findings(runtime, ob)
    ob.turgor.pin_group = ""
    _shown(ob)
    assert "all_pinned" not in _findings(runtime, ob)


def test_undo_takes_a_mask_back_and_redo_gives_it_again(route):
    ob, _ = character()
    add_turgor(ob)
    _group(ob, "Some", LEFT)
    free = _shown(ob)
    bpy.ops.ed.undo_push(message="free")
    ob.turgor.vertex_group = "Some"
    masked = _shown(ob)
    bpy.ops.ed.undo_push(message="masked")
    bpy.ops.ed.undo()
    assert (_shown(bpy.data.objects["Tube"]) == free).all()
    bpy.ops.ed.redo()
    assert (_shown(bpy.data.objects["Tube"]) == masked).all()


def test_masks_of_a_linked_and_overridden_character(tmp_path):
    ob, rig = character()
    rest = volume(ob)
    add_turgor(ob)
    _group(ob, "Some", LEFT)
    _group(ob, "Fixed", LEFT[:30])
    ob.turgor.vertex_group = "Some"
    expected = _shown(ob)
    tube = library.overridden(library.linked((ob, rig), tmp_path))
    assert (_shown(tube) == expected).all()
    tube.turgor.pin_group = "Fixed"
    tube.update_tag()
    assert (_shown(tube) != expected).any()
    assert relative_error(tube, rest) < VOLUME_TOLERANCE


def test_reading_a_mask_does_not_go_round_in_circles(route, monkeypatch):
    ob, _ = character()
    add_turgor(ob)
    select([ob])
    bpy.ops.object.turgor_mask_paint(mask="pin_group")
    bpy.context.view_layer.update()
    module = importlib.import_module("addon.live.masks")
    reads: list[bpy.types.Object] = []
    read_mask = module.read_mask

    def counted(target: bpy.types.Object) -> np.ndarray | None:
        reads.append(target)
        return read_mask(target)

    monkeypatch.setattr(module, "read_mask", counted)
    for _ in range(5):
        _paint(ob, ob.turgor.pin_group, LEFT)
        bpy.context.view_layer.update()
    assert 5 <= len(reads) <= 10


def test_a_dragged_slider_reads_the_mesh_once_when_it_rests(monkeypatch):
    """Blender says of a setting that the mesh changed too."""
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    strokes = importlib.import_module("addon.live.strokes")
    monkeypatch.setattr(strokes, "CAN_WAIT", True)
    binding = importlib.import_module("addon.live.binding")
    bind, binds = binding.bind, []
    monkeypatch.setattr(binding, "bind", lambda target: (binds.append(target), bind(target)))
    shown = []
    for strength in (0.9, 0.7, 0.5):
        ob.turgor.joints["Bone1"].strength = strength
        bpy.context.view_layer.update()
        shown.append(positions(ob))
    assert all((one != other).any() for one, other in pairwise(shown))
    assert not binds
    while strokes.finish() is not None:
        pass
    assert len(binds) == 1
    bpy.context.view_layer.update()
    assert (positions(ob) == shown[-1]).all()
