"""An elephant: barrel body, pillar legs with knees, ears, trunk, tail; 17 bones, a walk with one high step."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from .cage import Cage, Loft, Station, Surface, ellipse
from .character import Bone, Character, both_sides, make_character, make_mesh, side_name
from .gait import Leg, walk_pose
from .materials import make_material
from .posing import Pose, key_cycle
from .shells import ball, horn
from .skin_weights import heat_weights
from .stage import set_stage

FRAME_COUNT = 48

STATIONS = [
    Station(-1.22, 1.66, 0.36, 0.42, 0.40),
    Station(-1.02, 1.68, 0.56, 0.58, 0.58),
    Station(-0.70, 1.68, 0.65, 0.66, 0.67),
    Station(-0.34, 1.67, 0.67, 0.73, 0.71),
    Station(0.06, 1.66, 0.67, 0.76, 0.72),
    Station(0.42, 1.68, 0.65, 0.70, 0.67),
    Station(0.72, 1.74, 0.61, 0.64, 0.58),
    Station(0.98, 1.85, 0.55, 0.55, 0.46, 5),
    Station(1.18, 1.97, 0.49, 0.47, 0.38, 5),
    Station(1.38, 2.07, 0.52, 0.46, 0.385, -5),
    Station(1.63, 2.07, 0.48, 0.46, 0.385, -25),
    Station(1.83, 1.93, 0.40, 0.33, 0.30, -50),
    Station(1.97, 1.67, 0.235, 0.20, 0.205, -70),
    Station(2.04, 1.34, 0.165, 0.155, 0.155, -80),
    Station(2.08, 1.02, 0.13, 0.125, 0.125, -85),
    Station(2.11, 0.70, 0.105, 0.105, 0.10, -82),
    Station(2.18, 0.42, 0.085, 0.085, 0.085, -65),
    Station(2.29, 0.26, 0.07, 0.07, 0.072, -42),
]
LEG_COLUMNS = range(2, 4)
HIND_SEGMENTS = range(1, 3)
FRONT_SEGMENTS = range(5, 7)
EAR_SEGMENTS = range(8, 9)
EAR_COLUMNS = range(3)
JAW_SEGMENTS = range(10, 11)
JAW_COLUMNS = range(4, 5)
NECK_SEGMENT = 7
TRUNK_SEGMENT = 11


def build(levels: int = 2) -> Character:
    """The walking animal, ready to render. levels: of its body's subdivision."""
    surface = body_surface(levels)
    for side in (1, -1):
        tusk = horn([(0.20, -1.80, 1.66), (0.25, -2.02, 1.46), (0.27, -2.30, 1.42)], [0.055, 0.05, 0.02], "tusk")
        eye = ball((0.352, -1.66, 2.03), 0.05, "eye", levels=2)
        for shell in (tusk, eye):
            surface = surface.joined(shell if side > 0 else shell.mirrored())
    mesh = make_mesh("elephant", surface.points, surface.quads)
    for name, colour, roughness in (
        ("elephant_skin", (0.36, 0.325, 0.295), 0.75),
        ("ivory", (0.83, 0.77, 0.64), 0.35),
        ("eye", (0.03, 0.02, 0.02), 0.15),
    ):
        mesh.materials.append(make_material(name, colour, roughness))
    slots = {"tusk": 1, "eye": 2}
    mesh.polygons.foreach_set("material_index", np.array([slots.get(part, 0) for part in surface.parts], np.int32))
    character = make_character(
        "elephant", mesh, BONES, heat_weights(surface, BONES, PART_BONES, narrowest=0.13, widest=0.36, midline=0.3)
    )
    key_cycle(character.armature, FRAME_COUNT, 16, pose_at, "hips", body_rise_at)
    set_stage(character, view=(48.0, 9.0), ground=True)
    return character


