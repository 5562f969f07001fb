"""A character side by side on its coarse mesh and on refined ones, plain and with its edges."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from blend_fixtures.character import make_mesh

from ..pictures import AFTER_TONE, BEFORE_TONE, Studio, Tone, fitted
from .subjects import Subject
from .trial import Posed

WIDTH, HEIGHT = 1500, 520
EDGE_TONE: Tone = (0.13, 0.11, 0.11)
# Of what is shown, between neighbours and of edges.
GAP, EDGE_WIDTH = 1.12, 0.004


def take(subject: Subject, posed: Sequence[Posed], output: Path) -> None:
    """Saves two PNGs: the first character in one tone, the refined ones in another."""
    bpy.ops.wm.read_homefile(use_empty=True)
    studio = Studio([])
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.display.shading.color_type = "OBJECT"
    # Over thousands of thin edges shadows take minutes.
    scene.display.shading.show_shadows = False
    direction = Vector(subject.direction).normalized()
    right = np.array(direction.to_track_quat("Z", "Y").to_matrix().col[0])
    cut = [_near(one, subject) for one in posed]
    width = max(float(np.ptp(points @ right)) for points, _ in cut)
    objects, shown = [], []
    for number, (points, faces) in enumerate(cut):
        points = points - right * (0.5 * (points @ right).max() + 0.5 * (points @ right).min())
        points = points + right * (number - 1) * GAP * width
        shown.append(points)
        objects.append(_added(points, faces, BEFORE_TONE if number == 0 else AFTER_TONE))
    view = fitted(np.concatenate(shown), direction, HEIGHT / WIDTH)
    studio.take_picture(view, AFTER_TONE, output / f"{subject.name}.png")
    for ob in objects:
        edges = ob.copy()
        edges.color = (*EDGE_TONE, 1.0)
        wires = edges.modifiers.new("Edges", "WIREFRAME")
        wires.thickness, wires.offset, wires.use_even_offset = EDGE_WIDTH * width, 1.0, False
        scene.collection.objects.link(edges)
    studio.take_picture(view, AFTER_TONE, output / f"{subject.name}_edges.png")


def _near(posed: Posed, subject: Subject) -> tuple[np.ndarray, list[np.ndarray]]:
    """Points, and the faces that are shown: near the joint that the picture is about."""
    faces = np.split(posed.corners, np.cumsum(posed.sizes)[:-1])
    if posed.centre is None:
        return posed.points, faces
    is_near = np.linalg.norm(posed.points - posed.centre, axis=1) < subject.reach
    kept = [face for face in faces if is_near[face].all()]
    used, compact = np.unique(np.concatenate(kept), return_inverse=True)
    return posed.points[used], np.split(compact.ravel(), np.cumsum([len(face) for face in kept])[:-1])


def _added(points: np.ndarray, faces: Sequence[np.ndarray], tone: Tone) -> bpy.types.Object:
    ob = bpy.data.objects.new("posed", make_mesh("posed", points, faces))
    ob.color = (*tone, 1.0)
    bpy.context.scene.collection.objects.link(ob)
    return ob
