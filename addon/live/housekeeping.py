"""What comes and goes with a character: carriers, node groups, hidden curve trees. Main thread only."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from .. import runtime
from ..properties.character import DATA_VERSION
from ..scene import carrier, curves, drivers, node_group, spine_stack, stack, stack_proof, twin
from . import binding, spine_housekeeping
from .binding_rules import is_editable


def characters() -> list[bpy.types.Object]:
    """All objects of the file with our modifier."""
    return [ob for ob in bpy.data.objects if ob.type == "MESH" and stack.volume_modifier(ob) is not None]


def add(target: bpy.types.Object) -> None:
    """Put the modifier after what poses the mesh and bind. The object has no obstacle and no modifier of ours.

    Raises modifier_places.PlaceError, and has added nothing.
    """
    armature = stack.armature_modifier(target)
    shows = armature is None or armature.show_in_editmode
    ours = stack.add_own_modifier(target, node_group.VOLUME, stack.place_for_new(target), show_in_editmode=shows)
    saved = target.turgor
    saved.version = DATA_VERSION
    saved.flesh, saved.fields = 1.0, "EVEN"
    saved.bound_frame = bpy.context.scene.frame_current
    if armature is not None and not stack_proof.lane_of(target).is_evaluated:
        drivers.follow_armature(target, ours, armature)
    carrier.assign(target, carrier.create(target))
    binding.bind(target, accept_topology=True)


def choose_joint(target: bpy.types.Object) -> None:
    """Make the joint that lost most when it was measured the one whose settings are shown."""
    joints = target.turgor.joints
    if len(joints):
        target.turgor.active_joint = max(range(len(joints)), key=lambda place: joints[place].peak_loss)


def remove(target: bpy.types.Object) -> None:
    """Leave nothing behind: modifier (Blender removes its drivers), carrier, curves, settings, unused node groups."""
    holder = carrier.carrier_of(target)
    target.modifiers.remove(stack.volume_modifier(target))
    if holder is not None and carrier.is_orphan(holder):
        carrier.remove(holder)
    twin.remove_unused()
    forget_settings(target)
    node_group.remove_unused()


def forget_settings(target: bpy.types.Object) -> None:
    """Drop saved and runtime settings of an object without our modifier."""
    curves.remove_tree(target)
    drivers.remove_stray(target)
    target.property_unset("turgor")
    runtime.session.characters.pop(target.session_uid, None)


def give_own_carriers(objects: Iterable[bpy.types.Object]) -> None:
    """After Shift-D a copy reads the carrier and the curves of its original, an override shares its mesh."""
    for ob in objects:
        if stack.volume_modifier(ob) is None or not is_editable(ob):
            continue
        holder = carrier.carrier_of(ob)
        if holder is not None and holder.turgor.carrier.target == ob:
            carrier.give_own_meshes([holder])
            continue
        others = [other for other in characters() if other != ob]
        curves.make_single_user(ob, others)
        carrier.assign(ob, carrier.create(ob))


def remove_orphans() -> None:
    """Carriers whose modifier was removed by its X, or whose character was deleted."""
    orphans = [holder for holder in carrier.carriers() if carrier.is_orphan(holder)]
    for holder in orphans:
        target, kind = holder.turgor.carrier.target, carrier.kind_of(holder)
        carrier.remove(holder)
        if target is None:
            continue
        if kind == node_group.SPINE:
            _forget_spine(target)
            continue
        if target.users == 0 and stack.volume_modifier(target) is not None:
            target.modifiers.remove(stack.volume_modifier(target))
        if stack.volume_modifier(target) is None:
            forget_settings(target)
    twin.remove_unused()
    if orphans:
        node_group.remove_unused()


def _forget_spine(target: bpy.types.Object) -> None:
    if target.users == 0 and spine_stack.spine_modifier(target) is not None:
        target.modifiers.remove(spine_stack.spine_modifier(target))
    if spine_stack.spine_modifier(target) is None:
        spine_housekeeping.forget_settings(target)
