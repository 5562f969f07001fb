"""Names of joints: a joint at the head of a bone has the bone's; that of a bendy bone's segments one made from it.

They tell joints apart in saved settings and figures. No bone has a name of the second kind: only this module writes the
thin space in it.
"""

from __future__ import annotations

from collections.abc import Callable

BEND = "\u2009(bend)"
BEND_LABEL = "bend of {bone}"


def bend_of(bone: str) -> str:
    """Name of the joint that the segments of a bendy bone make together."""
    return bone + BEND


def bone_of(joint: str) -> str:
    """The bone of a joint."""
    return joint.removesuffix(BEND)


def flipped(joint: str, flip: Callable[[str], str]) -> str:
    """Name of the joint on the other side. flip: names of bones."""
    return bend_of(flip(bone_of(joint))) if is_bend(joint) else flip(joint)


def is_bend(joint: str) -> bool:
    """Whether it is the joint of a bendy bone's segments."""
    return joint.endswith(BEND)


def label(joint: str, translate: Callable[[str], str]) -> str:
    """What the artist reads."""
    return translate(BEND_LABEL).format(bone=bone_of(joint)) if is_bend(joint) else joint
