"""Turgor's automatic weights in Blender: beside Blender's own where those work, and where they do not."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
import pytest
from mathutils import Matrix

LENGTH, BONES = 4.0, 4


def tube(name: str = "Tube", rings: int = 25, sides: int = 12, radius: float = 0.5) -> bpy.types.Object:
    x, angle = np.meshgrid(np.linspace(0.0, LENGTH, rings), np.arange(sides) * 2 * np.pi / sides, indexing="ij")
    points = np.stack([x, radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 3)
    faces = [
        [i * sides + j, i * sides + (j + 1) % sides, (i + 1) * sides + (j + 1) % sides, (i + 1) * sides + j]
        for i in range(rings - 1)
        for j in range(sides)
    ]
    last = (rings - 1) * sides
    faces += [list(range(sides))[::-1], list(range(last, last + sides))]
    return linked(name, points.tolist(), faces)


def linked(name: str, points: list, faces: list) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(ob)
    return ob


def armature(joints: dict[str, tuple] | None = None) -> bpy.types.Object:
    """A chain along x, or bones by name and ends; the last bone of the chain does not deform."""
    ends = joints or {f"Bone{i}": ((LENGTH * i / BONES, 0, 0), (LENGTH * (i + 1) / BONES, 0, 0)) for i in range(BONES)}
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (head, tail) in {**ends, "Control": ((0, 0, 3), (0, 0, 4))}.items():
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        bone.use_deform = name != "Control"
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def select(*objects: bpy.types.Object) -> None:
    """The last one is active."""
    bpy.ops.object.select_all(action="DESELECT")
    for ob in objects:
        ob.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]
    bpy.context.view_layer.update()


def parent(*objects: bpy.types.Object, **settings) -> None:
    select(*objects)
    assert bpy.ops.object.turgor_weights_parent(**settings) == {"FINISHED"}


def weights_of(ob: bpy.types.Object) -> np.ndarray:
    """(N, groups)"""
    found = np.zeros((len(ob.data.vertices), len(ob.vertex_groups)))
    for vertex in ob.data.vertices:
        for element in vertex.groups:
            found[vertex.index, element.group] = element.weight
    return found


def structure_of(ob: bpy.types.Object) -> list:
    return [
        [group.name for group in ob.vertex_groups],
        [(m.type, m.object.name, m.use_vertex_groups, m.use_bone_envelopes, m.show_viewport) for m in ob.modifiers],
        (ob.parent.name, ob.parent_type, ob.matrix_world.copy(), ob.matrix_parent_inverse.copy()),
    ]


def test_leaves_what_automatic_weights_of_blender_leave():
    first, second, rig = tube(), tube(), armature()
    first.location = second.location = (0.0, 0.1, 0.0)
    parent(first, rig)
    select(second, rig)
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    assert structure_of(first) == structure_of(second)
    ours, theirs = weights_of(first), weights_of(second)
    np.testing.assert_allclose(ours.sum(axis=1), 1.0, atol=1e-6)
    x = np.array([vertex.co.x for vertex in first.data.vertices])
    near_middle = np.abs(x % 1.0 - 0.5) < 0.2
    assert (ours.argmax(axis=1) == theirs.argmax(axis=1))[near_middle].all()


def test_mesh_that_blender_fails_on_is_weighted():
    """Thirteen cubes that float about the bones: Blender's automatic weights leave vertices without any."""
    points, faces = [], []
    cube = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    for i in range(13):
        place = np.array([0.3 * i, 0.4 * np.sin(i), 0.4 * np.cos(i)])
        faces += [[corner + len(points) for corner in side] for side in sides]
        points += [(place + 0.15 * np.array(corner)).tolist() for corner in cube]
    ob, rig = linked("Cubes", points, faces), armature()
    parent(ob, rig)
    np.testing.assert_allclose(weights_of(ob).sum(axis=1), 1.0, atol=1e-6)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (3.0, 0.5, 1.0), (-1.0, 1.0, 1.0), (1e-3, 1e-3, 1e-3)])
def test_transforms_of_objects_do_not_matter(scale: tuple):
    plain, rig = tube(), armature()
    parent(plain, rig)
    other = tube()
    inverse = np.array([1.0 / s for s in scale])
    for vertex in other.data.vertices:
        vertex.co = np.array(vertex.co) * inverse
    other.scale = scale
    parent(other, rig)
    np.testing.assert_allclose(weights_of(other), weights_of(plain), atol=1e-4)


