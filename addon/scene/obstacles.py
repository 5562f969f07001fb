"""What of a modifier stack or a rig cannot be followed: each with a stable id, a sentence, and what would mend it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import bpy

from ..messages import Message, message
from . import node_group, stack
from .gathered import gathered

# What renders show where they cannot show ours.
PLAIN_SKINNING = message("plain skinning")
VIEWPORT_NODES = frozenset({"GeometryNodeIsViewport"})


class Obstacle(NamedTuple):
    """`fix` names one of `properties.fixes`, empty where the artist must choose; `subject` is what it changes."""

    id: str
    text: str
    fix: str = ""
    subject: str = ""  # names of modifiers, one per line


def obstacle(ob: bpy.types.Object) -> Obstacle | None:
    """Why this object cannot be corrected and what to do; None when it can."""
    armature = stack.armature_modifier(ob)
    if armature is not None:
        return (
            armature_obstacle(ob, armature)
            or gathered(_earlier_obstacles(ob, armature))
            or gathered(_later_obstacles(ob, armature))
        )
    if stack.volume_modifier(ob) is not None:
        text = "No Armature modifier right before Turgor Volume: move Turgor Volume directly below it"
        has_armature = any(modifier.type == "ARMATURE" for modifier in ob.modifiers)
        return Obstacle("modifier_order", text, "MOVE_BELOW_ARMATURE" if has_armature else "")
    if stack.own_modifier(ob, node_group.SPINE) is not None:
        text = "No Armature modifier: Turgor Spine alone keeps the volume by itself, turn on its Exact Volume"
        return Obstacle("no_armature", text)
    return Obstacle("no_armature", "No Armature modifier: give the mesh one (Object > Parent > Armature Deform)")


def render_difference(
    ob: bpy.types.Object, end: bpy.types.Modifier | None, shown: Message = PLAIN_SKINNING
) -> Obstacle | None:
    """What makes the stack before `end` another mesh in renders, where then only `shown` is seen."""
    return None if end is None else gathered(_render_differences(ob, end, shown))


def _render_differences(ob: bpy.types.Object, end: bpy.types.Modifier, shown: Message) -> Iterator[Obstacle]:
    for modifier in stack.modifiers_before(ob, end):
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
    """What this Armature modifier does that is not followed."""
    name = armature.name
    if armature.object is None or armature.object.type != "ARMATURE":
        return Obstacle(
            "no_armature_object", message("Modifier {modifier} has no armature object: choose one", modifier=name)
        )
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


def _earlier_obstacles(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> Iterator[Obstacle]:
    has_shape_keys = ob.data.shape_keys is not None
    for modifier in stack.modifiers_before(ob, armature):
        name = modifier.name
        if modifier.type == "ARMATURE":
            text = message(
                "{modifier} deforms before {armature}: only one Armature is supported, turn one off",
                modifier=name,
                armature=armature.name,
            )
            yield Obstacle("second_armature", text, "TURN_OFF", name)
        elif stack.moves(modifier):
            text = message(
                "{modifier} can move the mesh before the Armature: move it after Turgor Volume", modifier=name
            )
            yield Obstacle("moving_modifier", text, "MOVE_AFTER", name)
        elif stack.is_animated(ob, modifier):
            text = message("{modifier} is animated before the Armature: move it after Turgor Volume", modifier=name)
            yield Obstacle("moving_modifier", text, "MOVE_AFTER", name)
        elif has_shape_keys and modifier.type not in stack.LINEAR_TYPES:
            text = message(
                "{modifier} changes shape keys before the Armature: apply it, or move it after Turgor Volume",
                modifier=name,
            )
            yield Obstacle("shape_key_modifier", text, "MOVE_AFTER", name)


def _later_obstacles(ob: bpy.types.Object, armature: bpy.types.ArmatureModifier) -> Iterator[Obstacle]:
    for modifier in stack.later_armatures(ob, armature):
        text = message(
            "{modifier} deforms again after Turgor Volume: only one Armature is supported, turn one off",
            modifier=modifier.name,
        )
        yield Obstacle("second_armature", text, "TURN_OFF", modifier.name)
