"""Numbers of joints that are keyed, driven or played from the NLA: a frame is the same however it was reached."""

from __future__ import annotations

import itertools

import bpy
import numpy as np
import pytest
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import LAST_FRAME, add_turgor, character, play_as_strip

FRAME = 13
BONE = "Bone1"
# Value at the first frame, value at the last.
KEYED = {
    "blend": (0.0, 1.0),
    "strength": (0.2, 1.0),
    "size": (0.6, 1.6),
    "shares": ((1.0, 0.0, 0.0), (0.2, 0.2, 0.6)),
    "flesh": (0.0, 1.0),
    "outside": (0.0, 1.0),
    "spread_twist": (1.0, 0.0),
    "crease": (0.0, 1.0),
    "flex": (0.0, 1.0),
}


def _character() -> tuple[bpy.types.Object, bpy.types.PropertyGroup]:
    ob, _ = character()
    add_turgor(ob)
    joint = ob.turgor.joints[BONE]
    joint.preset = "MUSCLE"
    joint.blend_mode, joint.second.preset = "VALUE", "RUBBER"
    joint.use_auto_shares = joint.use_auto_outside = False
    return ob, joint


def _path(name: str) -> str:
    return f'turgor.joints["{BONE}"].{name}'


def _key(ob: bpy.types.Object, joint: bpy.types.PropertyGroup, name: str) -> None:
    for frame, value in zip((1, LAST_FRAME), KEYED[name], strict=True):
        setattr(joint, name, value)
        assert ob.keyframe_insert(_path(name), frame=frame)


def _at(ob: bpy.types.Object, frame: int, subframe: float = 0.0) -> np.ndarray:
    bpy.context.scene.frame_set(frame, subframe=subframe)
    return positions(ob)


@pytest.mark.parametrize("name", KEYED)
def test_a_keyed_number_counts_in_every_frame_however_it_is_reached(route, name):
    ob, joint = _character()
    rest = volume(ob)
    still = _at(ob, FRAME)
    _key(ob, joint, name)
    expected = _at(ob, FRAME)
    assert (expected != still).any()
    if name != "strength":
        assert relative_error(ob, rest) < VOLUME_TOLERANCE
    between = _at(ob, FRAME, 0.5)
    assert (between != expected).any()
    for frame in (1, LAST_FRAME, 4, 17):
        _at(ob, frame)
    assert (_at(ob, FRAME) == expected).all()
    assert (_at(ob, FRAME, 0.5) == between).all()


@pytest.mark.parametrize("name", ["blend", "strength", "size"])
def test_keys_drivers_and_strips_agree(route, name):
    ob, joint = _character()
    _key(ob, joint, name)
    keyed = _at(ob, FRAME)
    value = getattr(joint, name)
    play_as_strip(ob)
    assert np.abs(_at(ob, FRAME) - keyed).max() < 1e-6
    tracks = ob.animation_data.nla_tracks
    tracks.remove(tracks[0])
    driver = ob.driver_add(_path(name)).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.targets[0].id = ob
    variable.targets[0].data_path = '["turn"]'
    ob["turn"] = value
    ob.update_tag()
    assert np.abs(_at(ob, FRAME) - keyed).max() < 1e-6


def test_a_blend_begins_and_ends_with_its_sets_and_does_not_jump(route):
    ob, joint = _character()
    joint.use_auto_shares = True

    def shown(part: float) -> np.ndarray:
        joint.blend = part
        bpy.context.view_layer.update()
        return _at(ob, FRAME)

    parts = np.linspace(0.0, 1.0, 41)
    shapes = [shown(float(part)) for part in parts]
    joint.blend_mode = "NONE"
    assert np.abs(_at(ob, FRAME) - shapes[0]).max() < 1e-6
    joint.preset = "RUBBER"
    assert np.abs(_at(ob, FRAME) - shapes[-1]).max() < 1e-6
    whole = np.abs(shapes[-1] - shapes[0]).max()
    steps = [np.abs(after - before).max() for before, after in itertools.pairwise(shapes)]
    assert max(steps) < 0.5 * whole
    joint.blend_mode = "VALUE"
    joint.preset = "MUSCLE"
    assert np.abs(shown(1e-4) - shown(0.0)).max() < 1e-2 * whole
    joint.preset, joint.blend_mode = "MUSCLE", "VALUE"
    assert np.abs(shown(0.5 + 1e-4) - shown(0.5)).max() < 1e-2 * whole
