"""What is off is found, said, and mended by its button; undo takes the button back."""

from __future__ import annotations

from collections.abc import Callable

import bmesh
import bpy
import library
import numpy as np
import pytest
from body import add_spine, body, chain
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import SEGMENTS, add_turgor, bend, character, select, set_strength, volume_modifier

FRAME = 15


def _found(runtime, ob: bpy.types.Object, name: str):
    """The finding of this id, or None."""
    return next((found for found in runtime.character(ob.session_uid).findings if found.id == name), None)


def _press(ob: bpy.types.Object, found, kind: str = "VOLUME") -> None:
    select([ob])
    assert bpy.ops.object.turgor_volume_fix(fix=found.fix, subject=found.subject, kind=kind) == {"FINISHED"}
    if ob.mode == "EDIT":
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()


def _settle(ob: bpy.types.Object, frame: int = FRAME) -> None:
    ob.update_tag()
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(frame)


def _second_armature_after(ob, rig):
    ob.modifiers.new("Second", "ARMATURE").object = rig


def _simulated_before(ob, rig):
    ob.modifiers.new("Cloth", "CLOTH")
    ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _built_before(ob, rig):
    ob.modifiers.new("Build", "BUILD").frame_duration = 1
    ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _subdivided_between(ob, rig):
    ob.modifiers.new("Subdivision", "SUBSURF")
    ob.modifiers.move(len(ob.modifiers) - 1, 1)


def _deforming_parent(ob, rig):
    ob.parent, ob.parent_type = rig, "ARMATURE"


def _moved_before(ob, rig):
    ob.modifiers.move(1, 0)


def _other_levels(ob, rig):
    ob.modifiers.new("Simple", "SUBSURF").subdivision_type = "SIMPLE"
    ob.modifiers["Simple"].levels, ob.modifiers["Simple"].render_levels = 0, 2
    ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _viewport_only(ob, rig):
    ob.modifiers.new("Triangulate", "TRIANGULATE").show_viewport = False
    ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _off_in_viewport(ob, rig):
    volume_modifier(ob).show_viewport = False


def _off_in_renders(ob, rig):
    volume_modifier(ob).show_render = False


HARMS: list[tuple[Callable, str, str]] = [
    (_second_armature_after, "second_armature", "ERROR"),
    (_simulated_before, "simulation", "ERROR"),
    (_built_before, "moving_modifier", "ERROR"),
    (_subdivided_between, "posed_topology", "ERROR"),
    (_deforming_parent, "deforming_parent", "ERROR"),
    (_moved_before, "modifier_order", "ERROR"),
    (_other_levels, "render_levels", "WARNING"),
    (_viewport_only, "render_switch", "WARNING"),
    (_off_in_viewport, "off_in_viewport", "INFO"),
    (_off_in_renders, "off_in_renders", "WARNING"),
]


@pytest.mark.parametrize(("harm", "name", "severity"), HARMS, ids=lambda value: getattr(value, "__name__", ""))
def test_harm_is_found_mended_by_its_button_and_found_again_after_undo(route, runtime, harm, name, severity):
    ob, rig = character()
    rest = volume(ob)
    add_turgor(ob)
    harm(ob, rig)
    _settle(ob)
    found = _found(runtime, ob, name)
    assert found is not None
    assert (found.severity, found.refusal) == (severity, "")
    stack = [(modifier.name, modifier.show_viewport, modifier.show_render) for modifier in ob.modifiers]
    harmed = positions(ob)
    bpy.ops.ed.undo_push(message="harmed")
    _press(ob, found)
    _settle(ob)
    assert _found(runtime, ob, name) is None
    assert runtime.character(ob.session_uid).problem is None
    if ob.modifiers[-1].type not in {"CLOTH", "SUBSURF"}:
        assert relative_error(ob, rest) < VOLUME_TOLERANCE
    bpy.ops.ed.undo_push(message="mended")
    bpy.ops.ed.undo()
    ob = bpy.data.objects["Tube"]
    _settle(ob)
    assert [(modifier.name, modifier.show_viewport, modifier.show_render) for modifier in ob.modifiers] == stack
    assert _found(runtime, ob, name) is not None
    assert np.abs(positions(ob) - harmed).max() < 1e-6


def _several_that_build(ob, rig):
    for name in ("One", "Two"):
        ob.modifiers.new(name, "BUILD")
        ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _several_that_simulate(ob, rig):
    for kind in ("CLOTH", "DYNAMIC_PAINT"):
        ob.modifiers.new(kind, kind)
        ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _several_armatures(ob, rig):
    for number in range(3):
        ob.modifiers.new(f"More {number}", "ARMATURE").object = rig


