"""The builder of test characters: a closed tube along +Z on a chain of bones, bent over 20 frames."""

from __future__ import annotations

import importlib
from collections.abc import Iterable

import bpy
import numpy as np

LENGTH, RADIUS = 4.0, 0.5
RINGS, SEGMENTS = 21, 12
LAST_FRAME = 20


def tube_mesh(
    name: str = "Tube", rings: int = RINGS, segments: int = SEGMENTS, *, is_open: bool = False, at_x: float = 0.0
) -> bpy.types.Mesh:
    heights = np.linspace(0.0, LENGTH, rings)
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    points = [(at_x + RADIUS * np.cos(angle), RADIUS * np.sin(angle), height) for height in heights for angle in angles]
    faces: list[tuple[int, ...]] = [
        (
            ring * segments + side,
            ring * segments + (side + 1) % segments,
            (ring + 1) * segments + (side + 1) % segments,
            (ring + 1) * segments + side,
        )
        for ring in range(rings - 1)
        for side in range(segments)
    ]
    if not is_open:
        top = (rings - 1) * segments
        faces += [tuple(reversed(range(segments))), tuple(range(top, top + segments))]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    return mesh


def rig(name: str = "Rig", bone_count: int = 3) -> bpy.types.Object:
    armature = bpy.data.objects.new(name, bpy.data.armatures.new(name))
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    parent = None
    for index in range(bone_count):
        bone = armature.data.edit_bones.new(f"Bone{index}")
        bone.head = (0.0, 0.0, LENGTH * index / bone_count)
        bone.tail = (0.0, 0.0, LENGTH * (index + 1) / bone_count)
        if parent is not None:
            bone.parent, bone.use_connect = parent, True
        parent = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in armature.pose.bones:
        bone.rotation_mode = "XYZ"
    return armature


def weigh(ob: bpy.types.Object, bone_count: int = 3) -> None:
    """Smooth weights by height, at most two bones per vertex."""
    groups = [ob.vertex_groups.new(name=f"Bone{index}") for index in range(bone_count)]
    for vertex in ob.data.vertices:
        place = np.clip(vertex.co.z / LENGTH * bone_count - 0.5, 0.0, bone_count - 1.0)
        lower = int(min(place, bone_count - 2)) if bone_count > 1 else 0
        part = float(np.clip((place - lower - 0.5) * 1.5 + 0.5, 0.0, 1.0))
        if part < 1.0:
            groups[lower].add([vertex.index], 1.0 - part, "REPLACE")
        if part > 0.0 and bone_count > 1:
            groups[lower + 1].add([vertex.index], part, "REPLACE")


def bend(armature: bpy.types.Object, amount: float = 1.2) -> None:
    """Straight at frame 1, each bone bent and twisted at the last."""
    for index, bone in enumerate(armature.pose.bones):
        for frame, part in ((1, 0.0), (LAST_FRAME, 1.0)):
            bone.rotation_euler = (amount * part * (index > 0), 0.6 * part, 0.3 * part * index)
            bone.keyframe_insert("rotation_euler", frame=frame)


def place(name: str, mesh: bpy.types.Mesh, armature: bpy.types.Object) -> bpy.types.Object:
    """An object with weights and an Armature modifier, not yet ours."""
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(ob)
    weigh(ob, len(armature.data.bones))
    ob.modifiers.new("Armature", "ARMATURE").object = armature
    return ob


def character(name: str = "Tube", **shape: object) -> tuple[bpy.types.Object, bpy.types.Object]:
    """A bent tube and its rig, animated, without Turgor."""
    armature = rig()
    ob = place(name, tube_mesh(name, **shape), armature)
    bend(armature)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, LAST_FRAME
    bpy.context.scene.frame_set(1)
    return ob, armature


def add_turgor(*objects: bpy.types.Object) -> None:
    select(objects)
    assert bpy.ops.object.turgor_volume_add() == {"FINISHED"}


def act_locally(ob: bpy.types.Object) -> None:
    """Fields that end on the tube: those of new characters reach over all of it."""
    ob.turgor.fields = "PLAIN"
    for joint in ob.turgor.joints:
        joint.preset = "ISOTROPIC"


def select(objects: Iterable[bpy.types.Object]) -> None:
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    for ob in objects:
        ob.select_set(True)
        bpy.context.view_layer.objects.active = ob


def subdivide(ob: bpy.types.Object) -> None:
    """In Edit Mode, as an artist does."""
    select([ob])
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")


def play_as_strip(ob: bpy.types.Object) -> None:
    """Its action from the first frame on, as a strip of the NLA."""
    data = ob.animation_data
    action, slot = data.action, getattr(data, "action_slot", None)
    strip = data.nla_tracks.new().strips.new("Keys", 1, action)
    if slot is not None:
        strip.action_slot = slot
    data.action = None


def volume_modifier(ob: bpy.types.Object) -> bpy.types.NodesModifier:
    return next(modifier for modifier in ob.modifiers if modifier.name.startswith("Turgor Volume"))


def skin_bones(ob: bpy.types.Object) -> tuple:
    """The bones and nodes by which its Armature skins it, as a bind reads them."""
    rest, skin = (importlib.import_module(f"addon.{name}") for name in ("scene.rest", "live.skin"))
    armature = next(modifier for modifier in ob.modifiers if modifier.type == "ARMATURE")
    read = rest.read_rest(ob, armature, bpy.context.scene.frame_current)
    return skin.read_skin(
        read, [group.name for group in ob.vertex_groups], armature, np.eye(4), bpy.context.scene.frame_current
    ).bones


def set_strength(ob: bpy.types.Object, value: float) -> None:
    modifier = volume_modifier(ob)
    if bpy.app.version >= (5, 2, 0):
        modifier.properties.inputs.Socket_2.value = value
    else:
        modifier["Socket_2"] = value
    ob.update_tag()


def carrier(ob: bpy.types.Object) -> bpy.types.Object:
    return next(held for held in bpy.data.objects if held.turgor.carrier.target == ob)
