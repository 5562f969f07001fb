"""What of a modifier stack or a rig cannot be followed: each with a stable id, a sentence, and what would mend it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import bpy

from ..messages import Message, message
from . import node_group, stack, stack_proof
from .gathered import gathered

# What renders show where they cannot show ours.
PLAIN_SKINNING = message("plain skinning")
VIEWPORT_NODES = frozenset({"GeometryNodeIsViewport"})


class Obstacle(NamedTuple):
    """`fix` names one of `properties.fixes`, empty where the artist must choose; `subject` is what it changes."""

    id: str
    text: str
    fix: str = ""
    subject: str = ""  # name of a modifier


def obstacle(ob: bpy.types.Object) -> Obstacle | None:
    """Why this object cannot be corrected and what to do; None when it can."""
    armature = stack.armature_modifier(ob)
    return (
        (_without_armature(ob) if armature is None else _object_obstacle(armature))
        or _parent_obstacle(ob)
        or gathered(_simulations(ob))
        or gathered(_selections(ob))
        or gathered(_later_armatures(ob))
    )


def _without_armature(ob: bpy.types.Object) -> Obstacle | None:
    posing = stack.posing_modifiers(ob)
    spine = stack.own_modifier(ob, node_group.SPINE)
    if spine is not None and all(modifier == spine or modifier.type in stack.STILL_TYPES for modifier in posing):
        text = "No Armature modifier: Turgor Spine alone keeps the volume by itself, turn on its Exact Volume"
        return Obstacle("no_armature", text)
    if any(modifier.type not in stack.STILL_TYPES for modifier in posing):
        return None
    if any(modifier.type == "ARMATURE" for modifier in ob.modifiers):
        text = "No Armature modifier before Turgor Volume: move Turgor Volume directly below it"
        return Obstacle("modifier_order", text, "MOVE_BELOW_ARMATURE")
    text = (
        "Nothing poses the mesh: give it an Armature (Object > Parent > Armature Deform) or another deforming modifier"
    )
    return Obstacle("no_armature", text)


def _parent_obstacle(ob: bpy.types.Object) -> Obstacle | None:
    """Blender deforms by such a parent before all modifiers."""
    if ob.parent is None or ob.parent_type not in {"ARMATURE", "LATTICE"}:
        return None
    text = message(
        "The parent {parent} deforms the mesh before all modifiers: make it a plain parent, and let a modifier deform",
        parent=ob.parent.name,
    )
    return Obstacle("deforming_parent", text, "PLAIN_PARENT")


def _simulations(ob: bpy.types.Object) -> Iterator[Obstacle]:
    """What follows from all frames before is not the same in two evaluations."""
    for modifier in stack.modifiers_to_own(ob):
        if stack.is_on(modifier) and stack.simulates(modifier):
            text = message(
                "{modifier} simulates, and what stands before Turgor Volume has to be the same however a frame is"
                " reached: move it after Turgor Volume",
                modifier=modifier.name,
            )
            yield Obstacle("simulation", text, "MOVE_AFTER", modifier.name)


def render_difference(
    ob: bpy.types.Object, end: bpy.types.Modifier | None, shown: Message = PLAIN_SKINNING
) -> Obstacle | None:
    """What makes the stack before `end` another mesh in renders, where then only `shown` is seen."""
    return None if end is None else gathered(_differences(stack.modifiers_before(ob, end), shown))


def evaluated_difference(ob: bpy.types.Object, lane: stack_proof.Lane) -> Obstacle | None:
    """The same for a stack that is read as Blender evaluates it: what only moves vertices may be another in renders."""
    before = stack.modifiers_to_own(ob)
    start = 0 if lane.moves else before.index(stack.body_end(ob))
    deforming = stack.DEFORMING_TYPES | stack.STILL_TYPES
    posing = (modifier for modifier in before[start:] if stack.is_on(modifier) and modifier.type not in deforming)
    found = gathered(_differences(posing, PLAIN_SKINNING))
    return found or (None if lane.moves else render_difference(ob, stack.body_end(ob)))


def _differences(modifiers: Iterable[bpy.types.Modifier], shown: Message) -> Iterator[Obstacle]:
    for modifier in modifiers:
        name = modifier.name
        if modifier.show_viewport != modifier.show_render:
            text = message(
                "{modifier} is on in the viewport or in renders only: renders show {shown}", modifier=name, shown=shown
            )
            yield Obstacle("render_switch", text, "SAME_IN_RENDERS", name)
            continue
        in_viewport, in_render = detail(modifier)
        if in_viewport != in_render:
            text = message(
                "{modifier} has other levels in renders ({in_render}) than in the viewport ({in_viewport}):"
                " make them equal, or renders show {shown}",
                modifier=name,
                in_render=in_render,
                in_viewport=in_viewport,
                shown=shown,
            )
            yield Obstacle("render_levels", text, "SAME_IN_RENDERS", name)
            continue
        if modifier.type == "NODES" and stack.has_node(modifier.node_group, VIEWPORT_NODES):
            yield Obstacle(
                "render_nodes",
                message(
                    "{modifier} asks whether it is in the viewport: renders show {shown}", modifier=name, shown=shown
                ),
            )


def detail(modifier: bpy.types.Modifier) -> tuple[int, int]:
    """Levels or steps in the viewport and in renders, with the scene's Simplify."""
    if modifier.type == "SCREW":
        return modifier.steps, modifier.render_steps
    if modifier.type not in {"SUBSURF", "MULTIRES"}:
        return 0, 0
    most_in_viewport, most_in_render = stack.most_levels()
    return min(modifier.levels, most_in_viewport), min(modifier.render_levels, most_in_render)


