"""A body that rides along a curve object, by Blender's own Curve modifier."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import bpy
from mathutils import Vector

from .character import Point
from .datablocks import data_of, of_kind
from .posing import set_frame_range

Knot = tuple[Point, Point, Point]
"""Control point, left handle, right handle."""


class CurveRider(NamedTuple):
    """The objects of a fixture."""

    body: bpy.types.Object
    curve: bpy.types.Object


def make_bezier(name: str, knots: Sequence[Knot], resolution: int = 24, tilt: float = 0.0) -> bpy.types.Object:
    """An open Bezier curve in space with free handles, linked to the scene.

    resolution: Blender's steps per segment; tilt: radians by which it turns what it carries about itself.
    """
    data = of_kind(bpy.data.curves.new(name, "CURVE"), bpy.types.Curve)
    data.dimensions = "3D"
    data.resolution_u = resolution
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(len(knots) - 1)
    for point, (place, left, right) in zip(spline.bezier_points, knots, strict=True):
        point.handle_left_type = point.handle_right_type = "FREE"
        point.tilt = tilt
        point.co, point.handle_left, point.handle_right = Vector(place), Vector(left), Vector(right)
    curve = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(curve)
    return curve


def put_on_curve(rider: CurveRider, axis: str) -> None:
    """Adds the Curve modifier; axis of the body that follows the curve: POS_X, NEG_Y, …"""
    modifier = of_kind(rider.body.modifiers.new("Curve", "CURVE"), bpy.types.CurveModifier)
    modifier.object = rider.curve
    setattr(modifier, "deform_axis", axis)  # noqa: B010 (the stubs want a literal)


def key_glide(rider: CurveRider, frame_count: int, body_length: float, tail: float) -> None:
    """Keys the body's place along -Y so that it glides evenly from the curve's start to its end.

    tail: where the body ends at rest, along Y.
    """
    length = data_of(rider.curve, bpy.types.Curve).splines[0].calc_length()
    for frame, travelled in ((1, 0.0), (frame_count, length - body_length)):
        rider.body.location = Vector((0.0, -tail - travelled, 0.0))
        rider.body.keyframe_insert("location", frame=frame)
    action = rider.body.animation_data.action
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                for channel in bag.fcurves:
                    for key in channel.keyframe_points:
                        key.interpolation = "LINEAR"
    set_frame_range(1, frame_count)
    bpy.context.scene.frame_set(1)
