"""A straight tube twisted to 180 degrees: over three joints, at one joint, and through straight poses."""

from __future__ import annotations

from .character import Character
from .materials import make_material
from .posing import Pose, key_poses
from .stage import set_stage
from .tube import Tube, build_tube

CHAIN = Tube(joints=[(0, 0, 0.6 * joint) for joint in range(5)], radius=0.2, spacing=0.04, blend=0.25)
BONES = ["twist.001", "twist.002", "twist.003", "twist.004"]


def build() -> Character:
    """The animated tube, ready to render."""
    character = build_tube("twist_chain", CHAIN, BONES, make_material("plum", (0.45, 0.22, 0.42)))
    key_poses(
        character.armature,
        {
            1: _spread(0, 0),
            24: _spread(0, 60),
            36: _spread(30, 60),
            48: _spread(0, 60),
            60: _spread(-30, 60),
            72: _spread(0, 60),
            96: _spread(0, -60),
            108: _spread(0, 0),
            132: {"twist.002": (0, 0, 0), "twist.003": (0, 180, 0), "twist.004": (0, 0, 0)},
            156: _spread(0, 0),
        },
    )
    set_stage(character, view=(60.0, 12.0))
    return character


def _spread(bend: float, twist: float) -> Pose:
    """The same angles, in degrees, at all three inner joints."""
    return dict.fromkeys(BONES[1:], (bend, twist, 0.0))
