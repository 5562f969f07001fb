"""Characters with fewer polygons than their folds need."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import radians

import bpy
import numpy as np

from blend_fixtures import elephant as elephants
from blend_fixtures.character import Bone, Character, make_character, make_mesh
from blend_fixtures.quads import fill_loop, grid_boundary, grid_quads

from ..enclosed_volume import Points


@dataclass(frozen=True)
class Subject:
    """One character. presets: of joints, by the name of their bone; frame: the one that is pictured."""

    name: str
    make: Callable[[], Character]
    presets: dict[str, str]
    frame: int
    direction: Sequence[float]
    threshold: float
    # Bone about whose joint a second picture is taken from near, and how far around, in metres.
    about: str | None = None
    reach: float = 0.0


LAST_FRAME = 21


def torso() -> Character:
    """A round figure that bows: hips, belly, chest, neck, head."""
    stations = [
        # height, half width, half depth
        (0.00, 0.30, 0.26),
        (0.10, 0.44, 0.38),
        (0.30, 0.50, 0.46),
        (0.52, 0.52, 0.52),
        (0.74, 0.51, 0.52),
        (0.94, 0.48, 0.46),
        (1.16, 0.46, 0.38),
        (1.40, 0.48, 0.35),
        (1.60, 0.44, 0.30),
        (1.72, 0.28, 0.23),
        (1.80, 0.17, 0.17),
        (1.92, 0.17, 0.18),
        (2.04, 0.26, 0.27),
        (2.22, 0.30, 0.32),
        (2.40, 0.26, 0.28),
        (2.50, 0.15, 0.16),
    ]
    bones = [Bone("hips", (0, 0, 0.0), (0, 0, 0.86)), Bone("chest", (0, 0, 0.86), (0, 0, 2.5), "hips")]
    return bent("torso", *closed_rings(stations, sides=16), bones, {"chest": (62.0, 0.0, 0.0)}, softness=0.42)


def arm() -> Character:
    """Shoulder, elbow, wrist, fist."""
    stations = [
        (0.00, 0.20, 0.20),
        (0.08, 0.33, 0.33),
        (0.30, 0.41, 0.41),
        (0.60, 0.37, 0.38),
        (0.90, 0.34, 0.36),
        (1.20, 0.32, 0.34),
        (1.45, 0.30, 0.31),
        (1.65, 0.29, 0.29),
        (1.88, 0.30, 0.29),
        (2.15, 0.30, 0.28),
        (2.45, 0.25, 0.23),
        (2.75, 0.19, 0.17),
        (2.92, 0.17, 0.15),
        (3.05, 0.23, 0.20),
        (3.22, 0.28, 0.24),
        (3.40, 0.26, 0.22),
        (3.50, 0.16, 0.14),
    ]
    bones = [Bone("upper", (0, 0, 0.0), (0, 0, 1.6)), Bone("lower", (0, 0, 1.6), (0, 0, 3.5), "upper")]
    return bent("arm", *closed_rings(stations, sides=12), bones, {"lower": (96.0, 0.0, 0.0)}, softness=0.3)


def closed_rings(stations: Sequence[tuple[float, float, float]], sides: int) -> tuple[Points, list[tuple[int, ...]]]:
    """A tube of elliptic rings along z, each of (height, half width, half depth); quads close its ends.

    sides: divisible by four.
    """
    angles = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    points = [(width * np.cos(a), depth * np.sin(a), height) for height, width, depth in stations for a in angles]
    faces: list[tuple[int, ...]] = []
    for ring in range(len(stations) - 1):
        for side in range(sides):
            a, b = ring * sides + side, ring * sides + (side + 1) % sides
            faces.append((a, b, b + sides, a + sides))
    edge, top = sides // 4, (len(stations) - 1) * sides
    around = [(side + sides // 8) % sides for side in range(sides)]
    for loop in (around[::-1], [top + side for side in around]):
        inside = fill_loop(np.array([points[index] for index in loop]), edge, edge)
        grid = [[-1] * (edge + 1) for _ in range(edge + 1)]
        for (row, column), index in zip(grid_boundary(edge, edge), loop, strict=True):
            grid[row][column] = index
        for row, column in np.ndindex(edge - 1, edge - 1):
            grid[row + 1][column + 1] = len(points)
            points.append(tuple(inside[row + 1, column + 1]))
        faces += grid_quads(grid)
    return np.array(points), faces


def bent(
    name: str,
    points: Points,
    faces: list[tuple[int, ...]],
    bones: list[Bone],
    turns: dict[str, tuple[float, float, float]],
    softness: float,
) -> Character:
    """Two bones, the second turned by so many degrees at the last frame. softness: half of where they blend, metres."""
    place = np.clip((points[:, 2] - bones[1].head[2]) / (2.0 * softness) + 0.5, 0.0, 1.0)
    second = place * place * (3.0 - 2.0 * place)
    character = make_character(name, make_mesh(name, points, faces), bones, np.stack([1.0 - second, second], axis=1))
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, LAST_FRAME
    for bone, angles in turns.items():
        pose_bone = character.armature.pose.bones[bone]
        for frame, part in ((1, 0.0), (LAST_FRAME, 1.0)):
            pose_bone.rotation_euler = [radians(part * angle) for angle in angles]
            pose_bone.keyframe_insert("rotation_euler", frame=frame)
    return character


TRUNK = ("trunk.001", "trunk.002", "trunk.003")


def elephant() -> Character:
    """The whole animal, on a quarter of the polygons it has elsewhere."""
    return elephants.build(levels=1)


SUBJECTS = (
    Subject("torso", torso, {"chest": "BELLY"}, LAST_FRAME, (1.0, -0.62, 0.25), 0.1),
    Subject("arm", arm, {"lower": "FOLDS"}, LAST_FRAME, (1.0, -0.35, 0.3), 0.1),
    Subject("elephant", elephant, dict.fromkeys(TRUNK, "FOLDS"), 4, (1.0, -0.75, 0.2), 0.1, "trunk.002", 0.72),
)
