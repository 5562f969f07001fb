"""Modifiers after Turgor Volume, and the mesh before and after each: evaluated by doubles apart from the scene."""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from . import doubles, rest, stack

# They show the same body with more vertices.
SUBDIVIDING = frozenset({"SUBSURF", "MULTIRES"})


# Positions (N, 3) in object space, face offsets (F + 1,), face corners (C,).
Shape = tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.int32]]


class Steps(NamedTuple):
    """The mesh right after Turgor Volume, then after each later modifier; posed, and with the mesh at rest."""

    names: tuple[str, ...]  # of the L later modifiers
    posed: tuple[Shape, ...]  # (L + 1,)
    rest: tuple[Shape, ...]  # (L + 1,)


def later(ob: bpy.types.Object) -> list[bpy.types.Modifier]:
    """Modifiers after Turgor Volume that are on in the viewport or in renders.

    Simulations are left out: what they show follows from all frames before.
    """
    ours = stack.volume_modifier(ob)
    if ours is None:
        return []
    modifiers = list(ob.modifiers)
    following = modifiers[modifiers.index(ours) + 1 :]
    return [each for each in following if stack.is_on(each) and each.type not in stack.SIMULATED_TYPES]


def is_whole(ob: bpy.types.Object) -> bool:
    """Whether the viewport shows just what `later` leaves: nothing simulates, nothing is on in renders only."""
    ours = stack.volume_modifier(ob)
    modifiers = list(ob.modifiers)
    following = modifiers[modifiers.index(ours) + 1 :]
    return [each for each in following if each.show_viewport] == later(ob)


def follows_others(modifier: bpy.types.Modifier) -> bool:
    """Whether another object says what the modifier does: with the mesh at rest it would still follow a posed one."""
    for prop in modifier.bl_rna.properties:
        if prop.type == "POINTER" and isinstance(getattr(modifier, prop.identifier), bpy.types.Object):
            return True
    return modifier.type == "NODES" and stack.has_node(modifier.node_group, stack.MOVING_NODES)


def steps(ob: bpy.types.Object, frame: float) -> Steps:
    """Evaluate the stack at `frame` up to each of `later`. Nothing of the artist's scene is touched."""
    chain = later(ob)
    names = tuple(each.name for each in chain)
    ours = stack.volume_modifier(ob)
    left_out = _left_out(ob, names)
    posing = [each for each in stack.posing_modifiers(ob) if each.type not in stack.STILL_TYPES]
    bending = {each.name for each in (*posing, ours)}
    posed = [[*doubles.after(ob, last), *left_out] for last in (ours.name, *names)]
    without = [list(dict.fromkeys(each)) for each in (*posed, *([*each, *bending] for each in posed))]
    with doubles.doubles([ob] * len(without), without) as alone:
        for double in alone.objects:
            for name in names:
                if name in double.modifiers:
                    double.modifiers[name].show_viewport = True
        found = tuple(_shape(mesh) for mesh in alone.evaluated(frame))
    return Steps(names, found[: len(posed)], found[len(posed) :])


def _left_out(ob: bpy.types.Object, names: tuple[str, ...]) -> list[str]:
    ours = stack.volume_modifier(ob)
    return [name for name in doubles.after(ob, ours.name) if name not in names]


def _shape(mesh: bpy.types.Mesh) -> Shape:
    return rest.read_positions(mesh), *rest.read_faces(mesh)
