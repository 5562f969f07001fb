"""The active bone leads: clicking a bone in Pose Mode shows its joint. Main thread only."""

from __future__ import annotations

from .. import runtime
from ..scene import bone_choice, stack
from . import housekeeping


def follow() -> None:
    """Make the joint of each armature's active bone the active joint.

    To be called when armatures were updated: choosing a bone updates one, and so does much else.
    """
    for target in housekeeping.characters():
        armature = stack.armature_modifier(target)
        rig = None if armature is None else armature.object
        if rig is None or rig.type != "ARMATURE":
            continue
        name = bone_choice.active_bone_name(rig)
        character = runtime.character(target.session_uid)
        if name == character.active_bone:
            continue
        character.active_bone = name
        place = target.turgor.joints.find(name)
        # Linked characters show it too: which joint is active is no edit of theirs.
        if place >= 0 and place != target.turgor.active_joint:
            target.turgor.active_joint = place
