"""Modifier stacks, meshes and rigs as characters have them."""

from __future__ import annotations

import math

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Matrix
from measure import evaluated_mesh, positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import (
    LENGTH,
    SEGMENTS,
    add_turgor,
    bend,
    carrier,
    character,
    place,
    rig,
    set_strength,
    tube_mesh,
    volume_modifier,
)

FRAME = 15


def _worst(ob: bpy.types.Object, target: float) -> float:
    worst = 0.0
    for frame in (1, 8, FRAME):
        bpy.context.scene.frame_set(frame)
        worst = max(worst, relative_error(ob, target))
    return worst


def _insert_before_armature(ob: bpy.types.Object, kind: str, **settings: object) -> bpy.types.Modifier:
    modifier = ob.modifiers.new(kind.title(), kind)
    for name, value in settings.items():
        setattr(modifier, name, value)
    ob.modifiers.move(len(ob.modifiers) - 1, 0)
    bpy.context.view_layer.update()
    return modifier


@pytest.mark.parametrize(
    ("kind", "settings"),
    [
        ("SUBSURF", {"levels": 1, "render_levels": 1}),
        ("TRIANGULATE", {}),
        ("SOLIDIFY", {"thickness": 0.05}),
        ("SUBSURF", {"levels": 2, "render_levels": 2, "subdivision_type": "SIMPLE"}),
    ],
)
def test_modifiers_before_the_armature(route, kind, settings):
    ob, _ = character()
    _insert_before_armature(ob, kind, **settings)
    rest = volume(ob)
    add_turgor(ob)
    assert len(carrier(ob).data.vertices) == len(evaluated_mesh(ob).vertices)
    assert _worst(ob, rest) < VOLUME_TOLERANCE


def test_other_subdivision_in_renders_is_said(runtime):
    ob, _ = character()
    subdivision = _insert_before_armature(ob, "SUBSURF", levels=1, render_levels=2)
    add_turgor(ob)
    assert "make them equal" in runtime.character(ob.session_uid).findings[0].text
    subdivision.render_levels = 1
    ob.update_tag()
    bpy.context.view_layer.update()
    assert runtime.character(ob.session_uid).bind_findings == ()


def test_simplify_is_followed(route, runtime):
    ob, _ = character()
    _insert_before_armature(ob, "SUBSURF", levels=2, render_levels=2)
    rest = volume(ob)
    add_turgor(ob)
    render = bpy.context.scene.render
    render.use_simplify, render.simplify_subdivision = True, 1
    bpy.context.view_layer.update()
    assert "Rebind" in runtime.character(ob.session_uid).problem
    bpy.context.scene.frame_set(FRAME)
    simplified = positions(ob)
    set_strength(ob, 0.0)
    bpy.context.view_layer.update()
    assert (positions(ob) == simplified).all()
    set_strength(ob, 1.0)
    render.use_simplify = False
    bpy.context.view_layer.update()
    assert _worst(ob, rest) < VOLUME_TOLERANCE


def test_mirror_before_the_armature(route):
    armature = rig()
    mesh = tube_mesh()
    ob = place("Tube", mesh, armature)
    bend(armature)
    _cut_in_half(mesh)
    bpy.context.scene.frame_set(1)
    _insert_before_armature(ob, "MIRROR", use_clip=True)
    rest = volume(ob)
    add_turgor(ob)
    assert _worst(ob, rest) < VOLUME_TOLERANCE


def test_subdivision_after_keeps_what_it_would_make_of_the_exact_mesh(route):
    ob, _ = character()
    ob.modifiers.new("Subdivision", "SUBSURF").levels = 1
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    assert ob.modifiers[1] == volume_modifier(ob)
    with_turgor = volume(ob)
    set_strength(ob, 0.0)
    bpy.context.view_layer.update()
    plain = volume(ob)
    bpy.context.scene.frame_set(1)
    rest = volume(ob)
    assert abs(with_turgor / rest - 1.0) < 0.2 * abs(plain / rest - 1.0)


def test_two_meshes_on_one_rig(route):
    first, armature = character()
    second = place("Second", tube_mesh("Second", segments=8, rings=31), armature)
    bpy.context.scene.frame_set(1)
    rest = volume(first), volume(second)
    add_turgor(first, second)
    assert _worst(first, rest[0]) < VOLUME_TOLERANCE
    assert _worst(second, rest[1]) < VOLUME_TOLERANCE


def test_two_objects_share_one_mesh(route):
    first, _ = character()
    other_rig = rig("Other")
    bend(other_rig, -0.9)
    second = bpy.data.objects.new("Second", first.data)
    bpy.context.scene.collection.objects.link(second)
    second.modifiers.new("Armature", "ARMATURE").object = other_rig
    bpy.context.scene.frame_set(1)
    rest = volume(first)
    add_turgor(first, second)
    assert _worst(first, rest) < VOLUME_TOLERANCE
    assert _worst(second, rest) < VOLUME_TOLERANCE
    bpy.context.scene.frame_set(FRAME)
    assert np.abs(positions(first) - positions(second)).max() > 0.1


def _add_shape_keys(ob: bpy.types.Object) -> bpy.types.Key:
    ob.shape_key_add(name="Basis")
    for name, widening in (("Wide", 0.3), ("Wider", 0.7)):
        key = ob.shape_key_add(name=name)
        key.value = 0.0
        for point, vertex in zip(key.points, ob.data.vertices, strict=True):
            point.co = (vertex.co.x * (1 + widening * vertex.co.z / LENGTH), vertex.co.y, vertex.co.z)
    keys = ob.data.shape_keys
    keys.key_blocks["Wider"].relative_key = keys.key_blocks["Wide"]
    ob.vertex_groups.new(name="Mask").add(range(0, len(ob.data.vertices), 2), 0.5, "REPLACE")
    keys.key_blocks["Wider"].vertex_group = "Mask"
    return keys