def test_everything_else_of_the_mesh_stays():
    ob, rig = tube(), armature()
    mesh = ob.data
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Fat", from_mix=False)
    for point in key.data:
        point.co *= 1.5
    key.value = 0.7
    layer = mesh.uv_layers.new(name="Map")
    rng = np.random.default_rng(1)
    layer.uv.foreach_set("vector", rng.random(2 * len(mesh.loops)).astype(np.float32))
    mesh.attributes.new("Mine", "FLOAT", "POINT").data.foreach_set("value", rng.random(len(mesh.vertices)))
    mesh.normals_split_custom_set([(0.0, 0.6, 0.8)] * len(mesh.loops))
    other = ob.vertex_groups.new(name="Other")
    other.add([3, 4], 0.25, "REPLACE")

    def snapshot() -> list[list[float]]:
        keys = [[c for point in k.data for c in point.co] for k in mesh.shape_keys.key_blocks]
        uvs = [c for uv in mesh.uv_layers["Map"].uv for c in uv.vector]
        mine = [value.value for value in mesh.attributes["Mine"].data]
        normals = [round(c, 5) for normal in mesh.corner_normals for c in normal.vector]
        return [*keys, [k.value for k in mesh.shape_keys.key_blocks], uvs, mine, normals]

    before = snapshot()
    parent(ob, rig)
    assert snapshot() == before
    assert [ob.vertex_groups["Other"].weight(i) for i in (3, 4)] == [0.25, 0.25]
    plain = tube()
    parent(plain, rig)
    np.testing.assert_allclose(weights_of(ob)[:, 1:], weights_of(plain), atol=1e-6)


def test_locked_groups_keep_their_weights():
    ob, rig = tube(), armature()
    group = ob.vertex_groups.new(name="Bone1")
    group.add(range(100), 0.4, "REPLACE")
    group.lock_weight = True
    parent(ob, rig)
    weights = weights_of(ob)
    assert np.allclose(weights[:100, group.index], 0.4)
    assert (weights[100:, group.index] == 0.0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-6)
    parent(ob, rig, keep_locked=False)
    assert weights_of(ob)[100:, group.index].max() > 0.5


def test_both_sides_are_alike_with_symmetry():
    ob = tube()
    for vertex in ob.data.vertices:
        vertex.co.x -= LENGTH / 2
    rig = armature({"Hand.L": ((0, 0, 0), (2, 0, 0.1)), "Hand.R": ((0, 0, 0), (-2, 0, 0))})
    parent(ob, rig, use_symmetry=True)
    weights = weights_of(ob)
    points = np.array([vertex.co for vertex in ob.data.vertices])
    image = np.linalg.norm(points[:, None] * [-1, 1, 1] - points[None], axis=2).argmin(axis=1)
    assert np.array_equal(weights, weights[image][:, [1, 0]])


def test_several_meshes_are_one_body_and_shared_ones_are_weighted_once():
    body, shirt, rig = tube(), tube("Shirt", radius=0.55), armature()
    twin = bpy.data.objects.new("Twin", body.data)
    bpy.context.collection.objects.link(twin)
    parent(body, shirt, twin, rig)
    for ob in (body, shirt, twin):
        np.testing.assert_allclose(weights_of(ob).sum(axis=1), 1.0, atol=1e-6)
        assert ob.parent == rig
    assert np.abs(weights_of(body) - weights_of(shirt)).max() < 0.1


def test_half_a_body_with_a_mirror_modifier_is_weighted_as_the_whole():
    rig = armature({"Hand.L": ((0.2, 0, 0), (2, 0, 0)), "Hand.R": ((-0.2, 0, 0), (-2, 0, 0))})
    half = tube()
    for vertex in half.data.vertices:
        vertex.co.x /= 2.0
    edited = bmesh.new()
    edited.from_mesh(half.data)
    bmesh.ops.delete(
        edited,
        geom=[f for f in edited.faces if len(f.verts) > 4 and f.calc_center_median().x < 0.1],
        context="FACES_ONLY",
    )
    edited.to_mesh(half.data)
    edited.free()
    half.modifiers.new("Mirror", "MIRROR")
    parent(half, rig)
    weights = weights_of(half)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-6)
    x = np.array([vertex.co.x for vertex in half.data.vertices])
    np.testing.assert_allclose(weights[x == 0.0], 0.5, atol=0.02)


def paint(ob: bpy.types.Object, rig: bpy.types.Object, *names: str) -> None:
    """Weight Paint on the mesh, with these bones selected."""
    for pose_bone in rig.pose.bones:
        holder = pose_bone if hasattr(pose_bone, "select") else pose_bone.bone
        holder.select = pose_bone.name in names
    select(rig, ob)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")


def test_selected_bones_on_selected_vertices_change_nothing_else():
    ob, rig = tube(), armature()
    parent(ob, rig)
    for name, weight in (("Bone0", 0.25), ("Bone1", 0.75)):
        ob.vertex_groups[name].add(range(len(ob.data.vertices)), weight, "REPLACE")
    for name in ("Bone2", "Bone3"):
        ob.vertex_groups[name].remove(range(len(ob.data.vertices)))
    before = weights_of(ob)
    is_selected = np.arange(len(before)) % 2 == 0
    ob.data.vertices.foreach_set("select", is_selected)
    ob.data.use_paint_mask_vertex = True
    paint(ob, rig, "Bone2")
    assert bpy.ops.paint.turgor_weights() == {"FINISHED"}
    after = weights_of(ob)
    assert np.array_equal(after[~is_selected], before[~is_selected])
    np.testing.assert_allclose(after.sum(axis=1), 1.0, atol=1e-6)
    assert (after[is_selected, 3] == 0.0).all()
    np.testing.assert_allclose(after[:, 0] * 3.0, after[:, 1], atol=1e-6)
    assert after[is_selected, 2].max() > 0.5


