"""Characters with fewer polygons than their folds need."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import radians

import bpy
import numpy as np

from blend_fixtures import elephant
from blend_fixtures.character import Bone, Character, make_character, make_mesh

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
    # Bone about whose joint the picture is taken, and how far around, in metres; None: all of it.
    about: str | None = None
    reach: float = 0.0


LAST_FRAME = 21


def torso() -> Character:
    """A round body that bends forward at the waist."""
    heights = np.linspace(0.0, 2.0, 9)
    widths = 0.42 + 0.2 * np.sin(np.pi * (heights / 2.0) ** 0.8)
    depths = 0.30 + 0.26 * np.exp(-(((heights - 0.8) / 0.55) ** 2))
    points, faces = closed_rings(heights, widths, depths, sides=14)
    bones = [Bone("hips", (0, 0, 0.0), (0, 0, 0.95)), Bone("chest", (0, 0, 0.95), (0, 0, 2.0), "hips")]
    return bent("torso", points, faces, bones, {"chest": (82.0, 0.0, 0.0)}, softness=0.32)


def arm() -> Character:
    """An arm that bends at the elbow, in a thick sleeve."""
    heights = np.linspace(0.0, 3.2, 15)
    radii = 0.34 - 0.1 * heights / 3.2
    points, faces = closed_rings(heights, radii, radii, sides=12)
    bones = [Bone("upper", (0, 0, 0.0), (0, 0, 1.6)), Bone("lower", (0, 0, 1.6), (0, 0, 3.2), "upper")]
    return bent("arm", points, faces, bones, {"lower": (105.0, 0.0, 0.0)}, softness=0.3)


def closed_rings(heights: Points, widths: Points, depths: Points, sides: int) -> tuple[Points, list[tuple[int, ...]]]:
    """A tube of elliptic rings along z, closed by a face at each end."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    rings = [
        (width * np.cos(angle), depth * np.sin(angle), height)
        for height, width, depth in zip(heights, widths, depths, strict=True)
        for angle in angles
    ]
    faces: list[tuple[int, ...]] = []
    for ring in range(len(heights) - 1):
        for side in range(sides):
            a, b = ring * sides + side, ring * sides + (side + 1) % sides
            faces.append((a, b, b + sides, a + sides))
    top = (len(heights) - 1) * sides
    return np.array(rings), [*faces, tuple(reversed(range(sides))), tuple(range(top, top + sides))]


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

SUBJECTS = (
    Subject("torso", torso, {"chest": "BELLY"}, LAST_FRAME, (0.75, -1.0, 0.35), 0.1),
    Subject("arm", arm, {"lower": "FOLDS"}, LAST_FRAME, (0.9, -1.0, 0.3), 0.1),
    Subject(
        "elephant",
        lambda: elephant.build(levels=1),
        dict.fromkeys(TRUNK, "FOLDS"),
        4,
        (1.0, -0.75, 0.2),
        0.1,
        "trunk.002",
        0.75,
    ),
)
