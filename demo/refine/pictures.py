"""A character side by side on its coarse mesh and on refined ones, plain and with its edges, from the same place."""

from __future__ import annotations

from collections.abc import Sequence
from math import tan
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from blend_fixtures.character import make_mesh

from ..pictures import AFTER_TONE, BEFORE_TONE, FIELD_OF_VIEW, Studio, Tone, View, fitted
from .subjects import Subject
from .trial import Posed

# Of each of the pictures that stand side by side.
WIDTH, HEIGHT = 600, 480
EDGE_TONE: Tone = (0.13, 0.11, 0.11)
# Of the width that is seen.
EDGE_WIDTH = 0.0028


def take(subject: Subject, posed: Sequence[Posed], output: Path) -> None:
    """Saves two PNGs, four where one joint is looked at: the coarse character in one tone, the refined in another."""
    bpy.ops.wm.read_homefile(use_empty=True)
    studio = Studio([])
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.film_transparent = False
    scene.display.shading.background_type = "VIEWPORT"
    scene.display.shading.background_color = (1.0, 1.0, 1.0)
    scene.display.shading.color_type = "OBJECT"
    framed = {subject.name: [one.points for one in posed]}
    if subject.about is not None:
        distances = [np.linalg.norm(one.points - one.centre, axis=1) for one in posed]
        near = [one.points[far < subject.reach] for one, far in zip(posed, distances, strict=True)]
        framed[f"{subject.name}_near"] = near
    for name, points in framed.items():
        view = fitted(np.concatenate(points), Vector(subject.direction).normalized(), HEIGHT / WIDTH)
        for has_edges in (False, True):
            # Over thousands of thin edges shadows take minutes.
            scene.display.shading.show_shadows = not has_edges
            path = output / f"{name}{'_edges' if has_edges else ''}.png"
            panels = []
            for number, one in enumerate(posed):
                objects = _added(one, BEFORE_TONE if number == 0 else AFTER_TONE, view, has_edges=has_edges)
                panels.append(path.with_stem(f"{path.stem}_{number}"))
                studio.take_picture(view, AFTER_TONE, panels[-1])
                for ob in objects:
                    bpy.data.objects.remove(ob)
            _join(panels, path)


def _added(posed: Posed, tone: Tone, view: View, *, has_edges: bool) -> list[bpy.types.Object]:
    faces = np.split(posed.corners, np.cumsum(posed.sizes)[:-1])
    mesh = make_mesh("posed", posed.points, faces)
    found = [bpy.data.objects.new("posed", mesh) for _ in range(1 + has_edges)]
    for ob, colour in zip(found, (tone, EDGE_TONE), strict=False):
        ob.color = (*colour, 1.0)
        bpy.context.scene.collection.objects.link(ob)
    if has_edges:
        width = 2.0 * tan(FIELD_OF_VIEW / 2) * view.distance
        wires = found[1].modifiers.new("Edges", "WIREFRAME")
        wires.thickness, wires.offset, wires.use_even_offset = EDGE_WIDTH * width, 1.0, False
    return found


def _join(panels: Sequence[Path], path: Path) -> None:
    """Side by side as one PNG; they are deleted."""
    rows = []
    for panel in panels:
        image = bpy.data.images.load(str(panel.resolve()))
        rows.append(np.array(image.pixels, np.float32).reshape(HEIGHT, WIDTH, 4))
        bpy.data.images.remove(image)
        panel.unlink()
    joined = bpy.data.images.new(path.stem, WIDTH * len(rows), HEIGHT)
    joined.pixels.foreach_set(np.concatenate(rows, axis=1).ravel())
    joined.filepath_raw, joined.file_format = str(path.resolve()), "PNG"
    joined.save()
    bpy.data.images.remove(joined)
