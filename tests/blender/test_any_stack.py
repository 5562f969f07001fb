"""Any stack, as it comes: exact on every frame beside what Blender evaluates, or refused by name; never silent."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import evaluated_mesh, mesh_positions, mesh_volume, positions, volume
from stacks import KINDS, body_copy, keyed, moving_empty, new, pushed_out, second_rig, worst_error
from test_exact import VOLUME_TOLERANCE
from tube import LAST_FRAME, LENGTH, add_turgor, character, select, set_strength, volume_modifier

# Before the Armature they make the same body on every frame.
STILL = frozenset({"laplacian smooth", "smooth", "nodes with an input"})


def _finding(runtime, ob: bpy.types.Object, name: str):
    return next((found for found in runtime.character(ob.session_uid).findings if found.id == name), None)


def _check(runtime, ob: bpy.types.Object, body: bpy.types.Object, *, is_evaluated: bool = True) -> None:
    """Exact beside the body, and told that it is read as Blender evaluates it."""
    assert runtime.character(ob.session_uid).problem is None
    worst = worst_error(ob, body)
    assert runtime.character(ob.session_uid).problem is None
    assert (_finding(runtime, ob, "evaluated") is not None) == is_evaluated
    assert worst < VOLUME_TOLERANCE
    print(f"worst {worst:.1e}")


@pytest.mark.parametrize("kind", KINDS)
def test_between_the_armature_and_ours(runtime, kind):
    ob, _ = character()
    KINDS[kind](ob)
    body = body_copy(ob, ob.modifiers["Armature"])
    add_turgor(ob)
    ours = volume_modifier(ob)
    ob.modifiers.move(list(ob.modifiers).index(ours), len(ob.modifiers) - 1)
    bpy.context.view_layer.update()
    plain = body_copy(ob, ours)
    _check(runtime, ob, body)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert abs(volume(plain) / volume(body) - 1.0) > 1e-3


@pytest.mark.parametrize("kind", KINDS)
def test_before_the_armature(runtime, kind):
    ob, _ = character()
    modifier = KINDS[kind](ob)
    armature = ob.modifiers["Armature"]
    ob.modifiers.move(list(ob.modifiers).index(armature), len(ob.modifiers) - 1)
    first = modifier if kind == "second rig" else armature
    body = body_copy(ob, first)
    add_turgor(ob)
    _check(runtime, ob, body, is_evaluated=kind not in STILL)


@pytest.mark.parametrize("kind", KINDS)
def test_without_an_armature(runtime, kind):
    ob, _ = character()
    ob.modifiers.remove(ob.modifiers["Armature"])
    KINDS[kind](ob)
    body = body_copy(ob, None)
    add_turgor(ob)
    assert ob.modifiers[-1] == volume_modifier(ob)
    _check(runtime, ob, body, is_evaluated=kind != "second rig")


def _half(ob: bpy.types.Object, name: str) -> None:
    group = ob.vertex_groups.new(name=name)
    for vertex in ob.data.vertices:
        group.add([vertex.index], 0.7 * vertex.co.z / LENGTH, "REPLACE")


def _pair(ob: bpy.types.Object) -> None:
    """As riggers hide the loss: the second one blended in by a painted mask, with Preserve Volume."""
    _half(ob, "Preserve")
    second = new(ob, "ARMATURE", object=ob.modifiers["Armature"].object)
    second.use_multi_modifier = second.use_deform_preserve_volume = True
    second.vertex_group = "Preserve"


def _two_rigs_blended(ob: bpy.types.Object) -> None:
    _half(ob, "Blend")
    second = second_rig(ob)
    second.use_multi_modifier, second.vertex_group, second.invert_vertex_group = True, "Blend", True


def _animated_armature(ob: bpy.types.Object) -> None:
    _half(ob, "Part")
    ob.modifiers["Armature"].vertex_group = "Part"
    keyed(ob, 'modifiers["Armature"].invert_vertex_group', False, True)


def _preserve_volume_keyed(ob: bpy.types.Object) -> None:
    keyed(ob, 'modifiers["Armature"].use_deform_preserve_volume', False, True)


def _armature_seen_by_a_driver(ob: bpy.types.Object) -> None:
    """Its switch is driven, and what follows it moves on."""
    new(ob, "CORRECTIVE_SMOOTH", iterations=3)
    KINDS["lattice"](ob)
    driver = ob.driver_add('modifiers["Armature"].show_viewport').driver
    driver.type, driver.expression = "SCRIPTED", "frame > 10"


def _multi_modifier_alone(ob: bpy.types.Object) -> None:
    ob.modifiers["Armature"].use_multi_modifier = True


def _second_is_off_in_viewport(ob: bpy.types.Object) -> None:
    second_rig(ob).show_viewport = False


def _everything(ob: bpy.types.Object) -> None:
    for kind in ("corrective smooth", "lattice", "keyed", "hook", "surface deform", "wave", "second rig"):
        KINDS[kind](ob)


POSED = [
    _pair,
    _two_rigs_blended,
    _animated_armature,
    _preserve_volume_keyed,
    _armature_seen_by_a_driver,
    _multi_modifier_alone,
    _second_is_off_in_viewport,
    _everything,
]


@pytest.mark.parametrize("setup", POSED, ids=lambda setup: setup.__name__)
def test_posed_in_ways_that_rigs_use(route, runtime, setup):
    ob, _ = character()
    setup(ob)
    body = body_copy(ob, ob.modifiers["Armature"])
    add_turgor(ob)
    ob.modifiers.move(list(ob.modifiers).index(volume_modifier(ob)), len(ob.modifiers) - 1)
    bpy.context.view_layer.update()
    _check(runtime, ob, body)


@pytest.mark.parametrize("kind", ["bendy", "envelopes", "envelope multiply"])
def test_bones_that_the_engine_does_not_skin_by_amid_others(runtime, kind):
    ob, rig = character()
    new(ob, "CORRECTIVE_SMOOTH", iterations=3)
    body = body_copy(ob, ob.modifiers["Armature"])
    add_turgor(ob)
    ob.modifiers.move(list(ob.modifiers).index(volume_modifier(ob)), len(ob.modifiers) - 1)
    if kind == "bendy":
        rig.data.bones["Bone1"].bbone_segments = 5
    elif kind == "envelopes":
        ob.modifiers["Armature"].use_bone_envelopes = True
    else:
        rig.data.bones["Bone1"].use_envelope_multiply = True
    bpy.context.view_layer.update()
    _check(runtime, ob, body)


def _keys(ob: bpy.types.Object) -> bpy.types.Key:
    ob.shape_key_add(name="Basis")
    for name, widening in (("Wide", 0.5), ("Low", -0.3)):
        key = ob.shape_key_add(name=name)
        key.value = 0.0
        points = mesh_positions(ob.data)
        points[:, 0] *= 1.0 + widening * points[:, 2] / LENGTH
        key.points.foreach_set("co", points.ravel())
    return ob.data.shape_keys


def _absolute(ob: bpy.types.Object) -> None:
    keys = _keys(ob)
    keys.use_relative = False
    for frame, time in ((1, 0.0), (LAST_FRAME, 20.0)):
        keys.eval_time = time
        keys.keyframe_insert("eval_time", frame=frame)


def _points_keyed(ob: bpy.types.Object) -> None:
    keys = _keys(ob)
    keys.key_blocks["Wide"].value = 1.0
    for frame, x in ((1, 0.5), (LAST_FRAME, 1.5)):
        keys.key_blocks["Wide"].data[30].co.x = x
        keys.keyframe_insert('key_blocks["Wide"].data[30].co', frame=frame)


def _rewritten_by_a_driver(ob: bpy.types.Object) -> None:
    """As add-ons compute skinning of their own: a function given to drivers writes the points of a key."""
    keys = _keys(ob)
    base, name = mesh_positions(ob.data), ob.name

    def rewrite(frame: float) -> float:
        points = base.copy()
        points[:, :2] *= 1.0 + 0.02 * frame
        owner = bpy.data.objects.get(name)
        if owner is not None:
            owner.data.shape_keys.key_blocks["Wide"].points.foreach_set("co", points.ravel())
        return 1.0

    bpy.app.driver_namespace["test_rewrite"] = rewrite
    driver = keys.driver_add('key_blocks["Wide"].value').driver
    driver.type, driver.expression = "SCRIPTED", "test_rewrite(frame)"


def _driven(ob: bpy.types.Object) -> None:
    driver = _keys(ob).driver_add('key_blocks["Wide"].value').driver
    driver.type, driver.expression = "SCRIPTED", "frame / 20 if frame < 15 else 0.3"


@pytest.mark.parametrize(
    ("setup", "is_evaluated"),
    [(_absolute, True), (_points_keyed, True), (_rewritten_by_a_driver, True), (_driven, False)],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_shape_keys(runtime, setup, is_evaluated):
    ob, _ = character()
    setup(ob)
    bpy.context.scene.frame_set(1)
    body = body_copy(ob, ob.modifiers["Armature"])
    add_turgor(ob)
    _check(runtime, ob, body, is_evaluated=is_evaluated)


def test_shape_keys_that_a_handler_rewrites(runtime):
    ob, _ = character()
    keys = _keys(ob)
    keys.key_blocks["Wide"].value = 1.0
    base = mesh_positions(ob.data)

    def rewrite(scene, *_):
        points = base.copy()
        points[:, :2] *= 1.0 + 0.03 * scene.frame_current
        keys.key_blocks["Wide"].points.foreach_set("co", points.ravel())
        ob.data.update_tag()
        ob.update_tag()

    bpy.app.handlers.frame_change_pre.append(rewrite)
    try:
        body = body_copy(ob, ob.modifiers["Armature"])
        add_turgor(ob)
        _check(runtime, ob, body)
    finally:
        bpy.app.handlers.frame_change_pre.remove(rewrite)


def _weights_of_a_posed_body(ob: bpy.types.Object) -> None:
    other = ob.copy()
    other.data = ob.data.copy()
    bpy.context.scene.collection.objects.link(other)
    names = [group.name for group in ob.vertex_groups]
    ob.vertex_groups.clear()
    for name in names:
        ob.vertex_groups.new(name=name)
    transfer = new(ob, "DATA_TRANSFER", object=other, use_vert_data=True)
    transfer.data_types_verts, transfer.vert_mapping = {"VGROUP_WEIGHTS"}, "POLYINTERP_NEAREST"


def _weights_by_distance(ob: bpy.types.Object) -> None:
    new(ob, "VERTEX_WEIGHT_PROXIMITY", target=moving_empty(), vertex_group="Bone1", max_dist=3.0)


def _mirrored_about_what_moves(ob: bpy.types.Object) -> None:
    mirror = new(ob, "MIRROR", mirror_object=moving_empty(), use_mirror_merge=False)
    mirror.use_axis = (False, True, False)


def _value_keyed_in_a_tree(ob: bpy.types.Object) -> None:
    tree = pushed_out(ob).node_group
    link = next(link for link in tree.links if link.to_socket.name == "Scale")
    node, socket = link.to_node, link.to_socket
    tree.links.remove(link)
    for frame, value in ((1, 0.0), (LAST_FRAME, 0.3)):
        socket.default_value = value
        index = list(node.inputs).index(socket)
        tree.keyframe_insert(f'nodes["{node.name}"].inputs[{index}].default_value', frame=frame)


def _animated_texture(ob: bpy.types.Object) -> None:
    texture = bpy.data.textures.new("Clouds", "CLOUDS")
    new(ob, "DISPLACE", texture=texture, strength=0.2)
    for frame, scale in ((1, 0.3), (LAST_FRAME, 1.5)):
        texture.noise_scale = scale
        texture.keyframe_insert("noise_scale", frame=frame)


MOVING = [
    _weights_of_a_posed_body,
    _weights_by_distance,
    _mirrored_about_what_moves,
    _value_keyed_in_a_tree,
    _animated_texture,
]


@pytest.mark.parametrize("setup", MOVING, ids=lambda setup: setup.__name__)
def test_bodies_that_move_in_ways_that_are_not_seen_in_their_modifier(route, runtime, setup):
    ob, _ = character()
    setup(ob)
    armature = ob.modifiers["Armature"]
    ob.modifiers.move(list(ob.modifiers).index(armature), len(ob.modifiers) - 1)
    body = body_copy(ob, armature)
    add_turgor(ob)
    _check(runtime, ob, body)


def _placed_by_hand(ob: bpy.types.Object) -> bpy.types.Object:
    empty = bpy.data.objects.new("Still", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.location.z = 1.0
    new(ob, "CAST", object=empty, factor=0.5)
    ob.modifiers.move(1, 0)
    return empty


def test_an_object_that_stands_still_is_followed_when_the_artist_moves_it(route, runtime):
    ob, _ = character()
    empty = _placed_by_hand(ob)
    body = body_copy(ob, ob.modifiers["Armature"])
    add_turgor(ob)
    _check(runtime, ob, body, is_evaluated=False)
    empty.location.x = 0.8
    bpy.context.view_layer.update()
    _check(runtime, ob, body, is_evaluated=False)
    keyed(empty, "location", (0.0, 0.0, 1.0), (0.5, 0.0, 3.0))
    ob.update_tag()
    bpy.context.view_layer.update()
    _check(runtime, ob, body)


CHANGING = {
    "masked": lambda ob: keyed(ob, 'modifiers["Mask"].threshold', 0.1, 0.9),
    "array": lambda ob: keyed(ob, 'modifiers["Array"].count', 1, 3),
}


@pytest.mark.parametrize("kind", CHANGING)
def test_another_number_of_vertices_on_a_frame_is_told_by_name(route, runtime, kind):
    ob, _ = character()
    rest = volume(ob)
    if kind == "masked":
        _half(ob, "Shown")
        new(ob, "MASK", vertex_group="Shown", invert_vertex_group=True)
    else:
        new(ob, "ARRAY", count=1, relative_offset_displace=(3.0, 0.0, 0.0))
    ob.modifiers.move(1, 0)
    CHANGING[kind](ob)
    bpy.context.scene.frame_set(1)
    add_turgor(ob)
    assert runtime.character(ob.session_uid).problem is None
    bpy.context.scene.frame_set(LAST_FRAME)
    found = _finding(runtime, ob, "other_topology")
    assert found is not None
    assert ob.modifiers[0].name in found.text
    assert found.fix == "MOVE_AFTER"
    shown = positions(ob)
    set_strength(ob, 0.0)
    bpy.context.view_layer.update()
    assert (positions(ob) == shown).all()
    set_strength(ob, 1.0)
    select([ob])
    bpy.ops.object.turgor_volume_fix(fix=found.fix, subject=found.subject)
    bpy.context.scene.frame_set(2)
    assert runtime.character(ob.session_uid).problem is None
    assert rest > 0.0


def test_a_turgor_spine_amid_others(runtime):
    """Its own Armature, the spine, then what it cannot follow: ours corrects all of it."""
    ob, rig = character()
    select([ob])
    saved = ob.turgor_spine
    saved.source, saved.rig, saved.first_bone, saved.last_bone = "BONES", rig, "Bone0", "Bone2"
    housekeeping = importlib.import_module("addon.live.spine_housekeeping")
    housekeeping.add(ob)
    new(ob, "CORRECTIVE_SMOOTH", iterations=3)
    body = body_copy(ob, ob.modifiers["Armature"])
    add_turgor(ob)
    ob.modifiers.move(list(ob.modifiers).index(volume_modifier(ob)), len(ob.modifiers) - 1)
    bpy.context.view_layer.update()
    _check(runtime, ob, body)
    assert runtime.spine(ob.session_uid).problem is None


def test_renders_are_exact_where_a_deformer_is_on_in_renders_only(tmp_path):
    ob, _ = character()
    rest = volume(ob)
    new(ob, "CORRECTIVE_SMOOTH", iterations=8).show_viewport = False
    new(ob, "SMOOTH", iterations=2).show_render = False
    add_turgor(ob)
    ob.modifiers.move(list(ob.modifiers).index(volume_modifier(ob)), len(ob.modifiers) - 1)
    bpy.context.view_layer.update()
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera, scene.render.engine, scene.cycles.samples = camera, "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.render.filepath = str(tmp_path / "frame")
    scene.frame_start, scene.frame_end = 12, 13
    seen: list[tuple[float, np.ndarray]] = []

    def look(scene, depsgraph):
        if depsgraph.mode == "RENDER":
            mesh = evaluated_mesh(ob, depsgraph)
            seen.append((abs(mesh_volume(mesh) / rest - 1.0), mesh_positions(mesh)))

    bpy.app.handlers.frame_change_post.append(look)
    try:
        bpy.ops.render.render(animation=True)
    finally:
        bpy.app.handlers.frame_change_post.remove(look)
    assert len(seen) == 2
    assert max(error for error, _ in seen) < VOLUME_TOLERANCE
    scene.frame_set(13)
    assert np.abs(positions(ob) - seen[1][1]).max() > 1e-3
    assert abs(volume(ob) / rest - 1.0) < VOLUME_TOLERANCE
