"""What overlays show of a character, read when a viewport is drawn: always of what that viewport shows.

On the main thread, from evaluated data that lives while the viewport is drawn; nothing of Blender is kept.
"""

from __future__ import annotations

import bpy
import numpy as np

from .. import runtime
from ..logic.overlay_frame import OverlayFrame
from ..scene import modifier_inputs, node_group, stack
from . import frame, joint_names

# Of each character, by uid: what its last frame was made of, and that frame.
_last: dict[int, tuple[tuple[object, ...], OverlayFrame]] = {}


def look(ob: bpy.types.Object) -> OverlayFrame | None:
    """What the viewport shows of a character now; the same object while nothing changed, None without anything."""
    character = runtime.session.characters.get(ob.session_uid)
    if character is None or character.binding is None:
        return None
    bound = character.binding
    target = ob.evaluated_get(bpy.context.view_layer.depsgraph)
    try:
        ours = stack.volume_modifier(target)
        asked = frame.read(target, character, bound, is_off=ours is None or not ours.show_viewport)
        strength = _strength(target, is_evaluated=bound.evaluated is not None)
    except ValueError:  # the frame itself says so, in the panel
        return None
    if strength is None:
        return None
    parts = (asked.pose_matrices, *asked.options.values())
    content = tuple(np.asarray(part).tobytes() for part in parts)
    key = (asked.engine, tuple(asked.options), content, strength)
    last = _last.get(ob.session_uid)
    if last is None or last[0] != key:
        last = (
            key,
            OverlayFrame(
                asked.engine,
                bound.body.rest,
                joint_names.rows_of(bound.bones, bound.body.joint_bones),
                asked.pose_matrices,
                asked.options,
                strength,
            ),
        )
        _last[ob.session_uid] = last
    return last[1]


def forget() -> None:
    """Drop all frames: another file was loaded, or the extension goes."""
    _last.clear()


def observe(depsgraph: bpy.types.Depsgraph) -> None:
    """Keep figures of characters whose modifier is off in this evaluation, so that Before has some too."""
    for uid, character in list(runtime.session.characters.items()):
        ob = runtime.object_of(uid, character, bpy.data.objects)
        ours = None if ob is None else stack.volume_modifier(ob)
        if ours is not None and not ours.show_viewport:
            target = ob.evaluated_get(depsgraph)
            if target.is_evaluated:
                frame.observe(target)


def _strength(target: bpy.types.Object, *, is_evaluated: bool) -> float | None:
    """Part of the correction that the viewport shows; None where not even skinning is shown.

    is_evaluated: more than one Armature may pose it, so that no single switch tells.
    """
    ours, armature = stack.volume_modifier(target), stack.armature_modifier(target)
    if not is_evaluated and (armature is None or not armature.show_viewport):
        return None
    if ours is None or not ours.show_viewport or not modifier_inputs.read_input(ours, node_group.IN_VIEWPORT):
        return 0.0
    return float(modifier_inputs.read_input(ours, node_group.STRENGTH))