def test_no_selected_bone_means_all():
    ob, rig = tube(), armature()
    parent(ob, rig)
    before = weights_of(ob)
    ob.vertex_groups["Bone1"].remove(range(len(before)))
    paint(ob, rig)
    assert bpy.ops.paint.turgor_weights() == {"FINISHED"}
    np.testing.assert_allclose(weights_of(ob), before, atol=1e-6)


def test_what_cannot_be_weighted_says_why():
    ob, rig = tube(), armature()
    for bone in rig.data.bones:
        bone.use_deform = False
    select(ob, rig)
    with pytest.raises(RuntimeError, match="Rig has no deform bone: turn Deform on"):
        bpy.ops.object.turgor_weights_parent()
    for bone in rig.data.bones:
        bone.use_deform = True
        group = ob.vertex_groups.new(name=bone.name)
        group.lock_weight = True
    with pytest.raises(RuntimeError, match="All chosen bones are locked"):
        bpy.ops.object.turgor_weights_parent()
    assert ob.parent is None
    select(ob)
    assert not bpy.ops.object.turgor_weights_parent.poll()
    assert not bpy.ops.paint.turgor_weights.poll()


def test_menus_offer_both():
    for menu, function in (("VIEW3D_MT_object_parent", "draw_parent"), ("VIEW3D_MT_paint_weight", "draw_paint")):
        drawn = getattr(bpy.types, menu).draw._draw_funcs
        assert any(draw.__name__ == function for draw in drawn)


def test_stiff_bones_hold_more_and_plain_ones_as_ever():
    ob, rig = tube(), armature()
    parent(ob, rig)
    plain = weights_of(ob)
    rig.data.bones["Bone1"].turgor_stiffness = 1.5
    parent(ob, rig)
    stiff = weights_of(ob)
    assert stiff[:, 1].sum() > 1.2 * plain[:, 1].sum()
    for bone in rig.data.bones:
        bone.turgor_stiffness = 1.5
    parent(ob, rig)
    np.testing.assert_allclose(weights_of(ob), plain, atol=1e-6)


def test_stiffness_is_saved_edited_and_mirrored_with_its_bone(tmp_path):
    rig = armature({"Hand.L": ((0.2, 0, 0), (2, 0, 0)), "Spine": ((0, 0, 0), (0, 0, 1))})
    rig.data.bones["Hand.L"].turgor_stiffness = 2.0
    select(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    edited = rig.data.edit_bones
    assert edited["Hand.L"].turgor_stiffness == 2.0
    edited["Spine"].turgor_stiffness = 0.5
    for bone in edited:
        bone.select = bone.select_head = bone.select_tail = True
    assert bpy.ops.armature.symmetrize() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    path = str(tmp_path / "rig.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bones = bpy.data.armatures["Rig"].bones
    found = {bone.name: bone.turgor_stiffness for bone in bones}
    assert found == {"Hand.L": 2.0, "Hand.R": 2.0, "Spine": 0.5, "Control": 1.0}


def arm_in_trunk() -> bpy.types.Object:
    """A trunk along x, and an arm along y that is another shell stuck into it, in one mesh."""
    trunk, arm = tube("Trunk", radius=0.8), tube("Arm", radius=0.3)
    arm.data.transform(Matrix.Translation((3.0, 0.3, 0.0)) @ Matrix.Rotation(np.pi / 2, 4, "Z"))
    select(arm, trunk)
    bpy.ops.object.join()
    return trunk


def test_hierarchy_joins_shells_through_bones_that_do_not_deform():
    """As in control rigs: the upper arm hangs on a bone that does not deform, in the place of the shoulder's."""
    ends = {
        "Spine": ((0.0, 0.0, 0.0), (4.0, 0.0, 0.0)),
        "Shoulder": ((3.0, 0.0, 0.0), (3.0, 0.45, 0.0)),
        "Guide": ((3.0, 0.0, 0.0), (3.0, 0.45, 0.0)),
        "Arm": ((3.0, 0.65, 0.0), (3.0, 4.2, 0.0)),
    }
    held = []
    for parents in ({}, {"Shoulder": "Spine", "Guide": "Spine", "Arm": "Guide"}):
        body, rig = arm_in_trunk(), armature(ends)
        bpy.ops.object.mode_set(mode="EDIT")
        bones = rig.data.edit_bones
        for child, above in parents.items():
            bones[child].parent = bones[above]
        bones["Guide"].use_deform = False
        bpy.ops.object.mode_set(mode="OBJECT")
        parent(body, rig)
        trunk = np.arange(len(body.data.vertices)) < 25 * 12
        held.append(weights_of(body)[trunk, body.vertex_groups["Arm"].index].max())
    assert held[0] == 0.0
    assert held[1] > 0.5
