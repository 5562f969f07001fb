"""Edits of many joints: mirrored, copied, edited together, undone; bones and joints choose each other."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import positions
from tube import LENGTH, add_turgor, character, tube_mesh

SIDES = ("Arm.L", "Arm.R", "Odd \"name\\' {0} %.L")
PLAIN = ("strength", "size", "preset", "use_auto_shares", "blend_mode", "blend", "fold_loss")
CURVES = ("curve_along", "curve_sideways", "curve_inside")


@pytest.fixture
def sided():
    """Joints with sides, one of whose other sides is missing."""
    ob, rig = character()
    for bone, name in zip(rig.data.bones, SIDES, strict=True):
        bone.name = name
    add_turgor(ob)
    return ob


def _run(name, ob, **options):
    with bpy.context.temp_override(object=ob):
        return getattr(bpy.ops.object, name)(**options)


def _choose(ob, active, *selected):
    ob.turgor.active_joint = ob.turgor.joints.find(active)
    for joint in ob.turgor.joints:
        joint.select = joint.name in selected


def _edit(joint):
    """Every setting is another than a new joint's."""
    joint.preset = "CUSTOM"
    joint.strength, joint.size = 0.3, 1.7
    joint.use_auto_shares, joint.shares = False, (0.5, 0.2, 0.3)
    joint.second.preset = "FOLDS"
    joint.blend_mode, joint.blend, joint.fold_loss = "VALUE", 0.4, 0.6
    tree = joint.id_data.turgor.curves
    for name in CURVES:
        mapping = tree.nodes[getattr(joint, name)].mapping
        mapping.curves[0].points[1].location = (0.3, 0.77)
        mapping.curves[0].points[1].handle_type = "VECTOR"
        mapping.update()
    joint.id_data.update_tag()
    bpy.context.view_layer.update()


def _settings(joint):
    tree = joint.id_data.turgor.curves
    found = [getattr(joint, name) for name in PLAIN] + [tuple(joint.shares), joint.second.preset]
    for name in CURVES:
        node = None if tree is None else tree.nodes.get(getattr(joint, name))
        points = [] if node is None else node.mapping.curves[0].points
        found.append([(tuple(point.location), point.handle_type) for point in points])
    return found


def _update():
    bpy.context.view_layer.update()


def test_mirror_gives_the_other_side_settings_and_curves(sided):
    left, right = (sided.turgor.joints[name] for name in SIDES[:2])
    _update()
    left.preset = "CUSTOM"
    _update()
    _edit(left)
    _choose(sided, left.name)
    assert _run("turgor_joints_mirror", sided) == {"FINISHED"}
    assert _settings(right) == _settings(left)
    assert getattr(right, CURVES[0]) != getattr(left, CURVES[0])
    left.strength = 0.9
    assert right.strength == pytest.approx(0.3)


def test_mirror_of_both_sides_keeps_the_active_one(sided):
    left, right = (sided.turgor.joints[name] for name in SIDES[:2])
    left.strength, right.strength = 0.2, 0.8
    _choose(sided, right.name, left.name, right.name)
    _run("turgor_joints_mirror", sided)
    assert left.strength == right.strength == pytest.approx(0.8)


def test_mirror_tells_what_has_no_other_side(sided):
    _choose(sided, SIDES[2])
    assert _run("turgor_joints_mirror", sided) == {"CANCELLED"}


def test_mirrored_characters_are_mirrored(route):
    """A symmetric body in a symmetric pose stays symmetric when a shape is mirrored: no axis has to be turned."""
    ob = _symmetric()
    add_turgor(ob)
    left = ob.turgor.joints["Arm.L"]
    left.preset, left.use_auto_shares, left.shares, left.size = "MUSCLE", False, (0.2, 0.3, 0.5), 1.3
    _choose(ob, "Arm.L")
    _run("turgor_joints_mirror", ob)
    _update()
    found = positions(ob)
    flipped = found * (-1, 1, 1)
    distances = np.linalg.norm(found[:, None] - flipped[None], axis=2).min(axis=1)
    assert distances.max() < 1e-4
    assert len({tuple(np.round(point, 3)) for point in found}) == len(found)


