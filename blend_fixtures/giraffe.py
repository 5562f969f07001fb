"""A toy giraffe: sloping back, long neck, ossicones; a walk during which the neck bends down and rises again."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from .cage import Cage, Loft, Station, Surface, ellipse
from .character import Bone, Character, both_sides, make_character, make_mesh, side_name
from .gait import Leg, walk_pose
from .materials import Colour, make_material, paint
from .patches import patch_strength
from .posing import Pose, key_cycle
from .shells import CORNERS, ball
from .skin_weights import heat_weights
from .stage import set_stage

FRAME_COUNT = 96
STEPS = 2
"""Walk cycles in one cycle of the neck."""

OCHRE: Colour = (0.80, 0.55, 0.25)
PATCH: Colour = (0.33, 0.13, 0.04)
DARK: Colour = (0.06, 0.03, 0.02)

STATIONS = [
    Station(-0.78, 1.74, 0.18, 0.22, 0.18),
    Station(-0.66, 1.76, 0.29, 0.30, 0.27),
    Station(-0.44, 1.79, 0.33, 0.35, 0.31),
    Station(-0.20, 1.82, 0.34, 0.38, 0.32),
    Station(0.06, 1.86, 0.36, 0.41, 0.33),
    Station(0.30, 1.91, 0.39, 0.43, 0.32, 5),
    Station(0.52, 2.02, 0.40, 0.42, 0.28, 20),
    Station(0.70, 2.24, 0.29, 0.32, 0.21, 45),
    Station(0.84, 2.49, 0.21, 0.23, 0.165, 62),
    Station(0.95, 2.74, 0.17, 0.18, 0.14, 66),
    Station(1.05, 2.98, 0.15, 0.15, 0.125, 67),
    Station(1.14, 3.22, 0.135, 0.135, 0.117, 68),
    Station(1.23, 3.46, 0.125, 0.125, 0.112, 68),
    Station(1.31, 3.69, 0.12, 0.12, 0.11, 64),
    Station(1.39, 3.89, 0.125, 0.12, 0.115, 48),
    Station(1.51, 4.04, 0.15, 0.15, 0.145, 12),
    Station(1.68, 4.06, 0.15, 0.15, 0.155, -15),
    Station(1.86, 4.00, 0.115, 0.13, 0.13, -22),
    Station(2.02, 3.94, 0.092, 0.105, 0.105, -20),
    Station(2.16, 3.90, 0.085, 0.095, 0.10, -15),
    Station(2.25, 3.88, 0.055, 0.065, 0.068, -12),
]
LEG_COLUMNS = range(3, 4)
HIND_SEGMENTS = range(1, 3)
FRONT_SEGMENTS = range(4, 6)
HORN_SEGMENTS, HORN_COLUMNS = range(15, 16), range(1)
EAR_SEGMENTS, EAR_COLUMNS = range(14, 15), range(1, 2)
NECK_SEGMENT = 6
HEAD_SEGMENT = 14


def build() -> Character:
    """The walking animal, ready to render."""
    surface = body_surface()
    for side in (1, -1):
        eye = ball((0.128, -1.73, 4.10), 0.042, "eye")
        surface = surface.joined(eye if side > 0 else eye.mirrored())
    mesh = make_mesh("giraffe", surface.points, surface.quads)
    mesh.materials.append(make_material("giraffe_coat", OCHRE, 0.6, use_paint=True))
    paint(mesh, _colours(surface))
    character = make_character(
        "giraffe", mesh, BONES, heat_weights(surface, BONES, PART_BONES, narrowest=0.12, widest=0.22, midline=0.25)
    )
    key_cycle(character.armature, FRAME_COUNT, 32, pose_at, "hips", body_rise_at)
    set_stage(character, view=(58.0, 7.0), ground=True, is_painted=True, resolution=(720, 720))
    return character


def body_surface() -> Surface:
    """The body without its eyes: one closed shell."""
    cage = Cage()
    loft = Loft(cage, STATIONS, _part_of)
    rump = loft.close_rear("torso", bulge=0.03)
    loft.close_front("head", bulge=(0, -0.015, 0))
    _add_tail(cage, rump)
    for side in (1, -1):
        _add_leg(cage, loft, HIND_SEGMENTS, "leg_back", -0.46, side)
        _add_leg(cage, loft, FRONT_SEGMENTS, "leg_front", 0.30, side)
        _add_horn(cage, loft, side)
        _add_ear(cage, loft, side)
    return cage.surface(levels=1)


def _part_of(segment: int) -> str:
    if segment >= HEAD_SEGMENT:
        return "head"
    if segment >= NECK_SEGMENT:
        return "neck"
    return "torso"


def _add_leg(cage: Cage, loft: Loft, segments: range, name: str, forward: float, side: int) -> None:
    loop, squares = loft.open_patch(segments, LEG_COLUMNS, side)
    rings = [
        ellipse(squares, (0.19, -forward, z), (0, -length, 0), (-width, 0, 0))
        for z, length, width in (
            (1.24, 0.16, 0.125),
            (0.92, 0.105, 0.09),
            (0.72, 0.095, 0.088),
            (0.38, 0.07, 0.066),
            (0.13, 0.075, 0.072),
            (0.02, 0.10, 0.095),
        )
    ]
    part = side_name(name, side)
    cage.fill_side(cage.draw_out(loop, rings, part, side), 2, 1, part, side)


def _add_horn(cage: Cage, loft: Loft, side: int) -> None:
    loop, squares = loft.open_patch(HORN_SEGMENTS, HORN_COLUMNS, side)
    rings = [
        ellipse(squares, (x, y, z), (0, -radius, 0), (radius, 0, 0))
        for x, y, z, radius in ((0.075, -1.58, 4.29, 0.035), (0.085, -1.55, 4.40, 0.05))
    ]
    tip = cage.draw_out(loop, rings, "horn", side)
    cage.add_face(tip if side > 0 else tip[::-1], "horn")


def _add_ear(cage: Cage, loft: Loft, side: int) -> None:
    loop, squares = loft.open_patch(EAR_SEGMENTS, EAR_COLUMNS, side)
    rings = [
        ellipse(squares, (x, y, z), (0, -width, 0), (0, 0, -thickness))
        for x, y, z, width, thickness in ((0.25, -1.42, 4.14, 0.075, 0.05), (0.36, -1.36, 4.16, 0.05, 0.03))
    ]
    tip = cage.draw_out(loop, rings, "head", side)
    cage.add_face(tip if side > 0 else tip[::-1], "head")


def _add_tail(cage: Cage, rump: list[list[int]]) -> None:
    loop = [rump[0][1], rump[0][2], rump[1][2], rump[1][1]]
    cage.remove_face(set(loop))
    rings = [
        ellipse(CORNERS, (0, y, z), (radius, 0, 0), (0, -radius * up, -radius * out))
        for y, z, radius, up, out in (
            (0.87, 1.76, 0.045, 0.7, 0.7),
            (0.93, 1.50, 0.032, 1.0, 0.2),
            (0.95, 1.22, 0.032, 1.0, 0.1),
            (0.96, 1.02, 0.05, 1.0, 0.1),
        )
    ]
    cage.add_face(cage.draw_out(loop, rings, "tail"), "tail")


def _colours(surface: Surface) -> np.ndarray:
    """Colours (N, 3): patches on the coat, fading out down the legs and on the belly; dark hooves, tufts and eyes."""
    height = surface.points[:, 2]
    coat = surface.vertices_of("torso", "neck") | surface.vertices_of(*(part for part in PART_BONES if "leg" in part))
    share = patch_strength(surface.points, coat) * np.clip((height - 0.75) / 0.45, 0.0, 1.0)
    colours = np.array(OCHRE) + share[:, None] * (np.array(PATCH) - OCHRE)
    colours[surface.vertices_of("head", "horn")] = OCHRE
    hooves = ~surface.vertices_of("torso", "neck", "head") & (height < 0.1)
    tufts = surface.vertices_of("tail") & (height < 1.2)
    knobs = surface.vertices_of("horn") & (height > 4.34)
    colours[hooves | tufts | knobs | surface.vertices_of("eye")] = DARK
    return colours


BONES: list[Bone] = [
    Bone("hips", (0, 0.66, 1.90), (0, 0.05, 1.98)),
    Bone("chest", (0, 0.05, 1.98), (0, -0.56, 2.12), "hips"),
    Bone("neck.001", (0, -0.56, 2.12), (0, -0.97, 2.82), "chest"),
    Bone("neck.002", (0, -0.97, 2.82), (0, -1.20, 3.40), "neck.001"),
    Bone("neck.003", (0, -1.20, 3.40), (0, -1.42, 3.94), "neck.002"),
    Bone("head", (0, -1.42, 3.94), (0, -2.24, 3.88), "neck.003"),
    Bone("tail", (0, 0.80, 1.84), (0, 0.96, 1.02), "hips"),
    *both_sides("leg_front_upper", (0.19, -0.30, 1.62), (0.19, -0.32, 0.78), "chest"),
    *both_sides("leg_front_lower", (0.19, -0.32, 0.78), (0.19, -0.30, 0.02), "leg_front_upper"),
    *both_sides("leg_back_upper", (0.19, 0.46, 1.62), (0.19, 0.44, 0.78), "hips"),
    *both_sides("leg_back_lower", (0.19, 0.44, 0.78), (0.19, 0.46, 0.02), "leg_back_upper"),
]
BONE = {bone.name: bone for bone in BONES}
PART_BONES: dict[str, list[str]] = {
    "torso": ["hips", "chest"],
    "neck": ["chest", "neck.001", "neck.002", "neck.003"],
    "head": ["head", "neck.003"],
    "horn": ["head"],
    "eye": ["head"],
    "tail": ["hips", "tail"],
} | {
    f"leg_{pair}{end}": [f"leg_{pair}_upper{end}", f"leg_{pair}_lower{end}"]
    for pair in ("front", "back")
    for end in (".L", ".R")
}

LEGS = [
    Leg(BONE[f"leg_{pair}_upper{end}"], BONE[f"leg_{pair}_lower{end}"], phase, 0.70, lift)
    for pair, end, phase, lift in (
        ("back", ".L", 0.00, 0.34),
        ("front", ".L", 0.18, 0.44),
        ("back", ".R", 0.50, 0.34),
        ("front", ".R", 0.68, 0.44),
    )
]


def body_rise_at(cycle: float) -> float:
    """Metres above rest, lowest when two feet have just touched down."""
    return -0.07 + 0.02 * cos(4 * pi * STEPS * cycle)


def pose_at(cycle: float) -> Pose:
    """All angles at a moment of the cycle, 0 to 1."""
    wave = 2 * pi * cycle
    step = STEPS * wave
    bow = 0.5 - 0.5 * cos(wave)
    nod = 3.0 * sin(2 * step)
    pose = {
        "chest": (1.0 * sin(2 * step), 0.0, 1.5 * sin(step)),
        "neck.001": (-4.0 + 46.0 * bow + nod, 0.0, 3.0 * sin(step)),
        "neck.002": (50.0 * bow, 0.0, 8.0 * sin(wave)),
        "neck.003": (-4.0 + 46.0 * bow, 0.0, 10.0 * sin(wave)),
        "head": (4.0 - 26.0 * bow - nod, 0.0, 0.0),
        "tail": (8.0, 0.0, 18.0 * sin(step + 0.6)),
    }
    return {**pose, **walk_pose(LEGS, STEPS * cycle % 1.0, body_rise_at(cycle))}
