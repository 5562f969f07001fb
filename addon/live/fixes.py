"""Mends what `findings` found, by what the artist could do by hand. Main thread only."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np

from .. import runtime
from ..logic import orientation
from ..messages import message
from ..scene import mesh_selection, modifier_order, modifier_places, node_group, obstacles, spine_stack, stack
from . import binding, spine_binding

# How much more skin takes part at a joint that has no room.
LARGER = 1.5


class FixError(ValueError):
    """What the fix is about is gone."""


def apply(target: bpy.types.Object, fix: str, subject: str, kind: str) -> None:
    """Mend one finding.

    fix: of `properties.fixes`; subject: names of what it changes, one per line; kind: whose modifier, "VOLUME" or
    "SPINE". Raises FixError and modifier_places.PlaceError.
    """
    APPLY[fix](target, subject, kind)
    target.update_tag()


def _rebind(target: bpy.types.Object, subject: str, kind: str) -> None:
    frame = bpy.context.scene.frame_current
    if kind == "SPINE":
        spine_binding.rebind(target, frame)
    else:
        binding.rebind(target, frame)


def _move_below_armature(target: bpy.types.Object, subject: str, kind: str) -> None:
    ours = stack.volume_modifier(target)
    armature = modifier_order.armature_to_follow(target)
    if ours is None or armature is None:
        raise FixError("There is no Armature modifier any more")
    modifier_order.move_below_armature(target, ours, armature)
    binding.bind(target, accept_topology=True)


def _move_after(target: bpy.types.Object, subject: str, kind: str) -> None:
    ours = stack.own_modifier(target, node_group.KINDS[kind])
    # Each right after ours, the last first: they keep their order.
    for modifier in reversed(_modifiers(target, subject)):
        modifier_order.move_after(target, modifier, ours)
    _accept(target)


def _move_below(target: bpy.types.Object, subject: str, kind: str) -> None:
    """Drivers and inputs go along: they name the modifier. It moves back where nothing can be kept there."""
    ours = stack.volume_modifier(target)
    if ours is None:
        raise FixError("There is no Turgor Volume any more")
    place = list(target.modifiers).index(ours)
    modifier_order.move_below(target, ours, _modifier(target, subject))
    binding.bind(target, accept_topology=True)
    problem = runtime.character(target.session_uid).problem
    if problem is not None:
        modifier_places.put(target, ours, place)
        binding.bind(target, accept_topology=True)
        raise FixError(
            message("Turgor Volume cannot stand below {modifier}: {problem}", modifier=subject, problem=problem)
        )


def _move_above(target: bpy.types.Object, subject: str, kind: str) -> None:
    modifier = _modifier(target, subject)
    try:
        modifier_order.move_above(target, stack.volume_modifier(target), modifier)
    except RuntimeError as error:  # of modifiers that must come first
        raise FixError(str(error).strip()) from error
    _accept(target)


def _plain_parent(target: bpy.types.Object, subject: str, kind: str) -> None:
    target.parent_type = "OBJECT"
    _accept(target)


def _show_in_viewport(target: bpy.types.Object, subject: str, kind: str) -> None:
    _modifier(target, subject).show_viewport = True


def _show_in_renders(target: bpy.types.Object, subject: str, kind: str) -> None:
    _modifier(target, subject).show_render = True


def _no_multi_modifier(target: bpy.types.Object, subject: str, kind: str) -> None:
    _modifier(target, subject).use_multi_modifier = False


def _same_in_renders(target: bpy.types.Object, subject: str, kind: str) -> None:
    for modifier in _modifiers(target, subject):
        _show_alike(modifier)


def _show_alike(modifier: bpy.types.Modifier) -> None:
    modifier.show_render = modifier.show_viewport
    if modifier.type == "SCREW":
        modifier.render_steps = modifier.steps
    elif modifier.type in {"SUBSURF", "MULTIRES"}:
        modifier.render_levels = modifier.levels
        in_viewport, in_render = obstacles.detail(modifier)
        if in_viewport != in_render:
            render = bpy.context.scene.render
            render.simplify_subdivision_render = render.simplify_subdivision


def _select_open_edges(target: bpy.types.Object, subject: str, kind: str) -> None:
    mesh_selection.select_edges(target, lambda users: users == 1)


def _select_non_manifold(target: bpy.types.Object, subject: str, kind: str) -> None:
    mesh_selection.select_edges(target, lambda users: users > 2)


def _select_unweighted(target: bpy.types.Object, subject: str, kind: str) -> None:
    armature = stack.armature_modifier(target)
    if armature is None or armature.object is None:
        raise FixError("There is no Armature modifier any more")
    deform = {bone.name for bone in armature.object.data.bones if bone.use_deform}
    mesh_selection.select_unweighted(target, deform)


def _recalculate_outside(target: bpy.types.Object, subject: str, kind: str) -> None:
    mesh = target.data
    turns = orientation.faces_to_turn(*mesh_selection.read_welded(mesh))
    mesh_selection.turn_faces(mesh, np.flatnonzero(turns))
    for user in bpy.data.objects:
        if user.data == mesh:
            _accept(user)


def _larger_size(target: bpy.types.Object, subject: str, kind: str) -> None:
    for name in subject.splitlines():
        joint = target.turgor.joints.get(name)
        if joint is None:
            raise FixError(message("There is no joint {joint} any more", joint=name))
        joint.size *= LARGER


def _clear_group(target: bpy.types.Object, subject: str, kind: str) -> None:
    saved = target.turgor_spine if kind == "SPINE" else target.turgor
    for name in ("vertex_group", "pin_group"):
        if getattr(saved, name, None) == subject:
            setattr(saved, name, "")


def _accept(target: bpy.types.Object) -> None:
    """The artist asked for other faces: bind to them."""
    if target.type != "MESH" or target.library is not None:
        return
    if spine_stack.spine_modifier(target) is not None:
        spine_binding.bind(target, accept_topology=True)
    if stack.volume_modifier(target) is not None:
        binding.bind(target, accept_topology=True)


def _modifiers(target: bpy.types.Object, subject: str) -> list[bpy.types.Modifier]:
    """All that a finding names, in the order of the stack."""
    named = [_modifier(target, name) for name in subject.splitlines()]
    return [each for each in target.modifiers if each in named]


def _modifier(target: bpy.types.Object, name: str) -> bpy.types.Modifier:
    modifier = target.modifiers.get(name)
    if modifier is None:
        raise FixError(message("There is no modifier {modifier} any more", modifier=name))
    return modifier


APPLY: dict[str, Callable[[bpy.types.Object, str, str], None]] = {
    "REBIND": _rebind,
    "MOVE_BELOW_ARMATURE": _move_below_armature,
    "MOVE_AFTER": _move_after,
    "MOVE_BELOW": _move_below,
    "MOVE_ABOVE": _move_above,
    "PLAIN_PARENT": _plain_parent,
    "SHOW_IN_VIEWPORT": _show_in_viewport,
    "SHOW_IN_RENDERS": _show_in_renders,
    "NO_MULTI_MODIFIER": _no_multi_modifier,
    "SAME_IN_RENDERS": _same_in_renders,
    "SELECT_OPEN_EDGES": _select_open_edges,
    "SELECT_NON_MANIFOLD": _select_non_manifold,
    "SELECT_UNWEIGHTED": _select_unweighted,
    "RECALCULATE_OUTSIDE": _recalculate_outside,
    "LARGER_SIZE": _larger_size,
    "CLEAR_GROUP": _clear_group,
}