def _symmetric():
    """A tube along X with an arm to both sides of a trunk, both bent upwards and forwards."""
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    trunk = data.edit_bones.new("Trunk")
    trunk.head, trunk.tail = (0, 0, 0), (0, 0, 0.5)
    for name, side in (("Arm.L", 1), ("Arm.R", -1)):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (side * 0.5, 0, 0), (side * LENGTH / 2, 0, 0)
        bone.parent = trunk
        bone.align_roll((0, 0, 1))
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, side in (("Arm.L", 1), ("Arm.R", -1)):
        rig.pose.bones[name].rotation_mode = "XYZ"
        rig.pose.bones[name].rotation_euler = (0.7, 0.2 * side, 0.5 * side)
    mesh = tube_mesh("Body", rings=41)
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", points.ravel())
    points = np.stack([points[:, 2] - LENGTH / 2, points[:, 1], -points[:, 0]], axis=1)
    mesh.attributes["position"].data.foreach_set("vector", np.ascontiguousarray(points).ravel())
    mesh.update()
    ob = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(ob)
    groups = {name: ob.vertex_groups.new(name=name) for name in ("Trunk", "Arm.L", "Arm.R")}
    for index, x in enumerate(points[:, 0]):
        arm = float(np.clip((abs(x) - 0.3) / 0.4, 0.0, 1.0))
        groups["Trunk"].add([index], 1.0 - arm, "REPLACE")
        groups["Arm.L" if x > 0 else "Arm.R"].add([index], arm, "REPLACE")
    ob.modifiers.new("Armature", "ARMATURE").object = rig
    return ob


def test_copy_to_selected(sided):
    source = sided.turgor.joints[SIDES[0]]
    source.preset = "CUSTOM"
    _update()
    _edit(source)
    _choose(sided, source.name)
    assert _run("turgor_joints_copy", sided) == {"CANCELLED"}
    _choose(sided, source.name, SIDES[2])
    assert _run("turgor_joints_copy", sided) == {"FINISHED"}
    assert _settings(sided.turgor.joints[SIDES[2]]) == _settings(source)
    assert sided.turgor.joints[SIDES[1]].strength == 1.0


def test_reset_makes_new_joints(sided):
    fresh = _settings(sided.turgor.joints[SIDES[1]])[:-3]
    joint = sided.turgor.joints[SIDES[0]]
    joint.preset = "CUSTOM"
    _update()
    _edit(joint)
    joint.mute = joint.is_solo = True
    _choose(sided, joint.name)
    _run("turgor_joints_reset", sided)
    found = _settings(joint)[:-3]
    assert [found[index] for index in range(len(PLAIN))] == [fresh[index] for index in range(len(PLAIN))]
    assert found[-1] == "ISOTROPIC"
    assert not joint.mute
    assert not joint.is_solo


@pytest.mark.parametrize(("action", "expected"), [("ALL", [1, 1, 1]), ("NONE", [0, 0, 0]), ("INVERT", [1, 0, 1])])
def test_select(sided, action, expected):
    _choose(sided, SIDES[0], SIDES[1])
    _run("turgor_joints_select", sided, action=action)
    assert [joint.select for joint in sided.turgor.joints] == expected


def test_several_edits_all_selected_and_one_edits_one(sided):
    joints = sided.turgor.joints
    several = sided.turgor.several
    _choose(sided, SIDES[0], SIDES[2])
    several.strength = 0.25
    several.preset = "MUSCLE"
    several.shares = (0.1, 0.2, 0.7)
    several.use_auto_shares = False
    several.blend_mode = "VALUE"
    for name in (SIDES[0], SIDES[2]):
        assert joints[name].strength == 0.25
        assert joints[name].preset == "MUSCLE"
        assert joints[name].blend_mode == "VALUE"
        assert tuple(joints[name].shares) == pytest.approx((0.1, 0.2, 0.7))
    assert joints[SIDES[1]].strength == 1.0
    assert joints[SIDES[1]].preset == "FLESH"
    joints[SIDES[0]].strength = 0.5
    assert joints[SIDES[2]].strength == 0.25
    assert several.strength == 0.5
    assert several.preset == "MUSCLE"
    assert tuple(several.shares) == pytest.approx((0.1, 0.2, 0.7))


