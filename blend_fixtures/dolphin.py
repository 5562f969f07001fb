"""A dolphin of few faces that swims along a Bezier curve: no armature, no weights."""

from __future__ import annotations

from math import pi

import bpy
import numpy as np

from .cage import Cage, Loft, Station, Surface, ellipse
from .character import make_mesh
from .curve_rider import CurveRider, Knot, key_glide, make_bezier, put_on_curve
from .materials import Colour, make_material, paint
from .shells import ball
from .stage import set_stage

FRAME_COUNT = 96

STATIONS = [
    Station(-1.20, 0.015, 0.035, 0.035, 0.030),
    Station(-1.11, 0.015, 0.050, 0.050, 0.034),
    Station(-1.00, 0.012, 0.068, 0.068, 0.036),
    Station(-0.84, 0.008, 0.100, 0.105, 0.058),
    Station(-0.62, 0.002, 0.150, 0.158, 0.105),
    Station(-0.36, 0.0, 0.200, 0.212, 0.165),
    Station(-0.10, 0.0, 0.228, 0.240, 0.208),
    Station(0.16, 0.0, 0.234, 0.246, 0.224),
    Station(0.40, 0.0, 0.224, 0.236, 0.216),
    Station(0.62, 0.0, 0.196, 0.208, 0.190),
    Station(0.80, -0.008, 0.168, 0.166, 0.156),
    Station(0.93, -0.016, 0.142, 0.120, 0.118, -6),
    Station(1.01, -0.046, 0.086, 0.074, 0.078, -8),
    Station(1.10, -0.066, 0.046, 0.048, 0.054, -4),
    Station(1.20, -0.070, 0.036, 0.040, 0.044),
    Station(1.28, -0.070, 0.022, 0.026, 0.028),
]
FLUKE_SEGMENTS, FLUKE_COLUMNS = range(2), range(1, 3)
FLIPPER_SEGMENTS, FLIPPER_COLUMNS = range(8, 10), range(3, 4)
FIN_SEGMENTS, FIN_COLUMNS = range(5, 7), range(9, 10)

BACK: Colour = (0.155, 0.215, 0.275)
BELLY: Colour = (0.74, 0.76, 0.76)
DARK: Colour = (0.02, 0.02, 0.03)

SPINE_ENDS = ((0.0, 1.20, 0.0), (0.0, -1.28, 0.0))
"""The straight spine at rest, from the flukes to the beak."""
LEAP: list[Knot] = [
    ((-5.2, 0.9, -0.8), (-6.2, 1.2, -0.6), (-3.9, 0.52, -1.03)),
    ((-1.3, -0.4, 0.75), (-2.7, -0.45, 0.45), (0.1, -0.35, 1.05)),
    ((2.2, 0.3, -0.75), (1.25, -0.1, 0.1), (3.15, 0.7, -1.6)),
    ((5.4, 0.1, -0.5), (4.3, 0.8, -1.1), (6.5, -0.6, 0.1)),
]
"""Control point, left and right handle of each knot: up out of the water, over, down, and away to the side."""


def build() -> CurveRider:
    """The dolphin on its way, by Blender's own Curve modifier."""
    surface = surface_with_eyes()
    mesh = make_mesh("dolphin", surface.points, surface.quads)
    mesh.materials.append(make_material("dolphin_skin", BACK, 0.3, use_paint=True))
    paint(mesh, _colours(surface))
    body = bpy.data.objects.new("dolphin", mesh)
    bpy.context.scene.collection.objects.link(body)
    rider = CurveRider(body, make_bezier("leap", LEAP, tilt=pi))
    put_on_curve(rider, "NEG_Y")
    key_glide(rider, FRAME_COUNT, body_length=SPINE_ENDS[0][1] - SPINE_ENDS[1][1], tail=SPINE_ENDS[0][1])
    set_stage(rider, view=(12.0, 10.0), is_painted=True, resolution=(1200, 480))
    return rider


def surface_with_eyes(levels: int = 1) -> Surface:
    """Body and eyes, three closed shells; about a thousand vertices at one level."""
    surface = body_surface(levels)
    for side in (1, -1):
        eye = ball((0.122, -0.905, -0.035), 0.018, "eye")
        surface = surface.joined(eye if side > 0 else eye.mirrored())
    return surface


def body_surface(levels: int = 1) -> Surface:
    """The body with its fins: one closed shell along Y, looking along -Y."""
    cage = Cage()
    loft = Loft(cage, STATIONS, lambda _: "body")
    loft.close_rear("body", bulge=0.012)
    loft.close_front("body", bulge=(0, -0.012, 0))
    for side in (1, -1):
        _add_fluke(cage, loft, side)
        _add_flipper(cage, loft, side)
    _add_fin(cage, loft)
    return cage.surface(levels)


def _add_fluke(cage: Cage, loft: Loft, side: int) -> None:
    loop, squares = loft.open_patch(FLUKE_SEGMENTS, FLUKE_COLUMNS, side)
    rings = [
        ellipse(squares, (x, -forward, 0.015), (0, -chord, 0), (0, 0, -thickness))
        for x, forward, chord, thickness in (
            (0.095, -1.125, 0.110, 0.020),
            (0.195, -1.190, 0.086, 0.015),
            (0.285, -1.265, 0.050, 0.010),
        )
    ]
    cage.fill_side(cage.draw_out(loop, rings, "fluke", side), 2, 2, "fluke", side)


def _add_flipper(cage: Cage, loft: Loft, side: int) -> None:
    loop, squares = loft.open_patch(FLIPPER_SEGMENTS, FLIPPER_COLUMNS, side)
    rings = [
        ellipse(squares, (x, -forward, z), (0, -chord, 0), (-0.5 * thickness, 0, -thickness))
        for x, forward, z, chord, thickness in (
            (0.205, 0.435, -0.215, 0.092, 0.026),
            (0.290, 0.345, -0.275, 0.070, 0.019),
            (0.365, 0.235, -0.315, 0.036, 0.012),
        )
    ]
    cage.fill_side(cage.draw_out(loop, rings, "flipper", side), 2, 1, "flipper", side)


def _add_fin(cage: Cage, loft: Loft) -> None:
    loop, squares = loft.open_patch(FIN_SEGMENTS, FIN_COLUMNS)
    rings = [
        ellipse(squares, (0, -forward, z), (0, -chord, 0), (thickness, 0, 0))
        for forward, z, chord, thickness in (
            (-0.110, 0.275, 0.150, 0.030),
            (-0.205, 0.365, 0.092, 0.019),
            (-0.300, 0.430, 0.040, 0.011),
        )
    ]
    cage.fill(cage.draw_out(loop, rings, "fin"), 2, 1, "fin")


def _colours(surface: Surface) -> np.ndarray:
    """Colours (N, 3): dark back, pale belly, black eyes."""
    share = np.clip((surface.points[:, 2] + 0.16) / 0.16, 0.0, 1.0)
    share = np.where(surface.vertices_of("flipper"), 1.0, share * share * (3 - 2 * share))
    colours = np.array(BELLY) + share[:, None] * (np.array(BACK) - BELLY)
    colours[surface.vertices_of("eye")] = DARK
    return colours
