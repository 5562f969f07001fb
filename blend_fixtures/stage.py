"""Camera, lights, ground: what makes a render of a fixture look good as it is."""

from __future__ import annotations

from math import radians

import bpy
import numpy as np
from mathutils import Euler, Vector

from .character import Character
from .curve_rider import CurveRider
from .datablocks import data_of, of_kind
from .materials import Colour, make_material, paint, set_input

BACKGROUND: Colour = (0.66, 0.70, 0.74)
GROUND: Colour = (0.80, 0.79, 0.76)
STUDIO_LIGHT = "paint.sl"
MARGIN = 1.12
"""Picture size over the character's size in it."""


def set_stage(
    fixture: Character | CurveRider,
    view: tuple[float, float],
    ground: bool = False,
    is_painted: bool = False,
    lens: float = 60.0,
    resolution: tuple[int, int] = (960, 640),
) -> None:
    """Light the scene and aim a camera that holds the whole animation of the body.

    is_painted: Workbench shows `paint` in place of materials.
    view: the camera's heading about Z (0 looks along +Y, at a face turned to -Y) and its height, in degrees.
    """
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = resolution
    _add_camera(fixture, view, lens)
    _add_sun("sun", 1.9, (48.0, 0.0, view[0] + 38.0))
    _add_sun("fill", 0.5, (62.0, 0.0, view[0] - 65.0))
    _add_world()
    if ground:
        _add_ground()
    shading = scene.display.shading
    shading.light = "STUDIO"
    shading.studio_light = STUDIO_LIGHT
    shading.color_type = "VERTEX" if is_painted else "MATERIAL"
    shading.show_cavity = True
    shading.cavity_type = "WORLD"
    shading.show_shadows = ground
    shading.shadow_intensity = 0.35
    shading.background_type = "VIEWPORT"
    shading.background_color = BACKGROUND
    scene.display.render_aa = "8"
    scene.view_settings.view_transform = "Standard"


def animated_positions(body: bpy.types.Object, step: int = 2) -> np.ndarray:
    """World positions of the evaluated mesh over the frame range, (frames, N, 3)."""
    scene = bpy.context.scene
    frames = []
    for frame in range(scene.frame_start, scene.frame_end + 1, step):
        scene.frame_set(frame)
        evaluated = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = data_of(evaluated, bpy.types.Mesh)
        positions = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
        of_kind(mesh.attributes["position"], bpy.types.FloatVectorAttribute).data.foreach_get("vector", positions)
        world = np.array(evaluated.matrix_world)
        frames.append(positions.reshape(-1, 3).astype(float) @ world[:3, :3].T + world[:3, 3])
    scene.frame_set(scene.frame_start)
    return np.array(frames)


def _add_camera(fixture: Character | CurveRider, view: tuple[float, float], lens: float) -> None:
    scene = bpy.context.scene
    optics = bpy.data.cameras.new("camera")
    optics.lens = lens
    optics.clip_end = 1000.0
    optics.sensor_fit = "VERTICAL"
    camera = bpy.data.objects.new("camera", optics)
    scene.collection.objects.link(camera)
    rotation = Euler((radians(90.0 - view[1]), 0.0, radians(view[0])))
    points = animated_positions(fixture.body).reshape(-1, 3) @ np.array(rotation.to_matrix())
    # In camera axes a point is inside when |x - cx| <= (cz - z) * tangent, likewise y: the tightest cx, cy, cz.
    tangent_y = optics.sensor_height / (2 * lens) / MARGIN
    tangent_x = tangent_y * scene.render.resolution_x / scene.render.resolution_y
    centre, distance = [], []
    for axis, tangent in ((0, tangent_x), (1, tangent_y)):
        above = (points[:, axis] + tangent * points[:, 2]).max()
        below = (-points[:, axis] + tangent * points[:, 2]).max()
        centre.append((above - below) / 2)
        distance.append((above + below) / (2 * tangent))
    camera.rotation_euler = rotation
    camera.location = rotation.to_matrix() @ Vector((*centre, max(distance)))
    scene.camera = camera


def _add_sun(name: str, energy: float, rotation_degrees: tuple[float, float, float]) -> None:
    sun = of_kind(bpy.data.lights.new(name, "SUN"), bpy.types.SunLight)
    sun.energy = energy
    sun.angle = radians(6.0)
    light = bpy.data.objects.new(name, sun)
    light.rotation_euler = tuple(radians(angle) for angle in rotation_degrees)
    light.location = (0.0, 0.0, 6.0)
    bpy.context.scene.collection.objects.link(light)


def _add_world() -> None:
    world = bpy.data.worlds.new("world")
    world.color = BACKGROUND
    if world.node_tree is None:
        world.use_nodes = True
    tree = of_kind(world.node_tree, bpy.types.NodeTree)
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    set_input(background, "Color", (*BACKGROUND, 1.0))
    set_input(background, "Strength", 0.5)
    bpy.context.scene.world = world


def _add_ground() -> None:
    mesh = bpy.data.meshes.new("ground")
    size = 400.0
    mesh.from_pydata([(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(make_material("ground", GROUND, 0.9))
    paint(mesh, np.tile(GROUND, (4, 1)))
    ground = bpy.data.objects.new("ground", mesh)
    ground.hide_select = True
    bpy.context.scene.collection.objects.link(ground)
