"""The enclosed volume of Blender's evaluated mesh is the rest volume, on every frame."""

from __future__ import annotations

import bpy
from measure import positions, relative_error, volume
from tube import LAST_FRAME, add_turgor, character, set_strength

VOLUME_TOLERANCE = 1e-6


def test_plain_skinning_loses_volume_and_ours_does_not(route):
    ob, _ = character()
    rest = volume(ob)
    worst_plain = max(_errors(ob, rest))
    add_turgor(ob)
    assert worst_plain > 1e-2
    assert max(_errors(ob, rest)) < VOLUME_TOLERANCE


def test_strength_zero_is_plain_skinning_to_the_bit(route):
    ob, _ = character()
    bpy.context.scene.frame_set(15)
    plain = positions(ob)
    add_turgor(ob)
    assert (positions(ob) != plain).any()
    set_strength(ob, 0.0)
    bpy.context.view_layer.update()
    assert (positions(ob) == plain).all()


def _errors(ob, rest):
    for frame in range(1, LAST_FRAME + 1):
        bpy.context.scene.frame_set(frame)
        yield relative_error(ob, rest)
