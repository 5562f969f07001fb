"""Pictures of a fold: whole, and cut open in the plane of the bend; points of new folds red, held ones blue."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np
from mathutils import Vector

from blend_fixtures.character import make_mesh
from blend_fixtures.materials import paint

from ..pictures import Studio, fitted

if TYPE_CHECKING:
    from .show import Shape

SKIN, FOLD, HELD = (0.62, 0.5, 0.42), (0.8, 0.02, 0.02), (0.1, 0.2, 0.75)
WIDTH, HEIGHT = 1500, 800
# Looking along the axis of the bend, a little from inside of it.
DIRECTION = Vector((1.0, 0.28, 0.2)).normalized()


class Gallery:
    """A studio for painted meshes."""

    def __init__(self, output: Path) -> None:
        self.output = output
        self.studio = Studio([])
        scene = bpy.context.scene
        scene.display.shading.color_type = "VERTEX"
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT

    def picture(self, name: str, way: str, shape: Shape, faces: Sequence[tuple[int, ...]]) -> Path:
        """Saves `name_way.png`: whole on the left, cut open on the right."""
        points = shape.points
        size = float(np.ptp(points, axis=0).max())
        tones = np.tile(SKIN, (len(points), 1))
        tones[shape.held] = HELD
        tones[shape.in_fold] = FOLD
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        side = np.cross(np.array(DIRECTION), [0.0, 0.0, 1.0])
        side /= np.linalg.norm(side)
        # The half that faces away is left of what is cut open.
        cut = [face for face in faces if points[list(face), 0].mean() < middle[0]]
        objects, shown = [], []
        for place, kept in ((0.55, list(faces)), (-0.55, cut)):
            moved = (points - middle) / size + place * side
            mesh = make_mesh("posed", moved, kept)
            paint(mesh, tones)
            ob = bpy.data.objects.new("posed", mesh)
            bpy.context.scene.collection.objects.link(ob)
            objects.append(ob)
            shown.append(moved)
        path = self.output / f"{name}_{way}.png"
        self.studio.take_picture(fitted(np.vstack(shown), DIRECTION, HEIGHT / WIDTH), SKIN, path)
        for ob in objects:
            bpy.data.meshes.remove(ob.data)
        return path
