"""Some bones skin the body, a chain fleshes it: the weights say who moves what."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from body import RINGS, add_spine
from measure import positions, volume
from test_exact import VOLUME_TOLERANCE
from tube import LAST_FRAME, place, rig, select, tube_mesh

BONES = 6


@pytest.fixture(params=[False, True], ids=["linear", "dual quaternions"])
def limb(request):
    armature = rig(bone_count=BONES)
    ob = place("Tube", tube_mesh(rings=RINGS), armature)
    ob.modifiers["Armature"].use_deform_preserve_volume = request.param
    for bone in armature.pose.bones:
        for frame, angle in ((1, 0.0), (LAST_FRAME, 0.2)):
            bone.rotation_euler = (angle, 0.5 * angle, 0.3 * angle)
            bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_set(LAST_FRAME)
    skinned = positions(ob)
    select([armature, ob])
    assert bpy.ops.object.turgor_spine_add() == {"FINISHED"}
    saved = ob.turgor_spine
    saved.first_bone, saved.last_bone = "Bone3", "Bone5"
    bpy.context.view_layer.update()
    return ob, armature, skinned


def test_stands_after_the_armature(limb, runtime):
    ob, _, _ = limb
    assert [modifier.type for modifier in ob.modifiers] == ["ARMATURE", "NODES"]
    assert runtime.spine(ob.session_uid).problem is None


def test_skin_of_other_bones_stays(limb):
    ob, _, skinned = limb
    held = np.zeros(len(skinned))
    for vertex in ob.data.vertices:
        held[vertex.index] = sum(g.weight for g in vertex.groups if ob.vertex_groups[g.group].name >= "Bone3")
    now = positions(ob)
    assert (now[held == 0.0] == skinned[held == 0.0]).all()
    assert np.abs(now[held > 0.9] - skinned[held > 0.9]).max() > 1e-3
    # No tear between them: neighbouring rings stay neighbours.
    rings = now.reshape(RINGS, -1, 3)
    assert np.linalg.norm(np.diff(rings, axis=0), axis=2).max() <= 0.25


def test_flesh_of_the_chain_follows_it(limb):
    """Vertices that the chain alone holds lie where a body without weights would."""
    ob, armature, _ = limb
    held = np.array(
        [all(ob.vertex_groups[g.group].name >= "Bone3" for g in vertex.groups) for vertex in ob.data.vertices]
    )
    other = bpy.data.objects.new("Other", ob.data.copy())
    bpy.context.scene.collection.objects.link(other)
    bpy.context.scene.frame_set(1)
    saved = add_spine(other, armature)
    saved.first_bone, saved.last_bone, saved.keep_volume = "Bone3", "Bone5", False
    bpy.context.scene.frame_set(LAST_FRAME)
    assert np.abs(positions(ob)[held] - positions(other)[held]).max() <= 1e-5


def test_shape_keys_turn_with_the_flesh(limb):
    """A bump of the chain's flesh is where a body without weights has it."""
    ob, armature, _ = limb
    ob.shape_key_add(name="Basis")
    key = ob.shape_key_add(name="Bump")
    for point, vertex in zip(key.data, ob.data.vertices, strict=True):
        point.co = (vertex.co.x * 1.3, vertex.co.y * 1.3, vertex.co.z)
    key.value = 1.0
    held = np.array(
        [all(ob.vertex_groups[g.group].name >= "Bone3" for g in vertex.groups) for vertex in ob.data.vertices]
    )
    other = bpy.data.objects.new("Other", ob.data)
    bpy.context.scene.collection.objects.link(other)
    bpy.context.scene.frame_set(1)
    saved = add_spine(other, armature)
    saved.first_bone, saved.last_bone, saved.keep_volume = "Bone3", "Bone5", False
    bpy.context.scene.frame_set(LAST_FRAME)
    assert np.abs(positions(ob)[held] - positions(other)[held]).max() <= 1e-5


def test_follows_the_switches_of_the_armature(limb):
    ob, _, _ = limb
    rest = np.array([vertex.co for vertex in ob.data.vertices], np.float32)
    ob.modifiers["Armature"].show_viewport = False
    bpy.context.view_layer.update()
    assert (positions(ob) == rest).all()


def test_nothing_moves_at_rest(limb):
    ob, _, _ = limb
    bpy.context.scene.frame_set(1)
    rest = np.array([vertex.co for vertex in ob.data.vertices], np.float32)
    assert np.abs(positions(ob) - rest).max() <= 1e-5


@pytest.mark.usefixtures("route")
class TestWithVolume:
    """Turgor Volume after Turgor Spine: the volume of skin and flesh together is exact."""

    @pytest.fixture
    def both(self, limb):
        ob, armature, _ = limb
        select([ob])
        assert bpy.ops.object.turgor_volume_add() == {"FINISHED"}
        return ob, armature

    def test_the_total_is_exact_on_every_frame(self, both, runtime):
        ob, _ = both
        assert [modifier.name for modifier in ob.modifiers] == ["Armature", "Turgor Spine", "Turgor Volume"]
        bpy.context.scene.frame_set(1)
        target = volume(ob)
        for frame in range(1, LAST_FRAME + 1):
            bpy.context.scene.frame_set(frame)
            assert abs(volume(ob) / target - 1.0) <= VOLUME_TOLERANCE
        assert runtime.character(ob.session_uid).problem is None

    def test_flesh_of_the_chain_is_left_alone(self, both):
        """Joints that the spine fleshes have nothing to give back: their flesh keeps its own volume."""
        ob, _ = both
        bpy.context.scene.frame_set(LAST_FRAME)
        corrected = positions(ob)
        ob.modifiers["Turgor Volume"].show_viewport = False
        bpy.context.view_layer.update()
        moved = np.linalg.norm(corrected - positions(ob), axis=1)
        # The last bones' rings, against those of the elbows below.
        assert moved[-8 * 12 :].max() <= 0.25 * moved.max()

    def test_either_order_of_adding_gives_the_same(self, both):
        ob, armature = both
        bpy.context.scene.frame_set(LAST_FRAME)
        expected = positions(ob)
        select([ob])
        bpy.ops.object.turgor_spine_remove()
        bpy.context.view_layer.update()
        select([armature, ob])
        bpy.ops.object.turgor_spine_add()
        ob.turgor_spine.first_bone, ob.turgor_spine.last_bone = "Bone3", "Bone5"
        bpy.context.view_layer.update()
        bpy.context.scene.frame_set(1)
        bpy.context.scene.frame_set(LAST_FRAME)
        assert [modifier.name for modifier in ob.modifiers] == ["Armature", "Turgor Spine", "Turgor Volume"]
        assert np.abs(positions(ob) - expected).max() <= 1e-6

    def test_the_same_after_loading(self, both, tmp_path):
        ob, _ = both
        bpy.context.scene.frame_set(13)
        expected = positions(ob)
        path = str(tmp_path / "both.blend")
        bpy.context.scene.frame_set(4)
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        bpy.context.scene.frame_set(13)
        assert (positions(bpy.data.objects["Tube"]) == expected).all()
