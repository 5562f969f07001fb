"""Blender's Curve modifier on the curve of a spine: the tool that artists have today."""

from __future__ import annotations

import bpy
import numpy as np
import turgor

from blend_fixtures.character import make_mesh
from blend_fixtures.curve_rider import CurveRider, make_bezier, put_on_curve

from ..enclosed_volume import Points
from ..evaluated import positions
from .bodies import Body

# Bezier segments that follow the spine to about 1e-6 of its length, and Blender's steps in each of them.
SEGMENT_COUNT = 64
RESOLUTION = 16


class CurveModifier:
    """Bends bodies that lie along X with the Curve modifier, X being the length along the spine.

    Blender itself picks how cross-sections are turned about the curve: `turn`, (2, 2), turns bodies so that the first
    cross-section stands as in the spine's frame.
    """

    def __init__(self, spine: turgor.Spine) -> None:
        self.curve = curve_along(spine)
        start, _ = spine.parameter_range
        frame = spine.evaluate([start])
        self.turn = np.eye(2)
        probe = self.bent(Body(np.array([(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]), []))
        # Bodies have Z where frames have their normal, and -Y where they have their binormal.
        self.turn = (probe[1:] - probe[0]) @ np.stack([-frame.binormals[0], frame.normals[0]]).T

    def bent(self, body: Body) -> Points:
        """(N, 3) vertices as Blender's dependency graph evaluates them."""
        with_turn = body.points.copy()
        with_turn[:, 1:] = body.points[:, 1:] @ self.turn.T
        mesh_object = bpy.data.objects.new("body", make_mesh("body", with_turn, body.faces))
        bpy.context.scene.collection.objects.link(mesh_object)
        put_on_curve(CurveRider(mesh_object, self.curve), "POS_X")
        bpy.context.view_layer.update()
        result = positions(mesh_object)
        bpy.data.meshes.remove(mesh_object.data)
        return result


def curve_along(spine: turgor.Spine) -> bpy.types.Object:
    """A Bezier curve object whose segments meet the spine in place and direction."""
    places = np.linspace(0.0, spine.length, SEGMENT_COUNT + 1)
    frames = spine.evaluate(spine.parameters_at(places))
    handle = frames.tangents * spine.length / SEGMENT_COUNT / 3.0
    knots = zip(frames.positions, frames.positions - handle, frames.positions + handle, strict=True)
    return make_bezier("spine", [tuple(tuple(part) for part in knot) for knot in knots], RESOLUTION)
