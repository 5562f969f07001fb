"""Bodies that fold deeply: an elbow and a belly, one bent joint each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np

from blend_fixtures.character import Bone, Character, make_character, make_mesh
from blend_fixtures.posing import key_poses
from blend_fixtures.tube import Tube, chain_weights, tube_mesh

# Frames from straight to the deepest bend.
FRAMES = 31
ARM = Tube(joints=[(0, 0, 0), (0, 0, 0.55), (0, 0, 1.05)], radius=0.11, spacing=0.018, blend=0.11)
TRUNK = Tube(joints=[(0, 0, 0), (0, 0, 0.5), (0, 0, 1.0)], radius=0.24, spacing=0.028, blend=0.22)


@dataclass(frozen=True)
class Body:
    """name, bend of the joint in degrees, preset of the joint, what becomes of the tube's points (N, 3)."""

    name: str
    tube: Tube
    degrees: float
    preset: str
    shape: Callable[[np.ndarray], np.ndarray]

    def build(self) -> Character:
        """In an empty scene."""
        bpy.ops.wm.read_homefile(use_empty=True)
        points, faces, arc_lengths = tube_mesh(self.tube)
        joints = self.tube.joints
        bones = [Bone("upper", joints[0], joints[1]), Bone("lower", joints[1], joints[2], "upper")]
        mesh = make_mesh(self.name, self.shape(points), faces)
        character = make_character(self.name, mesh, bones, chain_weights(self.tube, arc_lengths))
        # Not quite about one axis, as animators bend: mirrored halves would hide what is not mirrored.
        key_poses(
            character.armature, {1: {"lower": (0, 0, 0)}, FRAMES: {"lower": (self.degrees, 6.0, 0.04 * self.degrees)}}
        )
        return character


def arm(points: np.ndarray) -> np.ndarray:
    """Thicker where the muscles are, thinner towards the wrist."""
    z = points[:, 2:]
    swell = 1.0 + 0.22 * np.exp(-(((z - 0.28) / 0.16) ** 2)) + 0.16 * np.exp(-(((z - 0.68) / 0.13) ** 2))
    taper = 1.0 - 0.3 * np.clip((z - 0.7) / 0.35, 0.0, 1.0)
    return points * np.hstack([swell * taper, swell * taper, np.ones_like(z)])


def trunk(points: np.ndarray) -> np.ndarray:
    """Wider than deep, with a belly in front (+Y, into which the bend goes)."""
    x, y, z = points.T
    belly = np.exp(-(((z - 0.46) / 0.22) ** 2)) * np.clip(y / TRUNK.radius, 0.0, 1.0) ** 2
    waist = 1.0 - 0.1 * np.exp(-(((z - 0.55) / 0.2) ** 2))
    return np.stack([1.25 * x * waist * (1.0 + 0.15 * belly), 0.85 * y * (1.0 + 0.75 * belly), z], axis=1)


BODIES = (
    Body("elbow", ARM, 150.0, "MUSCLE", arm),
    Body("belly", TRUNK, 95.0, "BELLY", trunk),
)