@pytest.mark.parametrize("with_subdivision", [False, True])
def test_animated_shape_keys_before_the_armature(route, with_subdivision):
    ob, _ = character()
    keys = _add_shape_keys(ob)
    if with_subdivision:
        _insert_before_armature(ob, "SUBSURF", levels=1, render_levels=1)
    add_turgor(ob)
    for name, values in (("Wide", (0.0, 0.8)), ("Wider", (0.5, -0.4))):
        for frame, value in zip((1, FRAME), values, strict=True):
            keys.key_blocks[name].value = value
            keys.key_blocks[name].keyframe_insert("value", frame=frame)
    for frame in (4, FRAME):
        bpy.context.scene.frame_set(frame)
        live = volume(ob)
        ob.modifiers["Armature"].show_viewport = False
        bpy.context.view_layer.update()
        target = volume(ob)
        ob.modifiers["Armature"].show_viewport = True
        assert abs(live / target - 1.0) < VOLUME_TOLERANCE


def test_muted_and_pinned_shape_keys(route):
    ob, _ = character()
    keys = _add_shape_keys(ob)
    rest = volume(ob)
    keys.key_blocks["Wide"].value, keys.key_blocks["Wide"].mute = 1.0, True
    add_turgor(ob)
    assert _worst(ob, rest) < VOLUME_TOLERANCE


def test_seams_split_by_importers(route):
    ob, armature = character()
    whole = volume(ob)
    split = tube_mesh("Split")
    _split_edges(split)
    split_ob = place("Split", split, armature)
    bpy.context.scene.frame_set(1)
    assert len(split.vertices) > len(ob.data.vertices)
    add_turgor(ob, split_ob)
    bpy.context.scene.frame_set(FRAME)
    assert abs(volume(split_ob) / whole - 1.0) < VOLUME_TOLERANCE


def test_open_mesh_is_capped(route, runtime):
    ob, _ = character(is_open=True)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    figures = runtime.character(ob.session_uid).figures
    assert abs(figures.corrected_deviation) < 1e-4 < abs(figures.skinned_deviation)


def test_several_components_each_keep_their_volume(route):
    armature = rig()
    meshes = [tube_mesh(f"Part{index}", at_x=2.0 * index) for index in range(2)]
    parts = [place(mesh.name, mesh, armature) for mesh in meshes]
    bend(armature)
    bpy.context.scene.frame_set(1)
    with bpy.context.temp_override(active_object=parts[0], selected_editable_objects=parts):
        bpy.ops.object.join()
    ob = parts[0]
    rest = volume(ob)
    add_turgor(ob)
    assert _worst(ob, rest) < VOLUME_TOLERANCE


@pytest.mark.parametrize("frame", [8, FRAME])
def test_an_armature_that_is_off_leaves_the_mesh_alone(route, frame):
    ob, _ = character()
    rest = positions(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(frame)
    ob.modifiers["Armature"].show_viewport = False
    bpy.context.view_layer.update()
    assert (positions(ob) == rest).all()
    ob.modifiers["Armature"].show_viewport = True
    bpy.context.view_layer.update()
    assert (positions(ob) != rest).any()


def test_hidden_object_is_right_when_shown_again(route):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    ob.hide_viewport = True
    bpy.context.scene.frame_set(FRAME)
    ob.hide_viewport = False
    bpy.context.view_layer.update()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_animated_settings_count(route):
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    joint = ob.turgor.joints["Bone1"]
    for frame, size, factor in ((1, 1.0, 1.0), (FRAME, 0.5, 1.2)):
        joint.size, ob.turgor.target_volume = size, factor
        ob.keyframe_insert('turgor.joints["Bone1"].size', frame=frame)
        ob.keyframe_insert("turgor.target_volume", frame=frame)
    bpy.context.scene.frame_set(FRAME)
    assert relative_error(ob, 1.2 * rest) < VOLUME_TOLERANCE
    animated = positions(ob)
    ob.animation_data_clear()
    bpy.context.scene.frame_set(1)
    bpy.context.scene.frame_set(FRAME)
    joint.size, ob.turgor.target_volume = 0.5, 1.2
    bpy.context.view_layer.update()
    assert (positions(ob) == animated).all()


def _cut_in_half(mesh: bpy.types.Mesh) -> None:
    """Keep x >= 0, open at the cut, which passes between vertices."""
    edited = bmesh.new()
    edited.from_mesh(mesh)
    half_a_side = Matrix.Rotation(math.pi / SEGMENTS, 3, "Z")
    bmesh.ops.rotate(edited, verts=edited.verts, matrix=half_a_side)
    everything = [*edited.verts, *edited.edges, *edited.faces]
    bmesh.ops.bisect_plane(edited, geom=everything, plane_co=(0, 0, 0), plane_no=(-1, 0, 0), clear_outer=True)
    edited.to_mesh(mesh)
    edited.free()


def _split_edges(mesh: bpy.types.Mesh) -> None:
    edited = bmesh.new()
    edited.from_mesh(mesh)
    seam = [edge for edge in edited.edges if all(vertex.co.x > 0.49 for vertex in edge.verts)]
    bmesh.ops.split_edges(edited, edges=seam)
    edited.to_mesh(mesh)
    edited.free()
