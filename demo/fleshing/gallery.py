"""Takes the pictures: bodies made for one picture, rendered with Workbench, and removed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians
from pathlib import Path

import bpy
import numpy as np
import turgor
from mathutils import Vector

from blend_fixtures.character import make_mesh
from blend_fixtures.materials import paint

from ..enclosed_volume import Points
from ..pictures import AFTER_TONE, BEFORE_TONE, Studio, Tone, View, fitted
from .bend import CURVE
from .bodies import Body, circle, swept
from .experiment import Picture

REST_TONE: Tone = (0.80, 0.77, 0.72)
THREAD_TONE: Tone = (0.22, 0.20, 0.19)
# Edges sharper than this stay edges.
SHARP = radians(50.0)


Size = tuple[int, int]


@dataclass(frozen=True)
class Model:
    """A body to picture. way: what bent it, which gives its tone; colours: (N, 3) in place of tones."""

    body: Body
    way: str = ""
    tone: Tone | None = None
    colours: Points | None = None
    is_smooth: bool = True

    @property
    def colour(self) -> Tone:
        """Its tone: blue bent by the Curve modifier, red by the engine, grey at rest."""
        if self.tone is not None:
            return self.tone
        return {"": REST_TONE, CURVE: BEFORE_TONE}.get(self.way, AFTER_TONE)


@dataclass(frozen=True)
class Shot:
    """A view and the size of its picture in pixels: width, and a height that is not larger."""

    view: View
    size: Size


class Gallery:
    """The studio and the folder of the pictures."""

    def __init__(self, output: Path) -> None:
        self.output = output
        self.studio = Studio([])
        bpy.context.scene.display.shading.color_type = "OBJECT"

    def shot(self, positions: Sequence[Points], direction: Sequence[float], size: Size) -> Shot:
        """The nearest view that holds all the points; direction: where the camera stands."""
        width, height = size
        return Shot(fitted(np.concatenate(positions), Vector(direction).normalized(), height / width), size)

    def thread(self, spine: turgor.Spine, radius: float) -> Model:
        """A spine to look at."""
        start, end = spine.parameter_range
        return Model(swept(spine.evaluate(np.linspace(start, end, 240)), circle(radius, 12)), tone=THREAD_TONE)

    def picture(self, name: str, models: Sequence[Model], shot: Shot, caption: str) -> Picture:
        """Renders models to `name`.png."""
        scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = shot.size
        is_painted = any(model.colours is not None for model in models)
        scene.display.shading.color_type = "VERTEX" if is_painted else "OBJECT"
        objects = [added(model, is_painted) for model in models]
        path = self.output / f"{name}.png"
        self.studio.take_picture(shot.view, REST_TONE, path)
        for item in objects:
            bpy.data.meshes.remove(item.data)
        return Picture(path, caption)


def added(model: Model, is_painted: bool) -> bpy.types.Object:
    """The model as an object of the scene."""
    points = model.body.points
    mesh = make_mesh("model", points, model.body.faces)
    if model.is_smooth:
        mesh.set_sharp_from_angle(angle=SHARP)
    else:
        mesh.polygons.foreach_set("use_smooth", np.zeros(len(mesh.polygons), dtype=bool))
    if is_painted:
        paint(mesh, np.tile(model.colour, (len(points), 1)) if model.colours is None else model.colours)
    item = bpy.data.objects.new("model", mesh)
    item.color = (*model.colour, 1.0)
    bpy.context.scene.collection.objects.link(item)
    return item
