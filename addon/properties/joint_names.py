"""Names of joints: a joint at the head of a bone has the bone's; that of a bendy bone's segments one made from it.

They tell joints apart in saved settings and figures. No bone has a name of the second kind: only this module writes the
thin space in it.
"""

from __future__ import annotations

from collections.abc import Callable

from ..messages import message

BEND = "\u2009(bend)"


def bend_of(bone: str) -> str:
    """Name of the joint that the segments of a bendy bone make together."""
    return bone + BEND


def bone_of(joint: str) -> str:
    """The bone of a joint."""
    return joint.removesuffix(BEND)


def flipped(joint: str, flip: Callable[[str], str]) -> str:
    """Name of the joint on the other side. flip: names of bones."""
    return bend_of(flip(bone_of(joint))) if joint.endswith(BEND) else flip(joint)


def label(joint: str) -> str:
    """What the artist reads: a message."""
    return message("bend of {bone}", bone=bone_of(joint)) if joint.endswith(BEND) else joint
