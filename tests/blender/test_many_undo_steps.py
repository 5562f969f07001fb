"""However far the artist goes back and forth, the mesh is the one that was there, to the last bit."""

from __future__ import annotations

import random
from collections.abc import Callable

import bpy
import numpy as np
from measure import positions
from tube import LAST_FRAME, add_turgor, character, select, set_strength, volume_modifier

EDITS, STEPS = 24, 1000


def _tube() -> bpy.types.Object:
    return bpy.data.objects["Tube"]


def _move_rig(rng: random.Random) -> None:
    bpy.data.objects["Rig"].location.x = rng.uniform(-1.0, 1.0)


def _turn_bone(rng: random.Random) -> None:
    bone = bpy.data.objects["Rig"].pose.bones[1]
    bone.rotation_euler.x = rng.uniform(-1.0, 1.0)
    bone.keyframe_insert("rotation_euler", frame=bpy.context.scene.frame_current)


def _go_to_frame(rng: random.Random) -> None:
    bpy.context.scene.frame_set(rng.randint(2, LAST_FRAME))


def _choose_preset(rng: random.Random) -> None:
    joints = _tube().turgor.joints
    joints[rng.randrange(len(joints))].preset = rng.choice(["ISOTROPIC", "RUBBER", "MUSCLE", "FOLDS", "BELLY"])


def _change_strength(rng: random.Random) -> None:
    set_strength(_tube(), rng.uniform(0.2, 1.0))


def _change_target(rng: random.Random) -> None:
    _tube().turgor.target_volume = rng.uniform(0.9, 1.1)


def _move_vertex(rng: random.Random) -> None:
    mesh = _tube().data
    mesh.vertices[rng.randrange(len(mesh.vertices))].co.x += 0.05
    mesh.update()


def _remove_and_add(rng: random.Random) -> None:
    select([_tube()])
    bpy.ops.object.turgor_volume_remove()
    if rng.random() < 0.5:
        add_turgor(_tube())


def _copy_and_delete(rng: random.Random) -> None:
    select([_tube()])
    bpy.ops.object.duplicate()
    if rng.random() < 0.7:
        bpy.ops.object.delete()


# With Turgor, and always.
WITH: list[Callable[[random.Random], None]] = [_choose_preset, _change_strength, _change_target, _remove_and_add]
ALWAYS: list[Callable[[random.Random], None]] = [_move_rig, _turn_bone, _go_to_frame, _move_vertex, _copy_and_delete]


def test_a_thousand_steps_back_and_forth(runtime):
    rng = random.Random(3)
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(LAST_FRAME // 2)
    states = []
    for number in range(EDITS + 1):
        if number:
            has_volume = _tube().turgor.version > 0
            rng.choice([*ALWAYS, *(WITH if has_volume else [lambda _: add_turgor(_tube())])])(rng)
        bpy.context.view_layer.update()
        bpy.ops.ed.undo_push(message=str(number))
        states.append((bpy.context.scene.frame_current, positions(_tube())))
    assert len({state[1].tobytes() for state in states}) > EDITS // 2
    place = EDITS
    for step in range(STEPS):
        goes_back = place == EDITS or (place > 0 and rng.random() < 0.5)
        (bpy.ops.ed.undo if goes_back else bpy.ops.ed.redo)()
        place += -1 if goes_back else 1
        frame, shown = states[place]
        assert bpy.context.scene.frame_current == frame, step
        assert np.array_equal(positions(_tube()), shown), step
        if _tube().turgor.version > 0:
            assert runtime.character(_tube().session_uid).problem is None
            assert volume_modifier(_tube()) is not None
