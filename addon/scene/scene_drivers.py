"""Drivers that name the scene itself: evaluated in a copy of it, they would read the scene as it stands now.

A variable that reads a context property of the active scene is right in any copy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy

from ..messages import message
from . import modifier_inputs, node_group, stack, stack_proof, twin

FRAME_PATHS = frozenset({"frame_current", "frame_current_final", "frame_float", "frame_subframe"})
# Of an object, by the beginning of their paths: how it is drawn, which moves nothing.
_LOOKS = ("hide_", "color", "show_", "display", "pass_index", "visible_", "is_shadow", "is_holdout", "material_slots")


class SceneDriverError(ValueError):
    """A driver names the scene; says which, and what to do."""


def check(scene: bpy.types.Scene, roots: Iterable[bpy.types.ID]) -> None:
    """Raises SceneDriverError where what moves any of `roots` reads of `scene` what changes from frame to frame."""
    ahead = [(root, twin.is_twin(root) if isinstance(root, bpy.types.Object) else False) for root in roots]
    known: set[tuple[bpy.types.ID, bool]] = set()
    while ahead:
        owner, has_geometry = ahead.pop()
        if (owner, has_geometry) in known:
            continue
        known.add((owner, has_geometry))
        ahead += [(leader, has_geometry) for leader in _leaders(owner, has_geometry)]
        for target in _read_by_drivers(owner, has_geometry):
            if target.id != scene:
                ahead.append((target.id, has_geometry))
            elif _moves(scene, target.data_path):
                text = message(
                    "A driver of {owner} reads {path} of the scene by its name, which cannot be baked or measured:"
                    " make its variable a Context Property of the Active Scene",
                    owner=owner.name,
                    path=target.data_path,
                )
                raise SceneDriverError(text)


def _read_by_drivers(owner: bpy.types.ID, has_geometry: bool) -> Iterator[bpy.types.DriverTarget]:
    """By those that may move something."""
    animation = getattr(owner, "animation_data", None)
    for curve in () if animation is None else animation.drivers:
        if isinstance(owner, bpy.types.Object) and not _matters(owner, curve.data_path, has_geometry):
            continue
        for variable in curve.driver.variables:
            if variable.type != "CONTEXT_PROP":
                yield from (target for target in variable.targets if target.id is not None)


def _matters(owner: bpy.types.Object, path: str, has_geometry: bool) -> bool:
    if path.startswith("modifiers["):
        return any(
            path.startswith(f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"]')
            for modifier in owner.modifiers
            if has_geometry or modifier.type == "HOOK" or _is_own(modifier)
        )
    return not path.startswith(_LOOKS)


def _is_own(modifier: bpy.types.Modifier) -> bool:
    return modifier.type == "NODES" and any(
        node_group.is_of_kind(modifier.node_group, kind) for kind in node_group.KINDS.values()
    )


def _leaders(owner: bpy.types.ID, has_geometry: bool) -> Iterator[bpy.types.ID]:
    """What an object follows, but by drivers. has_geometry: its mesh counts too, and all that moves it."""
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
        if has_geometry:
            yield from (value for _, value in stack_proof.pointers(modifier))
            if modifier.type == "NODES" and modifier.node_group is not None:
                yield from modifier_inputs.read_pointers(modifier)
        elif modifier.type == "HOOK" and modifier.object is not None:
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
