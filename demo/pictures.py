"""Renders clay pictures of the character with Workbench, framed on the whole of it or on one joint."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians, tan
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .enclosed_volume import Points
from .evaluated import positions

WIDTH, HEIGHT = 1000, 900
FIELD_OF_VIEW = radians(24.0)
# How far the camera turns from a plain side or front view, to the side and up.
TURN, RISE = radians(38.0), radians(12.0)
# Room around what is framed.
MARGIN = 1.06

Tone = tuple[float, float, float]
BEFORE_TONE: Tone = (0.52, 0.61, 0.72)
AFTER_TONE: Tone = (0.95, 0.58, 0.42)


@dataclass(frozen=True)
class View:
    """Where the camera stands, world space: `distance` from `centre` along `direction`."""

    centre: Vector
    direction: Vector
    distance: float

    @property
    def turn(self) -> Matrix:
        """(3, 3) camera axes as columns: right, up, towards the camera."""
        return self.direction.to_track_quat("Z", "Y").to_matrix()


def world_positions(meshes: list[bpy.types.Object]) -> Points:
    """(N, 3) all vertices of the meshes in the current frame, world space."""
    placed = []
    for mesh_object in meshes:
        world = np.array(mesh_object.matrix_world)
        placed.append(positions(mesh_object) @ world[:3, :3].T + world[:3, 3])
    return np.concatenate(placed)


def whole_view(meshes: list[bpy.types.Object]) -> View:
    """The whole character: seen across its longer horizontal side, turned a little towards the front (-Y)."""
    points = world_positions(meshes)
    size = np.ptp(points, axis=0)
    is_long = size[1] > 1.2 * size[0]
    side = Vector((1.0, 0.0, 0.0)) if is_long else Vector((0.0, -1.0, 0.0))
    turned = Matrix.Rotation(-TURN if is_long else TURN, 3, "Z") @ side
    return fitted(points, (turned + Vector((0.0, 0.0, tan(RISE)))).normalized())


def fitted(points: Points, direction: Vector, height_to_width: float = HEIGHT / WIDTH) -> View:
    """The nearest view along a direction that holds all the points, in a picture at most as high as it is wide."""
    axes = np.array(View(Vector(), direction, 0.0).turn)
    seen = points @ axes
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    right, up, _ = np.abs(seen - middle).T
    depth = (seen - middle)[:, 2]
    half_width = tan(FIELD_OF_VIEW / 2)
    needed = np.maximum(right / half_width, up / (half_width * height_to_width)) * MARGIN + depth
    return View(Vector(axes @ middle), direction, float(needed.max()))


def joint_view(whole: View, joint: Vector, bend_axis: Vector, reach: float) -> View:
    """The surroundings of one joint, all in world space: seen from where its bend shows, on the side of the whole."""
    towards = bend_axis if bend_axis.dot(whole.direction) >= 0.0 else -bend_axis
    return View(joint, (whole.direction + towards).normalized(), MARGIN * reach / tan(FIELD_OF_VIEW / 2))


class Studio:
    """A camera and Workbench settings in the current scene; everything but the character is kept out of the picture."""

    def __init__(self, meshes: list[bpy.types.Object]) -> None:
        scene = bpy.context.scene
        for item in scene.objects:
            item.hide_render = item not in meshes
        self.camera = bpy.data.objects.new("Turgor camera", bpy.data.cameras.new("Turgor camera"))
        self.camera.data.angle = FIELD_OF_VIEW
        scene.collection.objects.link(self.camera)
        scene.camera = self.camera

        render = scene.render
        render.engine = "BLENDER_WORKBENCH"
        render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
        render.film_transparent = True
        render.use_border = render.use_compositing = render.use_sequencer = False
        render.image_settings.file_format = "PNG"
        render.image_settings.color_mode = "RGBA"
        scene.view_settings.view_transform = "Standard"

        display = scene.display
        display.render_aa = "16"
        display.light_direction = Vector((0.4, 0.5, 0.8)).normalized()
        display.shadow_focus = 0.4
        shading = display.shading
        shading.light, shading.studio_light = "STUDIO", "paint.sl"
        shading.color_type = "SINGLE"
        shading.show_cavity = True
        shading.cavity_type = "BOTH"
        shading.cavity_ridge_factor, shading.cavity_valley_factor = 0.6, 1.2
        shading.show_shadows = True
        shading.shadow_intensity = 0.35
        shading.show_specular_highlight = True

    def take_picture(self, view: View, tone: Tone, path: Path) -> None:
        """Renders the current frame to `path`, a PNG."""
        place = Matrix.Translation(view.centre + view.distance * view.direction)
        self.camera.matrix_world = place @ view.turn.to_4x4()
        self.camera.data.clip_start, self.camera.data.clip_end = view.distance * 0.01, view.distance * 10.0
        scene = bpy.context.scene
        scene.display.shading.single_color = tone
        scene.render.filepath = str(path.resolve())
        bpy.ops.render.render(write_still=True)