def body_surface(levels: int = 2) -> Surface:
    """The body without its eyes: one closed shell."""
    cage = Cage()
    loft = Loft(cage, STATIONS, _part_of)
    rump = loft.close_rear("torso", bulge=0.05)
    loft.close_front("trunk", bulge=(0, -0.02, -0.02))
    _add_tail(cage, rump)
    _add_jaw(cage, loft)
    for side in (1, -1):
        _add_leg(cage, loft, HIND_SEGMENTS, "leg_back", -0.72, side)
        _add_leg(cage, loft, FRONT_SEGMENTS, "leg_front", 0.68, side)
        _add_ear(cage, loft, side)
    return cage.surface(levels)


def _part_of(segment: int) -> str:
    if segment >= TRUNK_SEGMENT:
        return "trunk"
    if segment >= NECK_SEGMENT:
        return "head"
    return "torso"


def _add_leg(cage: Cage, loft: Loft, segments: range, name: str, forward: float, side: int) -> None:
    loop, squares = loft.open_patch(segments, LEG_COLUMNS, side)
    rings = [
        ellipse(squares, (x, -forward - lean, z), (0, -length, 0), (-width, 0, 0))
        for z, x, lean, length, width in (
            (0.98, 0.41, 0.00, 0.28, 0.23),
            (0.73, 0.40, 0.01, 0.22, 0.195),
            (0.48, 0.40, 0.00, 0.185, 0.175),
            (0.22, 0.40, 0.00, 0.185, 0.18),
            (0.03, 0.40, 0.01, 0.215, 0.205),
        )
    ]
    part = side_name(name, side)
    cage.fill_side(cage.draw_out(loop, rings, part, side), 2, 2, part, side)


def _add_ear(cage: Cage, loft: Loft, side: int) -> None:
    loop, squares = loft.open_patch(EAR_SEGMENTS, EAR_COLUMNS, side)
    part = side_name("ear", side)
    outward, backward = np.array([0.66, 0.75, 0.0]), np.array([0.75, -0.66, 0.0])
    rings = []
    for root, reach, top, bottom, thickness in (
        ((0.42, -1.30), 0.06, 2.42, 1.92, 0.05),
        ((0.42, -1.30), 0.40, 2.62, 1.56, 0.035),
        ((0.42, -1.30), 0.74, 2.46, 1.36, 0.025),
    ):
        ring = []
        for front, down in squares:
            point = np.array([*root, top + (bottom - top) * (down + 1) / 2]) + outward * reach
            ring.append(point + backward * front * thickness)
        rings.append(np.array(ring))
    cage.fill_side(cage.draw_out(loop, rings, part, side), 1, 3, part, side)


def _add_jaw(cage: Cage, loft: Loft) -> None:
    loop, squares = loft.open_patch(JAW_SEGMENTS, JAW_COLUMNS)
    rings = [
        ellipse(squares, (0, -forward, height), (0, -length, 0.45 * length), (-width, 0, 0))
        for forward, height, length, width in ((1.60, 1.565, 0.085, 0.15), (1.715, 1.475, 0.045, 0.09))
    ]
    cage.add_face(cage.draw_out(loop, rings, "head"), "head")


def _add_tail(cage: Cage, rump: list[list[int]]) -> None:
    loop = [rump[0][1], rump[0][2], rump[1][2], rump[1][1]]
    cage.remove_face(set(loop))
    squares = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    rings = [
        ellipse(squares, (0, y, z), (radius, 0, 0), (0, -radius * up, -radius * out))
        for y, z, radius, up, out in (
            (1.36, 1.76, 0.085, 0.75, 0.65),
            (1.46, 1.42, 0.055, 0.97, 0.2),
            (1.50, 1.06, 0.04, 1.0, 0.1),
            (1.52, 0.84, 0.062, 1.0, 0.1),
        )
    ]
    cage.add_face(cage.draw_out(loop, rings, "tail"), "tail")


