"""Bringing a loaded file to life, and following what the artist edits. Main thread only."""

from __future__ import annotations

import bpy

from .. import runtime
from ..properties.tagging import take_changed
from ..scene import carrier, drivers, node_group, spine_stack, stack, stack_proof, twin
from . import (
    active_bones,
    binding,
    housekeeping,
    masks,
    profiles,
    refining,
    route_choice,
    spine_binding,
    spine_housekeeping,
    strokes,
    twins,
)

# Weights are bound anew after each stroke of the brush where it takes less.
MOST_SECONDS_TO_BIND = 0.1
# After a setting was changed.
SECONDS_TO_REST = 0.3
# Modes in which the mesh is being changed; it is read when the artist leaves them.
EDITING_MODES = frozenset({"EDIT", "SCULPT", "WEIGHT_PAINT", "VERTEX_PAINT", "TEXTURE_PAINT"})


def start() -> None:
    """Bind every character of the file."""
    runtime.session.is_started = True
    if not node_group.exists():
        return
    with runtime.quiet():
        route_choice.choose()
        housekeeping.remove_orphans()
        found, bodies = housekeeping.characters(), spine_housekeeping.bodies()
        housekeeping.give_own_carriers(found)
        spine_housekeeping.give_own_carriers(bodies)
        carrier.give_own_meshes(carrier.carriers())
    for target in bodies:
        spine_binding.bind(target)
    for target in found:
        _bind_shown(target)
    for holder in carrier.carriers():
        if holder.library is None:
            drivers.revalidate_tick(holder)


def bind_waiting() -> None:
    """Characters that were evaluated before they were bound: linked or appended since."""
    session = runtime.session
    if session.waiting:
        for target in spine_housekeeping.bodies():
            if target.session_uid in session.waiting:
                spine_binding.bind(target)
        for target in housekeeping.characters():
            if target.session_uid in session.waiting and not _follow_edits(target):
                _bind_shown(target)
        session.waiting.clear()


def follow_scripts() -> None:
    """Take over what was edited and has not been evaluated since."""
    for target in housekeeping.characters():
        if target.mode not in EDITING_MODES and not _follow_edits(target):
            character = runtime.character(target.session_uid)
            if character.signature != stack_proof.signature(target):
                _bind(target)


def _follow_edits(target: bpy.types.Object) -> bool:
    """Take over edited settings of an evaluated stack, where that is all."""
    character = runtime.character(target.session_uid)
    if character.binding is None or character.is_stale or character.signature != stack_proof.signature(target):
        return False
    return twins.follow(target)


def follow(depsgraph: bpy.types.Depsgraph) -> None:
    """Bind again what an update made stale: whatever a character depends on updates the character too."""
    updated = {update.id.original for update in depsgraph.updates}
    meshes = (item for item in updated if isinstance(item, bpy.types.Object) and item.type == "MESH")
    objects = [ob for ob in meshes if not twin.is_twin(ob)]
    _keep_house(objects)
    changed = {update.id.original for update in depsgraph.updates if update.is_updated_geometry}
    # Moving a shape key's slider updates its mesh as well; its shape changes in edit modes.
    keyed = {item.user for item in changed if isinstance(item, bpy.types.Key)}
    for target in objects:
        is_edited = target.data in changed and (target.mode in EDITING_MODES or target.data not in keyed)
        if spine_stack.spine_modifier(target) is not None:
            _follow_body(target, is_edited=is_edited)
        if stack.volume_modifier(target) is not None:
            _follow_character(target, is_edited=is_edited)
    if any(isinstance(item, bpy.types.Armature) for item in updated):
        active_bones.follow()
    # Dragging a curve's point comes without any name.
    if not updated or any(isinstance(item, bpy.types.NodeTree) for item in updated):
        for target in housekeeping.characters():
            follow_curves(target)


