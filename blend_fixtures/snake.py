"""A snake on a chain of bones that slithers: weights are the simplest there are, a step from bone to bone."""

from __future__ import annotations

from math import pi, sin

import numpy as np

from .cage import Cage, Loft, Station, Surface
from .character import Bone, Character, make_character, make_mesh
from .materials import Colour, make_material, paint
from .posing import Pose, key_cycle
from .shells import ball
from .stage import set_stage
from .tube import Tube, chain_weights

FRAME_COUNT = 48
BONE_COUNT = 20
TAIL, NECK, NOSE = -2.0, 1.72, 2.06
"""Where the body begins and the head begins and ends, metres along -Y."""
WAVES = 1.5
"""Waves along the body."""
SWING = 58.0
"""Largest angle of the body against its way, degrees; the head swings less."""

RADII = [
    (-2.0, 0.012),
    (-1.8, 0.034),
    (-1.4, 0.070),
    (-0.8, 0.106),
    (0.0, 0.126),
    (0.8, 0.116),
    (1.3, 0.092),
    (1.58, 0.072),
]
"""Radius of the round body by place."""
RING_COUNT = 44
HEIGHT = 0.126
"""Of the chain above the ground, metres: the largest radius."""
HEAD = [
    Station(1.66, 0.078, 0.072, 0.066, 0.074),
    Station(1.74, 0.082, 0.078, 0.066, 0.096),
    Station(1.83, 0.080, 0.078, 0.064, 0.108),
    Station(1.92, 0.074, 0.066, 0.056, 0.092),
    Station(2.00, 0.066, 0.050, 0.044, 0.068),
    Station(2.05, 0.060, 0.030, 0.028, 0.044),
]

GREEN: Colour = (0.24, 0.33, 0.10)
BAND: Colour = (0.085, 0.10, 0.035)
BELLY: Colour = (0.72, 0.66, 0.42)
DARK: Colour = (0.02, 0.02, 0.01)


def _bones() -> list[Bone]:
    """A chain from the tail to the nose; turning a bone about its local X bends it sideways."""
    places = [*np.linspace(TAIL, NECK, BONE_COUNT), NOSE]
    names = [*(f"spine.{number:03}" for number in range(1, BONE_COUNT)), "head"]
    bones = []
    for index, name in enumerate(names):
        head, tail = ((0.0, -float(place), HEIGHT) for place in places[index : index + 2])
        bones.append(Bone(name, head, tail, names[index - 1] if index else None, (0.0, 0.0, 1.0)))
    return bones


BONES = _bones()


def build() -> Character:
    """The slithering snake, ready to render."""
    surface = body_surface()
    for side in (1, -1):
        eye = ball((0.082, -1.885, 0.112), 0.019, "eye")
        surface = surface.joined(eye if side > 0 else eye.mirrored())
    mesh = make_mesh("snake", surface.points, surface.quads)
    mesh.materials.append(make_material("snake_skin", GREEN, 0.35, use_paint=True))
    paint(mesh, _colours(surface))
    chain = Tube([BONES[0].head, *(bone.tail for bone in BONES)], radius=HEIGHT, spacing=0.1, blend=0.085)
    character = make_character("snake", mesh, BONES, chain_weights(chain, -surface.points[:, 1] - TAIL))
    key_cycle(character.armature, FRAME_COUNT, 16, pose_at, BONES[0].name, lambda _: 0.0)
    set_stage(character, view=(58.0, 30.0), ground=True, is_painted=True)
    return character


def body_surface() -> Surface:
    """The body without its eyes: one closed shell along Y that lies on the ground."""
    places = np.linspace(TAIL, RADII[-1][0], RING_COUNT)
    radii = np.interp(places, *np.transpose(RADII))
    rings = [Station(*ring) for ring in zip(places, _height(radii), radii, radii, radii, strict=True)]
    cage = Cage()
    loft = Loft(cage, [*rings, *HEAD], lambda _: "body")
    loft.close_rear("body")
    loft.close_front("body", bulge=(0, -0.01, 0))
    return cage.surface(levels=1)


def _height(radius: np.ndarray) -> np.ndarray:
    """Of the middle of a ring: the belly lies flat, so what is thinner lies lower."""
    return 0.15 * HEIGHT + 0.85 * radius


def _colours(surface: Surface) -> np.ndarray:
    """Colours (N, 3): dark bands across a green back, pale belly, black eyes."""
    x, y, z = surface.points.T
    bands = np.clip(0.5 + 1.6 * np.sin(2 * np.pi * (y + 0.35 * np.abs(x)) / 0.24), 0.0, 1.0) * (-y < NECK)
    back = np.array(GREEN) + bands[:, None] * (np.array(BAND) - GREEN)
    radius = np.interp(-y, *np.transpose(RADII))
    share = np.clip((z - _height(radius)) / (0.5 * radius) + 1.2, 0.0, 1.0)[:, None]
    colours = np.array(BELLY) + share * (back - BELLY)
    colours[surface.vertices_of("eye")] = DARK
    return colours


def heading(place: float, cycle: float) -> float:
    """Angle of the body against its way, degrees, at a place 0 (tail) to 1 (head): a serpenoid curve."""
    return SWING * (1.0 - 0.55 * place**2) * sin(2 * pi * (WAVES * place + cycle))


def pose_at(cycle: float) -> Pose:
    """All angles at a moment of the cycle, 0 to 1."""
    headings = [heading(index / (len(BONES) - 1), cycle) for index in range(len(BONES))]
    turns = np.diff(headings, prepend=0.0)
    return {bone.name: (float(turn), 0.0, 0.0) for bone, turn in zip(BONES, turns, strict=True)}
