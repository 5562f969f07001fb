"""Drivers that name the scene itself: evaluated in a copy of it, they would read the scene as it stands now.

A variable that reads a context property of the active scene is right in any copy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy

from ..messages import message
from . import node_group, stack

FRAME_PATHS = frozenset({"frame_current", "frame_current_final", "frame_float", "frame_subframe"})
# Of an object, by the beginning of their paths: how it is drawn, which moves nothing.
_LOOKS = ("hide_", "color", "show_", "display", "pass_index", "visible_", "is_shadow", "is_holdout", "material_slots")


class SceneDriverError(ValueError):
    """A driver names the scene; says which, and what to do."""


def check(scene: bpy.types.Scene, roots: Iterable[bpy.types.ID]) -> None:
    """Raises SceneDriverError where what moves any of `roots` reads of `scene` what changes from frame to frame."""
    ahead = list(roots)
    known: set[bpy.types.ID] = set()
    while ahead:
        owner = ahead.pop()
        if owner in known:
            continue
        known.add(owner)
        ahead += _leaders(owner)
        for target in _read_by_drivers(owner):
            if target.id != scene:
                ahead.append(target.id)
            elif _moves(scene, target.data_path):
                text = message(
                    "A driver of {owner} reads {path} of the scene by its name, which cannot be baked or measured:"
                    " make its variable a Context Property of the Active Scene",
                    owner=owner.name,
                    path=target.data_path,
                )
                raise SceneDriverError(text)


def _read_by_drivers(owner: bpy.types.ID) -> Iterator[bpy.types.DriverTarget]:
    """By those that may move something."""
    animation = getattr(owner, "animation_data", None)
    for curve in () if animation is None else animation.drivers:
        if isinstance(owner, bpy.types.Object) and not _matters(owner, curve.data_path):
            continue
        for variable in curve.driver.variables:
            if variable.type != "CONTEXT_PROP":
                yield from (target for target in variable.targets if target.id is not None)


def _matters(owner: bpy.types.Object, path: str) -> bool:
    if path.startswith("modifiers["):
        return any(
            path.startswith(f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"]')
            for modifier in owner.modifiers
            if modifier.type == "HOOK" or _is_own(modifier)
        )
    return not path.startswith(_LOOKS)


def _is_own(modifier: bpy.types.Modifier) -> bool:
    return modifier.type == "NODES" and any(
        node_group.is_of_kind(modifier.node_group, kind) for kind in node_group.KINDS.values()
    )


def _leaders(owner: bpy.types.ID) -> Iterator[bpy.types.ID]:
    """What an object follows, but by drivers."""
    if not isinstance(owner, bpy.types.Object):
        return
    if owner.parent is not None:
        yield owner.parent
    bones = owner.pose.bones if owner.pose is not None else ()
    for holder in (owner, *bones):
        for constraint in holder.constraints:
            found = [getattr(constraint, name, None) for name in ("target", "pole_target")]
            found += [each.target for each in getattr(constraint, "targets", ())]
            yield from (each for each in found if each is not None)
    for modifier in owner.modifiers:
        if modifier.type == "HOOK" and modifier.object is not None:
            yield modifier.object
    if owner.type in {"ARMATURE", "CURVE"}:
        yield owner.data
    keys = getattr(owner.data, "shape_keys", None)
    if keys is not None:
        yield keys


def _moves(scene: bpy.types.Scene, path: str) -> bool:
    """Whether it may be another on another frame."""
    if path in FRAME_PATHS:
        return True
    animation = scene.animation_data
    if animation is None:
        return False
    return len(animation.nla_tracks) > 0 or any(path.startswith(each) for each in stack.animated_paths(animation))
