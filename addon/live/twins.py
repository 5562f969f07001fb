"""Keeping the twins of characters as their characters are. Main thread only, but for `check`."""

from __future__ import annotations

from contextlib import suppress
from itertools import count

import bpy

from .. import runtime
from ..scene import carrier, drivers, skeleton, stack, stack_proof, twin
from ..states import EvaluatedStack, VolumeBinding, VolumeState
from .binding_rules import is_editable

_marks = count(1)


def keep(target: bpy.types.Object, evaluated: EvaluatedStack | None) -> None:
    """Make, change or remove the twins of a character that may be written."""
    holder = carrier.carrier_of(target)
    if holder is None or not is_editable(holder) or not is_editable(target):
        return
    before = [_is_in_step(target, holder, part) for part in _parts(evaluated)]
    twin.keep(target, holder, "pose", is_needed=evaluated is not None)
    twin.keep(target, holder, "body", is_needed=evaluated is not None and evaluated.has_body)
    if not all(before):
        runtime.session.behind.add(target.session_uid)


def follow(target: bpy.types.Object) -> bool:
    """Take over what was edited; whether the twins were others."""
    character = runtime.session.characters.get(target.session_uid)
    if character is None or character.binding is None or character.binding.evaluated is None:
        return False
    holder = carrier.carrier_of(target)
    if holder is None or not is_editable(holder) or holder.turgor.carrier.target != target:
        return False
    if all(_is_in_step(target, holder, part) for part in _parts(character.binding.evaluated)):
        return False
    armature = stack.armature_modifier(target)
    with runtime.quiet():
        keep(target, character.binding.evaluated)
        renew(target)
        rig = None if armature is None else armature.object
        write_tick(holder, rig, character.binding.bones, character.binding.evaluated)
    holder.turgor.carrier.mesh.update_tag()
    return True


def of(target: bpy.types.Object) -> list[bpy.types.Object]:
    """The twins that the carrier of a character names."""
    holder = carrier.carrier_of(target)
    found = [] if holder is None else [twin.of_carrier(holder, part) for part in twin.PARTS]
    return [each for each in found if each is not None]


def are_there(target: bpy.types.Object, *, has_body: bool) -> bool:
    """Whether the carrier of a character names the twins that it needs."""
    return all(_is_there(target, part) for part in (twin.PARTS if has_body else twin.PARTS[:1]))


def write_tick(
    holder: bpy.types.Object,
    rig: bpy.types.Object | None,
    bones: skeleton.RestBones,
    evaluated: EvaluatedStack | None,
) -> None:
    """Let the carrier's tick wait for all that a frame reads."""
    wanted = [] if rig is None else drivers.bone_sources(rig, bones.names)
    drivers.write_tick(holder, [*wanted, *map(drivers.geometry_source, sources(holder, evaluated))])


def sources(holder: bpy.types.Object, evaluated: EvaluatedStack | None) -> list[bpy.types.Object]:
    """The twins whose geometry a frame reads."""
    found = [twin.of_carrier(holder, part) for part in _parts(evaluated)]
    return [each for each in found if each is not None]


def renew(target: bpy.types.Object) -> None:
    """Whatever was found to be in step is to be looked at again."""
    character = runtime.character(target.session_uid)
    is_evaluated = character.binding is not None and character.binding.evaluated is not None
    names = {modifier.name for modifier in stack.modifiers_to_own(target)}
    animated = stack.animated_settings(target) if is_evaluated else {}
    character.animated = {name: settings for name, settings in animated.items() if name in names}
    character.in_step = next(_marks)


def check(target: bpy.types.Object, character: VolumeState, bound: VolumeBinding) -> None:
    """Raises twin.StepError where a script edited the character and nobody has followed yet. Worker threads.

    target: evaluated. Blender makes a copy anew whenever its object was edited: one that was found to be in step bears
    a number, and is looked at again only when that is gone.
    """
    saved = target.turgor
    if character.animated and not _has_same_values(target, character, bound):
        raise twin.StepError(f"{target.name} was changed by hand just now: evaluate the scene once more")
    if saved.in_step == character.in_step:
        return
    original = target.original
    has_room = saved.is_property_set("in_step")
    is_other = (
        has_room and original.mode in {"OBJECT", "POSE"} and character.signature != stack_proof.signature(original)
    )
    if is_other or not all(_is_there(original, part) for part in _parts(bound.evaluated)):
        raise twin.StepError(f"{original.name} was changed just now: evaluate the scene once more")
    if has_room:
        with suppress(AttributeError):  # nothing can be written while Blender draws
            saved.in_step = character.in_step


def _has_same_values(target: bpy.types.Object, character: VolumeState, bound: VolumeBinding) -> bool:
    holder = carrier.carrier_of(target)
    found = [] if holder is None else sources(holder, bound.evaluated)
    return all(twin.has_same_values(target, each, character.animated) for each in found)


def _is_there(target: bpy.types.Object, part: twin.Part) -> bool:
    holder = carrier.carrier_of(target)
    found = None if holder is None else twin.of_carrier(holder, part)
    return found is not None and twin.is_in_step(target, found, part, with_animated=False)


def _is_in_step(target: bpy.types.Object, holder: bpy.types.Object, part: twin.Part) -> bool:
    found = twin.of_carrier(holder, part)
    return found is not None and twin.is_in_step(target, found, part)


def _parts(evaluated: EvaluatedStack | None) -> tuple[twin.Part, ...]:
    if evaluated is None:
        return ()
    return twin.PARTS if evaluated.has_body else ("pose",)
