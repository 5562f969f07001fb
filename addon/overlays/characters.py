"""Which characters a viewport shows, and what each wants drawn."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .. import runtime
from ..properties.saved import volume_settings
from ..states import VolumeState

# Modes in which the viewport shows the mesh as its modifiers leave it, and no colors of its own.
MODES = frozenset({"OBJECT", "POSE"})


def shown(context: bpy.types.Context) -> Iterator[tuple[bpy.types.Object, VolumeState]]:
    """Characters that this viewport shows, with their states: not hidden, and in its local view when it has one."""
    space = context.space_data
    if not space.overlay.show_overlays:
        return
    objects = context.view_layer.objects
    for uid, character in list(runtime.session.characters.items()):
        ob = runtime.object_of(uid, character, objects)
        if ob is not None and volume_settings(ob).version > 0 and ob.visible_in_viewport_get(space):
            yield ob, character


def active_joint(ob: bpy.types.Object) -> str:
    """The name of its bone; empty without one."""
    saved = volume_settings(ob)
    joints, active = saved.joints, saved.active_joint
    return joints[active].name if 0 <= active < len(joints) else ""


def is_after(ob: bpy.types.Object) -> bool:
    """Whether the viewport shows our modifier's effect: the artist's Before / After."""
    modifier = runtime.session.find_modifier(ob)
    return modifier is None or modifier.show_viewport