def _several_other_levels(ob, rig):
    for name in ("One", "Two"):
        simple = ob.modifiers.new(name, "SUBSURF")
        simple.subdivision_type, simple.levels, simple.render_levels = "SIMPLE", 0, 2
        ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _several_switches(ob, rig):
    for name in ("One", "Two"):
        ob.modifiers.new(name, "TRIANGULATE").show_viewport = False
        ob.modifiers.move(len(ob.modifiers) - 1, 0)


@pytest.mark.parametrize(
    ("harm", "name", "count"),
    [
        (_several_that_build, "moving_modifier", 2),
        (_several_that_simulate, "simulation", 2),
        (_several_armatures, "second_armature", 3),
        (_several_other_levels, "render_levels", 2),
        (_several_switches, "render_switch", 2),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_several_of_a_kind_are_one_finding_with_one_button(runtime, harm, name, count):
    ob, rig = character()
    add_turgor(ob)
    harm(ob, rig)
    order = [modifier.name for modifier in ob.modifiers]
    _settle(ob)
    alike = [each for each in runtime.character(ob.session_uid).findings if each.id == name]
    assert len(alike) == 1
    assert str(count) in alike[0].text
    subjects = alike[0].subject.splitlines()
    assert len(subjects) == count
    assert all(subject in alike[0].text for subject in subjects[:3])
    _press(ob, alike[0])
    _settle(ob)
    assert _found(runtime, ob, name) is None
    assert runtime.character(ob.session_uid).problem is None
    if alike[0].fix == "MOVE_AFTER":
        moved = [modifier.name for modifier in ob.modifiers]
        assert [each for each in moved if each in subjects] == [each for each in order if each in subjects]


def test_a_healthy_character_has_no_finding(runtime):
    ob, _ = character()
    add_turgor(ob)
    _settle(ob, 3)
    assert runtime.session.route == "PULL"
    assert [found.id for found in runtime.character(ob.session_uid).findings] == []


def test_open_edges_are_told_and_selected(runtime):
    ob, _ = character(is_open=True)
    add_turgor(ob)
    found = _found(runtime, ob, "open_part")
    assert found.severity == "INFO"
    assert str(2 * SEGMENTS) in found.text
    _press(ob, found)
    selected = np.empty(len(ob.data.edges), bool)
    ob.data.edges.foreach_get("select", selected)
    assert selected.sum() == 2 * SEGMENTS
    heights = {round(ob.data.vertices[v].co.z, 3) for e in ob.data.edges if e.select for v in e.vertices}
    assert heights == {0.0, 4.0}


def test_seams_are_no_open_edges(runtime):
    """Points split at seams are one point."""
    ob, _ = character()
    select([ob])
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.edge_split(type="EDGE")
    bpy.ops.object.mode_set(mode="OBJECT")
    add_turgor(ob)
    assert _found(runtime, ob, "open_part") is None
    bpy.ops.object.turgor_volume_fix(fix="SELECT_OPEN_EDGES", kind="VOLUME")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not any(edge.select for edge in ob.data.edges)


def test_a_fin_of_three_faces_is_told_and_selected(runtime):
    ob, _ = character()
    edited = bmesh.new()
    edited.from_mesh(ob.data)
    edited.verts.ensure_lookup_table()
    edited.faces.new([edited.verts[0], edited.verts[1], edited.verts.new((2.0, 0.0, 0.1))])
    edited.to_mesh(ob.data)
    edited.free()
    add_turgor(ob)
    found = _found(runtime, ob, "non_manifold_part")
    assert found.severity == "WARNING"
    _press(ob, found)
    assert [set(edge.vertices) for edge in ob.data.edges if edge.select] == [{0, 1}]


@pytest.mark.parametrize(("count", "name"), [(None, "inverted_normals"), (7, "mixed_normals")])
def test_normals_are_recalculated_and_bound_anew(route, runtime, count, name):
    ob, _ = character()
    rest = volume(ob)
    normals = [polygon.normal.copy() for polygon in ob.data.polygons]
    for polygon in list(ob.data.polygons)[:count]:
        polygon.flip()
    ob.data.update()
    add_turgor(ob)
    found = _found(runtime, ob, name)
    assert found.severity == "WARNING"
    _press(ob, found)
    _settle(ob)
    assert _found(runtime, ob, name) is None
    assert runtime.character(ob.session_uid).problem is None
    assert all(polygon.normal.dot(n) > 0.99 for polygon, n in zip(ob.data.polygons, normals, strict=True))
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_vertices_without_weights_are_told_and_selected(runtime):
    ob, _ = character()
    for group in ob.vertex_groups:
        group.remove([5, 40, 41])
    add_turgor(ob)
    found = _found(runtime, ob, "unweighted")
    assert "3" in found.text
    _press(ob, found)
    assert [vertex.index for vertex in ob.data.vertices if vertex.select] == [5, 40, 41]


def test_a_joint_out_of_room_gets_more(route, runtime):
    ob, rig = character()
    bend(rig, 2.0)
    add_turgor(ob)
    for joint in ob.turgor.joints:
        joint.size = 0.3
    _settle(ob, 20)
    presses = 0
    while (found := _found(runtime, ob, "capped")) is not None:
        names = found.subject.splitlines()
        sizes = {joint.name: joint.size for joint in ob.turgor.joints}
        _press(ob, found)
        _settle(ob, 20)
        larger = {name: size * (1.5 if name in names else 1.0) for name, size in sizes.items()}
        assert {joint.name: joint.size for joint in ob.turgor.joints} == pytest.approx(larger)
        presses += 1
    assert 2 <= presses < 9


def test_what_settings_leave_out_is_told(runtime):
    ob, _ = character()
    add_turgor(ob)
    ob.turgor.joints["Bone1"].strength = 0.5
    _settle(ob)
    assert "Bone1" in _found(runtime, ob, "joint_strength").text
    ob.turgor.joints["Bone1"].strength = 1.0
    set_strength(ob, 0.5)
    _settle(ob)
    assert _found(runtime, ob, "joint_strength") is None
    assert "0.50" in _found(runtime, ob, "strength").text


def test_push_and_a_mirrored_object_are_told(runtime, route):
    ob, _ = character()
    add_turgor(ob)
    ob.scale.x = -1.0
    _settle(ob)
    assert (_found(runtime, ob, "push_route") is not None) == (route == "PUSH")
    assert _found(runtime, ob, "negative_scale") is not None
    ob.scale.x = 1.0
    _settle(ob)
    assert _found(runtime, ob, "negative_scale") is None


def test_each_finding_is_logged_once(runtime, warnings_logged):
    ob, rig = character()
    for group in ob.vertex_groups:
        group.remove([5])
    add_turgor(ob)
    for _ in range(3):
        ob.parent, ob.parent_type = rig, "ARMATURE"
        _settle(ob)
        ob.parent_type = "OBJECT"
        _settle(ob)
    lines = warnings_logged()
    assert len([line for line in lines if "no bone holds" in line]) == 1
    assert len([line for line in lines if "deforms the mesh" in line]) == 1


def test_fixes_of_linked_data_are_refused_with_a_reason(runtime, tmp_path):
    ob, rig = character(is_open=True)
    add_turgor(ob)
    linked = library.shown(library.linked((ob, rig), tmp_path))
    bpy.context.scene.frame_set(FRAME)
    assert _found(runtime, linked, "linked") is not None
    assert "linked" in _found(runtime, linked, "open_part").refusal
    bpy.context.view_layer.objects.active = linked
    assert not bpy.ops.object.turgor_volume_fix.poll()


def test_a_spine_has_findings_and_buttons_too(route, runtime):
    ob, rig = body(), chain()
    add_spine(ob, rig)
    ob.modifiers.new("Wave", "WAVE").show_render = False
    ob.modifiers.move(1, 0)
    _settle(ob)
    known = runtime.spine(ob.session_uid)
    found = next(found for found in known.findings if found.id == "moving_modifier")
    _press(ob, found, "SPINE")
    _settle(ob)
    assert known.problem is None
    assert [modifier.name for modifier in ob.modifiers] == ["Turgor Spine", "Wave"]


def test_looking_costs_nothing_while_posing(route, runtime):
    """Findings of the stack are looked up again only when it changes."""
    ob, rig = character()
    add_turgor(ob)
    rig.animation_data_clear()
    bpy.context.view_layer.update()
    before = runtime.character(ob.session_uid).stack_findings
    for angle in (0.1, 0.2, 0.3):
        rig.pose.bones["Bone1"].rotation_euler.x = angle
        bpy.context.view_layer.update()
        assert runtime.character(ob.session_uid).stack_findings is before
