"""A closed tube about four bones whose rest pose lies in no plane."""

from __future__ import annotations

from .character import Character
from .materials import make_material
from .posing import Pose, key_poses
from .stage import set_stage
from .tube import Tube, build_tube

CHAIN = Tube(
    joints=[(0, 0, 0), (0.15, 0.1, 0.8), (0.75, -0.2, 1.2), (0.95, 0.45, 1.65), (0.5, 0.75, 2.2)],
    radius=0.17,
    spacing=0.035,
    blend=0.18,
)
BONES = ["chain.001", "chain.002", "chain.003", "chain.004"]


STRAIGHT: Pose = dict.fromkeys(BONES, (0.0, 0.0, 0.0))


def build() -> Character:
    """The animated tube, ready to render."""
    character = build_tube("four_bone_chain", CHAIN, BONES, make_material("slate_blue", (0.24, 0.36, 0.60)))
    key_poses(
        character.armature,
        {
            1: STRAIGHT,
            20: {
                "chain.001": (0, 0, 10),
                "chain.002": (50, 0, 20),
                "chain.003": (-45, 30, 0),
                "chain.004": (60, 0, 30),
            },
            40: {
                "chain.001": (-10, 0, 0),
                "chain.002": (-30, 20, -40),
                "chain.003": (40, -40, 35),
                "chain.004": (-70, 0, 20),
            },
            60: STRAIGHT,
        },
    )
    set_stage(character, view=(25.0, 14.0))
    return character
