"""Any stack, as it comes: exact on every frame beside what Blender evaluates, or refused by name; never silent."""

from __future__ import annotations

import bpy
import pytest
from measure import volume
from stacks import KINDS, body_copy, worst_error
from test_exact import VOLUME_TOLERANCE
from tube import LAST_FRAME, add_turgor, character, volume_modifier


def _finding(runtime, ob: bpy.types.Object, name: str):
    return next((found for found in runtime.character(ob.session_uid).findings if found.id == name), None)


def _check(runtime, ob: bpy.types.Object, body: bpy.types.Object, *, is_evaluated: bool = True) -> None:
    """Exact beside the body, and told that it is read as Blender evaluates it."""
    assert runtime.character(ob.session_uid).problem is None
    worst = worst_error(ob, body)
    assert runtime.character(ob.session_uid).problem is None
    assert (_finding(runtime, ob, "evaluated") is not None) == is_evaluated
    assert worst < VOLUME_TOLERANCE
    print(f"worst {worst:.1e}")


@pytest.mark.parametrize("kind", KINDS)
def test_between_the_armature_and_ours(runtime, kind):
    ob, _ = character()
    KINDS[kind](ob)
    body = body_copy(ob, ob.modifiers["Armature"])
    add_turgor(ob)
    ours = volume_modifier(ob)
    ob.modifiers.move(list(ob.modifiers).index(ours), len(ob.modifiers) - 1)
    bpy.context.view_layer.update()
    plain = body_copy(ob, ours)
    _check(runtime, ob, body)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert abs(volume(plain) / volume(body) - 1.0) > 1e-3


@pytest.mark.parametrize("kind", KINDS)
def test_before_the_armature(runtime, kind):
    ob, _ = character()
    modifier = KINDS[kind](ob)
    armature = ob.modifiers["Armature"]
    ob.modifiers.move(list(ob.modifiers).index(armature), len(ob.modifiers) - 1)
    first = modifier if kind == "second rig" else armature
    body = body_copy(ob, first)
    add_turgor(ob)
    _check(runtime, ob, body, is_evaluated=kind not in {"laplacian smooth", "smooth"})


@pytest.mark.parametrize("kind", KINDS)
def test_without_an_armature(runtime, kind):
    ob, _ = character()
    ob.modifiers.remove(ob.modifiers["Armature"])
    KINDS[kind](ob)
    body = body_copy(ob, None)
    add_turgor(ob)
    assert ob.modifiers[-1] == volume_modifier(ob)
    _check(runtime, ob, body, is_evaluated=kind != "second rig")
