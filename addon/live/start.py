"""Bringing a loaded file to life, and following what the artist edits. Main thread only."""

from __future__ import annotations

import bpy

from .. import runtime
from ..scene import carrier, drivers, node_group, stack
from . import binding, housekeeping, profiles, route

# Modes in which the mesh is being changed; it is read when the artist leaves them.
EDITING_MODES = frozenset({"EDIT", "SCULPT", "WEIGHT_PAINT", "VERTEX_PAINT", "TEXTURE_PAINT"})


def start() -> None:
    """Bind every character of the file."""
    runtime.session.is_started = True
    if not node_group.exists():
        return
    with runtime.quiet():
        route.choose()
        housekeeping.remove_orphans()
        found = housekeeping.characters()
        housekeeping.give_own_carriers(found)
    for target in found:
        binding.bind(target)
    for holder in carrier.carriers():
        if holder.library is None:
            drivers.revalidate_tick(holder)


def bind_waiting() -> None:
    """Characters that were evaluated before they were bound: linked or appended since."""
    session = runtime.session
    if session.waiting:
        for target in housekeeping.characters():
            if target.session_uid in session.waiting:
                binding.bind(target)
        session.waiting.clear()


def follow(depsgraph: bpy.types.Depsgraph) -> None:
    """Bind again what an update made stale."""
    updated = {update.id.original for update in depsgraph.updates}
    changed = {update.id.original for update in depsgraph.updates if update.is_updated_geometry}
    # Dragging a curve's point comes without any name.
    are_curves_edited = not updated or any(isinstance(item, bpy.types.NodeTree) for item in updated)
    objects = [item for item in changed if isinstance(item, bpy.types.Object) and item.type == "MESH"]
    data = {item for item in changed if isinstance(item, bpy.types.Mesh | bpy.types.Armature)}
    with runtime.quiet():
        housekeeping.give_own_carriers(objects)
        if objects:
            housekeeping.remove_orphans()
    # Moving a shape key's slider updates its mesh as well; its shape changes in edit modes.
    keyed = {item.user for item in changed if isinstance(item, bpy.types.Key)}
    for target in housekeeping.characters():
        known = runtime.character(target.session_uid)
        armature = stack.armature_modifier(target)
        rig = None if armature is None else armature.object
        is_mesh_edited = target.data in data and (target.data not in keyed or target.mode in EDITING_MODES)
        is_edited = is_mesh_edited or (rig is not None and rig.data in data)
        known.is_stale = known.is_stale or is_edited or known.signature != stack.signature(target)
        if not known.is_stale:
            if (are_curves_edited or target in updated) and profiles.has_custom(target):
                binding.refresh_tables(target)
        elif target.mode not in EDITING_MODES and (rig is None or rig.mode != "EDIT"):
            known.is_stale = False
            binding.bind(target)