def _keep_house(objects: list[bpy.types.Object]) -> None:
    with runtime.quiet():
        housekeeping.give_own_carriers(objects)
        spine_housekeeping.give_own_carriers(objects)
        volumes = (ob.turgor.version > 0 and stack.volume_modifier(ob) is None for ob in objects)
        spines = (ob.turgor_spine.version > 0 and spine_stack.spine_modifier(ob) is None for ob in objects)
        if any(volumes) or any(spines):
            housekeeping.remove_orphans()


def _follow_character(target: bpy.types.Object, *, is_edited: bool) -> None:
    uid = target.session_uid
    character = runtime.character(uid)
    is_other_stack = character.signature != stack_proof.signature(target)
    is_followed = not is_other_stack and twins.follow(target)
    if is_followed:
        runtime.session.waiting.discard(uid)
    is_explained = take_changed(uid) or is_followed
    is_fresh = character.binding is not None and not (character.is_stale or is_other_stack)
    if is_explained and is_edited and is_fresh:
        # A slider is being dragged: whether its mesh changed too can be looked at afterwards.
        strokes.when_quiet(uid, "bind", _bind, SECONDS_TO_REST)
        is_edited = False
    character.is_stale = character.is_stale or is_edited or is_other_stack
    if character.is_stale and target.mode not in EDITING_MODES:
        _bind(target)
        return
    masks.follow(target, is_edited=is_edited)
    refining.follow(target)
    if not character.is_stale:
        follow_curves(target)
        binding.refresh_state(target)
    elif is_edited and _is_skin_painted(target) and character.bind_seconds < MOST_SECONDS_TO_BIND:
        strokes.after_stroke(uid, "bind", _bind)


def _is_skin_painted(target: bpy.types.Object) -> bool:
    return target.mode == "WEIGHT_PAINT" and not masks.is_painted(target)


def _bind(target: bpy.types.Object) -> None:
    strokes.drop(target.session_uid, "bind")
    character = runtime.character(target.session_uid)
    character.is_stale = target.mode in EDITING_MODES - {"WEIGHT_PAINT"}
    if character.is_stale:
        return  # it is read when the mode is left
    _bind_shown(target)


def _bind_shown(target: bpy.types.Object) -> None:
    """Bind a character, and look again at what its refinement preview shows."""
    binding.bind(target)
    refining.follow(target)


def _follow_body(target: bpy.types.Object, *, is_edited: bool) -> None:
    character = runtime.spine(target.session_uid)
    character.is_stale = character.is_stale or is_edited or character.signature != spine_stack.signature(target)
    if not character.is_stale:
        spine_binding.refresh_state(target)
    elif target.mode not in EDITING_MODES:
        character.is_stale = False
        spine_binding.bind(target)


def follow_curves(target: bpy.types.Object) -> None:
    """Use the target's own curves as they are drawn now."""
    if stack.volume_modifier(target) is not None:
        profiles.claim_edited(target)
        binding.refresh_curves(target)


def follow_shown_curves(ob: bpy.types.Object) -> bool:
    """Use the curves that are shown of a character, or of all characters of an armature, as they are drawn now.

    Curves that were never drawn are drawn from their preset. Returns False where no curves are shown.
    """
    shown = [(target, profiles.shown_set(target)) for target in _characters_of(ob)]
    for target, profile_set in shown:
        if profile_set is not None:
            profiles.claim_edited(target)
            profiles.prepare(profile_set)
            binding.refresh_curves(target)
    return any(profile_set is not None for _, profile_set in shown)


def _characters_of(ob: bpy.types.Object) -> list[bpy.types.Object]:
    if ob.type == "MESH":
        return [ob] if stack.volume_modifier(ob) is not None else []
    bodies = [
        character.binding for character in list(runtime.session.characters.values()) if character.binding is not None
    ]
    if not any(body.rig == ob.session_uid for body in bodies):
        return []
    armatures = ((target, stack.armature_modifier(target)) for target in housekeeping.characters())
    return [target for target, armature in armatures if armature is not None and armature.object == ob]