def armature_obstacle(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> Obstacle | None:
    """What this Armature modifier does that Turgor Spine does not follow."""
    name = armature.name
    if (found := _object_obstacle(armature)) is not None:
        return found
    if armature.use_multi_modifier:
        text = message("{modifier} uses Multi Modifier, which blends two armatures: turn it off", modifier=name)
        return Obstacle("multi_modifier", text, "NO_MULTI_MODIFIER", name)
    if stack.is_animated(ob, armature, but=stack.FOLLOWED):
        return Obstacle(
            "armature_animated",
            message("{modifier} has animated settings: remove their keyframes and drivers", modifier=name),
        )
    keys = ob.data.shape_keys
    if keys is not None and not keys.use_relative:
        text = "Shape keys are absolute: make them Relative in the mesh's properties"
        return Obstacle("absolute_shape_keys", text)
    return None


def _object_obstacle(armature: bpy.types.ArmatureModifier) -> Obstacle | None:
    if armature.object is not None and armature.object.type == "ARMATURE":
        return None
    text = message("Modifier {modifier} has no armature object: choose one", modifier=armature.name)
    return Obstacle("no_armature_object", text)


def _selections(ob: bpy.types.Object) -> Iterator[Obstacle]:
    """What makes other vertices on every frame, or whenever the artist selects a bone."""
    for modifier in stack.modifiers_to_own(ob):
        is_selected = modifier.type == "MASK" and modifier.mode == "ARMATURE"
        if stack.is_on(modifier) and (is_selected or modifier.type == "BUILD"):
            text = message(
                "{modifier} makes other vertices from frame to frame: move it after Turgor Volume",
                modifier=modifier.name,
            )
            yield Obstacle("moving_modifier", text, "MOVE_AFTER", modifier.name)


def _later_armatures(ob: bpy.types.Object) -> Iterator[Obstacle]:
    for modifier in stack.later_armatures(ob):
        text = message(
            "{modifier} deforms again after Turgor Volume: move Turgor Volume below it",
            modifier=modifier.name,
        )
        yield Obstacle("second_armature", text, "MOVE_BELOW_ARMATURE", modifier.name)
