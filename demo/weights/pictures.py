"""Pictures of a case, bent: with Blender's weights on the left, with Turgor's on the right, coloured by bone."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from blend_fixtures.character import make_mesh
from blend_fixtures.materials import paint

from ..enclosed_volume import Points
from ..pictures import Studio, fitted
from .cases import Case
from .trial import BLENDER, TURGOR, Posed

WIDTH, HEIGHT = 1400, 560
DIRECTION = Vector((0.25, -1.0, 0.45)).normalized()
# Vertices without weights.
BLACK = (0.02, 0.02, 0.02)


class Gallery:
    """A studio for painted meshes."""

    def __init__(self, output: Path) -> None:
        self.output = output
        self.studio = Studio([])
        scene = bpy.context.scene
        scene.display.shading.color_type = "VERTEX"
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT

    def picture(self, number: int, case: Case, posed: Mapping[str, Posed]) -> Path:
        """Saves the case as a PNG."""
        rest = np.vstack([shape.points for shape in case.meshes])
        held = rest[posed[TURGOR].weights.sum(axis=1) > 0.0]
        size = float(np.ptp(held, axis=0).max())
        objects, shown = [], []
        for place, way in ((-0.62, BLENDER), (0.62, TURGOR)):
            points = posed[way].places / size
            near = np.abs(points - np.median(points, axis=0)).max(axis=1) < 2.0
            points = points - (points[near].min(axis=0) + points[near].max(axis=0)) / 2 + [place, 0.0, 0.0]
            shown.append(points[near])
            objects += self._added(case, points, colours(posed[way]))
        view = fitted(np.vstack(shown), DIRECTION, HEIGHT / WIDTH)
        path = self.output / f"{number:02d}_{case.name.replace(' ', '_').replace(',', '')}.png"
        self.studio.take_picture(view, BLACK, path)
        for ob in objects:
            bpy.data.meshes.remove(ob.data)
        return path

    def _added(self, case: Case, points: Points, tones: Points) -> list[bpy.types.Object]:
        objects, start = [], 0
        for shape in case.meshes:
            stop = start + len(shape.points)
            faces = [face for face in shape.faces if len(set(face)) == len(face)]
            mesh = make_mesh("posed", points[start:stop], faces)
            paint(mesh, tones[start:stop])
            objects.append(bpy.data.objects.new("posed", mesh))
            bpy.context.scene.collection.objects.link(objects[-1])
            start = stop
        return objects


def colours(posed: Posed) -> Points:
    """(N, 3) tones of the bones, mixed by weight; black without any."""
    count = posed.weights.shape[1]
    tones = np.array([colorsys.hls_to_rgb((0.02 + 0.38 * bone) % 1.0, 0.6, 0.75) for bone in range(count)])
    return np.where(posed.weights.sum(axis=1, keepdims=True) > 0.0, posed.weights @ tones, BLACK)
