"""Settings are read from an evaluated copy once: whatever is edited, a frame has those of its moment."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest
from measure import positions
from tube import LAST_FRAME, add_turgor, character, play_as_strip

BONE = "Bone1"
FRAMES = (5, 13)


def _joint(ob: bpy.types.Object) -> Any:
    return ob.turgor.joints[BONE]


def _key(ob: bpy.types.Object) -> None:
    path = f'turgor.joints["{BONE}"].strength'
    for frame, value in ((1, 0.0), (LAST_FRAME, 1.0)):
        _joint(ob).strength = value
        ob.keyframe_insert(path, frame=frame)


def _drive(ob: bpy.types.Object) -> None:
    ob.animation_data_clear()
    ob.driver_add(f'turgor.joints["{BONE}"].size').driver.expression = "0.5 + frame / 20"


def _strip(ob: bpy.types.Object) -> None:
    _key(ob)
    play_as_strip(ob)


def _another_armature(ob: bpy.types.Object) -> None:
    """The same bones, that another object moves."""
    armature = next(modifier for modifier in ob.modifiers if modifier.type == "ARMATURE")
    rig = armature.object.copy()
    rig.animation_data_clear()
    bpy.context.scene.collection.objects.link(rig)
    armature.object = rig


def _modifier_before(ob: bpy.types.Object) -> None:
    ob.modifiers.new("Weighted Normal", "WEIGHTED_NORMAL")
    ob.modifiers.move(len(ob.modifiers) - 1, 0)


EDITS: dict[str, Callable[[bpy.types.Object], object]] = {
    "strength": lambda ob: setattr(_joint(ob), "strength", 0.3),
    "preset": lambda ob: setattr(_joint(ob), "preset", "MUSCLE"),
    "target": lambda ob: setattr(ob.turgor, "target_volume", 1.2),
    "solver": lambda ob: setattr(ob.turgor, "solver", "SEQUENTIAL"),
    "mute": lambda ob: setattr(_joint(ob), "mute", True),
    "no mute": lambda ob: setattr(_joint(ob), "mute", False),
    "second": lambda ob: (setattr(_joint(ob), "blend_mode", "VALUE"), setattr(_joint(ob), "blend", 0.5)),
    "keys": _key,
    "driver": _drive,
    "no driver": lambda ob: ob.driver_remove(f'turgor.joints["{BONE}"].size'),
    "strip": _strip,
    "no strip": lambda ob: ob.animation_data_clear(),
    "other order": _modifier_before,
    "another armature": _another_armature,
    "moved": lambda ob: setattr(ob, "location", (1.0, 2.0, 3.0)),
}


def _shown(ob: bpy.types.Object) -> list[bytes]:
    found = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        found.append(positions(ob).tobytes())
    return found


def _forget(runtime: Any, ob: bpy.types.Object) -> None:
    runtime.character(ob.session_uid).settled = None


def test_after_any_edit_frames_are_those_of_settings_read_anew(route, addon):
    runtime = importlib.import_module("addon.runtime")
    ob, _ = character()
    add_turgor(ob)
    before = _shown(ob)
    unseen = []
    for name, edit in EDITS.items():
        edit(ob)
        found = _shown(ob)
        _forget(runtime, ob)
        assert found == _shown(ob), name
        if found == before:
            unseen.append(name)
        before = found
    # It changes normals alone.
    assert unseen == ["other order"]


def test_undo_brings_back_what_was_read_before(route, addon):
    ob, _ = character()
    add_turgor(ob)
    name = ob.name
    bpy.ops.ed.undo_push(message="before")
    before = _shown(ob)
    _joint(ob).strength = 0.2
    bpy.ops.ed.undo_push(message="after")
    assert _shown(ob) != before
    bpy.ops.ed.undo()
    ob = bpy.data.objects[name]
    assert _joint(ob).strength == pytest.approx(1.0)
    assert _shown(ob) == before


def test_settings_are_read_once_while_nothing_is_edited(route, addon, monkeypatch):
    settings = importlib.import_module("addon.scene.settings")
    reads = []
    read = settings.read_settings
    monkeypatch.setattr(settings, "read_settings", lambda target: reads.append(target.name) or read(target))
    ob, _ = character()
    add_turgor(ob)
    _shown(ob)
    reads.clear()
    for frame in range(1, LAST_FRAME):
        bpy.context.scene.frame_set(frame)
        positions(ob)
    assert not reads
    _joint(ob).strength = 0.5
    _shown(ob)
    assert len(reads) == 1
    _key(ob)
    reads.clear()
    _shown(ob)
    assert len(reads) >= len(FRAMES)


def test_originals_are_never_marked(route, addon, tmp_path):
    ob, _ = character()
    add_turgor(ob)
    _shown(ob)
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert evaluated.turgor.settled > 0
    assert ob.turgor.settled == 0
    copy = ob.copy()
    assert copy.turgor.settled == 0
    path = str(tmp_path / "marked.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert [each.turgor.settled for each in bpy.data.objects if len(each.turgor.joints)] == [0]
    assert np.isfinite(positions(next(each for each in bpy.data.objects if len(each.turgor.joints)))).all()
