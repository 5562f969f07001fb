"""What comes and goes with Turgor Spine: its modifier, carrier and rest curve. Main thread only."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from .. import runtime
from ..scene import carrier, drivers, node_group, spine_stack, stack, twin
from . import spine_binding
from .binding_rules import is_editable


def bodies() -> list[bpy.types.Object]:
    """All objects of the file with Turgor Spine."""
    return [
        ob
        for ob in bpy.data.objects
        if ob.type == "MESH" and spine_stack.spine_modifier(ob) is not None and not twin.is_twin(ob)
    ]


def add(target: bpy.types.Object) -> None:
    """Put the modifier into the stack and bind; its spine is chosen, or the panel asks for one.

    Raises modifier_places.PlaceError, and has added nothing.
    """
    saved = target.turgor_spine
    place = spine_stack.place_for_new(target, saved.rig if saved.source == "BONES" else None)
    stack.add_own_modifier(target, node_group.SPINE, place, show_in_editmode=True)
    saved.bound_frame = bpy.context.scene.frame_current
    carrier.assign(target, carrier.create(target, node_group.SPINE))
    spine_binding.bind(target, accept_topology=True)


def remove(target: bpy.types.Object) -> None:
    """Leave nothing behind."""
    holder = carrier.carrier_of(target, node_group.SPINE)
    target.modifiers.remove(spine_stack.spine_modifier(target))
    if holder is not None and carrier.is_orphan(holder):
        carrier.remove(holder)
    forget_settings(target)
    node_group.remove_unused()


def forget_settings(target: bpy.types.Object) -> None:
    """Drop saved and runtime settings of an object without our modifier."""
    curve = target.turgor_spine.bound_curve
    drivers.remove_stray(target)
    target.property_unset("turgor_spine")
    if curve is not None and curve.users == 0:
        bpy.data.curves.remove(curve)
    runtime.session.spines.pop(target.session_uid, None)


def give_own_carriers(objects: Iterable[bpy.types.Object]) -> None:
    """After Shift-D a copy reads the carrier and the rest curve of its original, an override shares its mesh."""
    for ob in objects:
        holder = carrier.carrier_of(ob, node_group.SPINE) if spine_stack.spine_modifier(ob) is not None else None
        if holder is None or not is_editable(ob):
            continue
        if holder.turgor.carrier.target == ob:
            carrier.give_own_meshes([holder])
            continue
        if ob.turgor_spine.bound_curve is not None:
            ob.turgor_spine.bound_curve = ob.turgor_spine.bound_curve.copy()
        carrier.assign(ob, carrier.create(ob, node_group.SPINE))