def test_several_is_seen_and_has_no_keys(sided, route):
    bpy.context.scene.frame_set(15)
    before = positions(sided)
    _choose(sided, SIDES[0], *SIDES)
    sided.turgor.several.strength = 0.0
    _update()
    assert (positions(sided) != before).any()
    with pytest.raises(TypeError):
        sided.turgor.several.keyframe_insert("strength")
    assert sided.turgor.joints[SIDES[0]].keyframe_insert("strength")


def test_several_has_the_look_of_one(sided):
    one, several = sided.turgor.joints[0].bl_rna.properties, sided.turgor.several.bl_rna.properties
    names = importlib.import_module("addon.properties.selected_joints").NAMES
    for name in names:
        for look in ("name", "description", "type", "subtype"):
            assert getattr(one[name], look) == getattr(several[name], look)


def test_ten_edits_are_undone_and_redone(sided):
    name = sided.name
    steps = [
        lambda ob: _choose(ob, SIDES[0], SIDES[1]),
        lambda ob: setattr(ob.turgor.several, "strength", 0.4),
        lambda ob: setattr(ob.turgor.several, "preset", "FOLDS"),
        lambda ob: setattr(ob.turgor.joints[0], "size", 1.5),
        lambda ob: _run("turgor_joints_mirror", ob),
        lambda ob: _run("turgor_joints_select", ob, action="ALL"),
        lambda ob: _run("turgor_joints_copy", ob),
        lambda ob: setattr(ob.turgor.several, "fold_loss", 0.7),
        lambda ob: setattr(ob.turgor.joints[1], "mute", True),
        lambda ob: _run("turgor_joints_reset", ob),
    ]
    states = [[_settings(joint) for joint in sided.turgor.joints]]
    bpy.ops.ed.undo_push(message="start")
    for step in steps:
        step(bpy.data.objects[name])
        states.append([_settings(joint) for joint in bpy.data.objects[name].turgor.joints])
        bpy.ops.ed.undo_push(message="edit")
    for expected in reversed(states[:-1]):
        bpy.ops.ed.undo()
        assert [_settings(joint) for joint in bpy.data.objects[name].turgor.joints] == expected
    for expected in states[1:]:
        bpy.ops.ed.redo()
        assert [_settings(joint) for joint in bpy.data.objects[name].turgor.joints] == expected


def test_bones_and_joints_choose_each_other(sided):
    rig = bpy.data.objects["Rig"]
    _choose(sided, SIDES[2])
    assert _run("turgor_joint_to_bone", sided) == {"FINISHED"}
    assert bpy.context.mode == "POSE"
    assert bpy.context.object == rig
    assert [bone.name for bone in bpy.context.selected_pose_bones] == [SIDES[2]]
    assert rig.data.bones.active.name == SIDES[2]
    rig.data.bones.active = rig.data.bones[SIDES[1]]
    assert _run("turgor_joint_from_bone", sided) == {"FINISHED"}
    assert sided.turgor.joints[sided.turgor.active_joint].name == SIDES[1]


def test_the_active_bone_leads(sided, route):
    """Clicking a bone shows its joint; choosing another joint in the list is not undone by a later update."""
    rig = bpy.data.objects["Rig"]
    _update()
    for name in SIDES:
        rig.data.bones.active = rig.data.bones[name]
        rig.data.update_tag()
        _update()
        assert sided.turgor.joints[sided.turgor.active_joint].name == name
    sided.turgor.active_joint = 0
    rig.pose.bones[1].rotation_euler.x = 0.2
    _update()
    assert sided.turgor.active_joint == 0


def test_a_hidden_armature_is_told(sided):
    bpy.data.objects["Rig"].hide_viewport = True
    with pytest.raises(RuntimeError, match="hidden"):
        _run("turgor_joint_to_bone", sided)
    assert bpy.context.mode == "OBJECT"


def test_objects_without_turgor_have_nothing_to_edit():
    ob, _ = character()
    for name in ("turgor_joints_copy", "turgor_joints_mirror", "turgor_joints_reset", "turgor_joint_to_bone"):
        with bpy.context.temp_override(object=ob):
            assert not getattr(bpy.ops.object, name).poll()