BONES: list[Bone] = [
    Bone("hips", (0, 0.95, 1.85), (0, 0.0, 1.85)),
    Bone("chest", (0, 0.0, 1.85), (0, -0.98, 1.92), "hips"),
    Bone("head", (0, -0.98, 1.92), (0, -1.86, 1.86), "chest"),
    Bone("trunk.001", (0, -1.86, 1.86), (0, -2.02, 1.38), "head"),
    Bone("trunk.002", (0, -2.02, 1.38), (0, -2.09, 0.86), "trunk.001"),
    Bone("trunk.003", (0, -2.09, 0.86), (0, -2.28, 0.26), "trunk.002"),
    Bone("tail", (0, 1.24, 1.86), (0, 1.52, 0.86), "hips"),
    *both_sides("ear", (0.40, -1.30, 2.15), (0.86, -0.78, 1.95), "head", (0, 0, 1)),
    *both_sides("leg_front_upper", (0.40, -0.66, 1.42), (0.40, -0.70, 0.70), "chest"),
    *both_sides("leg_front_lower", (0.40, -0.70, 0.70), (0.40, -0.68, 0.02), "leg_front_upper"),
    *both_sides("leg_back_upper", (0.40, 0.74, 1.42), (0.40, 0.70, 0.70), "hips"),
    *both_sides("leg_back_lower", (0.40, 0.70, 0.70), (0.40, 0.72, 0.02), "leg_back_upper"),
]
BONE = {bone.name: bone for bone in BONES}
PART_BONES: dict[str, list[str]] = {
    "torso": ["hips", "chest"],
    "head": ["chest", "head"],
    "trunk": ["head", "trunk.001", "trunk.002", "trunk.003"],
    "tail": ["hips", "tail"],
    "tusk": ["head"],
    "eye": ["head"],
} | {
    part + end: bones
    for end in (".L", ".R")
    for part, bones in {
        "ear": ["head", f"ear{end}"],
        "leg_front": [f"leg_front_upper{end}", f"leg_front_lower{end}"],
        "leg_back": [f"leg_back_upper{end}", f"leg_back_lower{end}"],
    }.items()
}

LEGS = [
    Leg(BONE[f"leg_{pair}_upper{end}"], BONE[f"leg_{pair}_lower{end}"], phase, 0.72, lift)
    for pair, end, phase, lift in (
        ("back", ".L", 0.00, 0.36),
        ("front", ".L", 0.25, 0.54),
        ("back", ".R", 0.50, 0.36),
        ("front", ".R", 0.75, 0.42),
    )
]


def body_rise_at(cycle: float) -> float:
    """Metres above rest, lowest when two feet have just touched down."""
    return -0.10 + 0.025 * cos(4 * pi * cycle)


def pose_at(cycle: float) -> Pose:
    """All angles at a moment of the cycle, 0 to 1."""
    wave = 2 * pi * cycle
    # The left front foot is highest at cycle 0.08: there the trunk curls most.
    curl = (0.5 + 0.5 * cos(wave - 2 * pi * 0.08)) ** 1.2
    swing = sin(wave)
    pose = {
        "chest": (2.0 * sin(2 * wave), 0.0, 3.5 * swing),
        "head": (9.0 * cos(2 * wave) + 6.0 - 22.0 * curl, 0.0, -3.5 * swing),
        "trunk.001": (16.0 - 76.0 * curl, 0.0, 6.0 * swing),
        "trunk.002": (8.0 - 70.0 * curl, 0.0, 10.0 * swing),
        "trunk.003": (-6.0 - 66.0 * curl, 0.0, 12.0 * swing),
        "tail": (8.0, 0.0, 16.0 * sin(wave + 0.6)),
        "ear.L": (-12.0 - 16.0 * sin(2 * wave), 0.0, 0.0),
        "ear.R": (12.0 + 16.0 * sin(2 * wave), 0.0, 0.0),
    }
    return {**pose, **walk_pose(LEGS, cycle, body_rise_at(cycle))}
