"""The builder of bodies for Turgor Spine: a closed tube along +Z without weights, and what it bends along."""

from __future__ import annotations

import bpy
from tube import LAST_FRAME, LENGTH, rig, select, tube_mesh

RINGS = 41


def body(name: str = "Tube", **shape: object) -> bpy.types.Object:
    ob = bpy.data.objects.new(name, tube_mesh(name, **({"rings": RINGS} | shape)))
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, LAST_FRAME
    return ob


def chain(bone_count: int = 5, amount: float = 0.25) -> bpy.types.Object:
    """An armature of one chain, straight at frame 1; at the last each bone is bent so far, and rolled."""
    armature = rig(bone_count=bone_count)
    for index, bone in enumerate(armature.pose.bones):
        for frame, part in ((1, 0.0), (LAST_FRAME, 1.0)):
            bone.rotation_euler = (amount * part, 0.1 * part, 0.4 * amount * part * (index > 1))
            bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_set(1)
    return armature


def curve(kind: str = "BEZIER", points: int = 4) -> bpy.types.Object:
    """A straight curve along the tube."""
    data = bpy.data.curves.new("Curve", "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new(kind)
    own = spline.bezier_points if kind == "BEZIER" else spline.points
    own.add(points - 1)
    for index, point in enumerate(own):
        place = (0.0, 0.0, LENGTH * index / (points - 1))
        if kind == "BEZIER":
            point.co, point.handle_left_type, point.handle_right_type = place, "AUTO", "AUTO"
        else:
            point.co = (*place, 1.0)
    if kind == "NURBS":
        spline.order_u, spline.use_endpoint_u = 4, True
    ob = bpy.data.objects.new("Curve", data)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def bow(ob: bpy.types.Object, by: float = 0.5) -> None:
    """Move the second control point aside."""
    spline = ob.data.splines[0]
    if spline.type == "BEZIER":
        point = spline.bezier_points[1]
        point.co = (by, 0.3 * by, point.co.z)
    else:
        point = spline.points[1]
        point.co = (by, 0.3 * by, point.co.z, 1.0)
    bpy.context.view_layer.update()


def add_spine(ob: bpy.types.Object, spine: bpy.types.Object) -> bpy.types.PropertyGroup:
    """The body's settings."""
    select([spine, ob])
    assert bpy.ops.object.turgor_spine_add() == {"FINISHED"}
    return ob.turgor_spine
