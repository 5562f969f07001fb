"""A closed tube with an elbow that closes from 0 to 90 degrees."""

from __future__ import annotations

from .character import Character
from .materials import make_material
from .posing import key_poses
from .stage import set_stage
from .tube import Tube, build_tube

ELBOW = Tube(joints=[(0, 0, 0), (0, 0, 1), (0, 0, 2)], radius=0.25, spacing=0.04, blend=0.25)


def build() -> Character:
    """The animated tube, ready to render."""
    character = build_tube("bent_cylinder", ELBOW, ["upper", "lower"], make_material("clay", (0.75, 0.36, 0.22)))
    key_poses(character.armature, {1: {"lower": (0, 0, 0)}, 48: {"lower": (90, 0, 0)}})
    set_stage(character, view=(70.0, 12.0))
    return character
