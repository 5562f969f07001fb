"""The law of flesh on characters: on as they are added, off in files of before, by joint and keyed as a whole."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import LENGTH, RADIUS, add_turgor, place, rig, tube_mesh, weigh

BONES = 3


def _twisted(degrees: float) -> tuple[bpy.types.Object, float]:
    """A fine limb whose middle bone turns about itself from frame 1 to 20, where it stands; its volume at rest."""
    armature = rig()
    ob = place("Limb", tube_mesh(rings=81, segments=16), armature)
    weigh(ob, BONES)
    bone = armature.pose.bones["Bone1"]
    for frame, angle in ((1, 0.0), (20, degrees)):
        bone.rotation_euler = (0.0, math.radians(angle), 0.0)
        bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_set(1)
    rest = volume(ob)
    bpy.context.scene.frame_set(20)
    return ob, rest


def _thinnest(points: np.ndarray) -> float:
    """The least distance from the limb's axis of what is not at its ends."""
    side = (points[:, 2] > 0.1 * LENGTH) & (points[:, 2] < 0.9 * LENGTH)
    return float(np.hypot(points[side, 0], points[side, 1]).min())


@pytest.mark.parametrize("degrees", [90.0, 150.0, -150.0])
def test_a_twist_pinches_nothing(route, degrees: float):
    ob, rest = _twisted(degrees)
    skinned = _thinnest(positions(ob))
    add_turgor(ob)
    assert ob.turgor.flesh == 1.0
    assert ob.turgor.fields == "EVEN"
    assert relative_error(ob, rest) < VOLUME_TOLERANCE
    assert _thinnest(positions(ob)) > 0.97 * RADIUS > 1.2 * skinned
    ob.turgor.flesh = 0.0
    bpy.context.view_layer.update()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE
    assert _thinnest(positions(ob)) < 0.9 * RADIUS


def test_a_joint_without_flesh_is_as_the_character_without(route):
    """Only the middle bone turns against its parent, and the last one against it by nothing."""
    ob, _ = _twisted(120.0)
    add_turgor(ob)
    law = positions(ob)
    ob.turgor.joints["Bone1"].flesh = 0.0
    bpy.context.view_layer.update()
    without = positions(ob)
    assert np.abs(without - law).max() > 0.1 * RADIUS
    ob.turgor.joints["Bone1"].flesh, ob.turgor.flesh = 1.0, 0.0
    bpy.context.view_layer.update()
    np.testing.assert_allclose(positions(ob), without, atol=1e-6)


def test_a_keyed_amount_counts_in_every_frame_however_it_is_reached(route):
    ob, rest = _twisted(150.0)
    add_turgor(ob)
    shapes = {}
    for amount in (0.0, 1.0):
        ob.turgor.flesh = amount
        bpy.context.view_layer.update()
        shapes[amount] = positions(ob)
    for frame, amount in ((20, 0.0), (30, 1.0)):
        ob.turgor.flesh = amount
        assert ob.keyframe_insert("turgor.flesh", frame=frame)
    seen = {}
    for frame in (30, 20, 24, 20, 30, 24):
        bpy.context.scene.frame_set(frame)
        found = positions(ob)
        assert relative_error(ob, rest) < VOLUME_TOLERANCE
        assert (seen.setdefault(frame, found) == found).all()
    np.testing.assert_allclose(seen[20], shapes[0.0], atol=1e-6)
    np.testing.assert_allclose(seen[30], shapes[1.0], atol=1e-6)
    assert _thinnest(shapes[0.0]) < _thinnest(seen[24]) < _thinnest(shapes[1.0])
