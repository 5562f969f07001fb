"""A closed tube of three bones, bent about several axes at once."""

from __future__ import annotations

from .character import Character
from .materials import make_material
from .posing import key_poses
from .stage import set_stage
from .tube import Tube, build_tube

FINGER = Tube(joints=[(0, 0, 0), (0, 0, 0.9), (0, 0, 1.7), (0, 0, 2.4)], radius=0.22, spacing=0.04, blend=0.22)


def build() -> Character:
    """The animated tube, ready to render."""
    character = build_tube(
        "three_segment_cylinder", FINGER, ["base", "middle", "tip"], make_material("sage", (0.33, 0.50, 0.33))
    )
    key_poses(
        character.armature,
        {
            1: {"middle": (0, 0, 0), "tip": (0, 0, 0)},
            16: {"middle": (70, 0, 0), "tip": (80, 0, 0)},
            32: {"middle": (20, 40, 75), "tip": (-60, 0, 30)},
            48: {"middle": (-50, -30, -40), "tip": (0, 60, 85)},
            64: {"middle": (0, 0, 0), "tip": (0, 0, 0)},
        },
    )
    set_stage(character, view=(40.0, 12.0))
    return character
