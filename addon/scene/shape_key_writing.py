"""New shape keys on a mesh of our own, and what moves their values: keyframes or drivers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager

import bpy
import numpy as np
from numpy.typing import NDArray

from . import rest
from .shape_keys import RANGE

BASIS = "Basis"
_LINEAR = 1  # as `Keyframe.interpolation` is stored


def add_key(ob: bpy.types.Object, name: str, positions: NDArray[np.floating], low: float, high: float) -> str:
    """Adds a key at value 0, the reference before the first. The name it was given.

    positions: (N, 3). low, high: limits of its value.
    """
    with adding_keys(ob) as add:
        return add(name, positions, low, high)


@contextmanager
def adding_keys(ob: bpy.types.Object) -> Iterator[Callable[[str, NDArray[np.floating], float, float], str]]:
    """Many keys, as by `add_key`: within it the mesh lies as the last of them."""
    if ob.data.shape_keys is None:
        ob.shape_key_add(name=BASIS, from_mix=False)
    lying = rest.read_positions(ob.data)

    def add(name: str, positions: NDArray[np.floating], low: float, high: float) -> str:
        # A new key takes the mesh as it lies: many times faster than to write its points.
        rest.write_positions(ob.data, positions)
        key = ob.shape_key_add(name=name, from_mix=False)
        key.slider_min, key.slider_max = max(low, -RANGE), min(high, RANGE)
        # Blender 5 adds them at 1.
        key.value, key.mute = 0.0, False
        return key.name

    try:
        yield add
    finally:
        rest.write_positions(ob.data, lying)


def key_values(keys: bpy.types.Key, columns: Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
    """Keyframes as by `keying`. columns: by name of the key, frames and values, (F,) each."""
    key_value = keying(keys)
    for name, (frames, values) in columns.items():
        key_value(name, frames, values)


def keying(keys: bpy.types.Key) -> Callable[[str, NDArray[np.float64], NDArray[np.float64]], None]:
    """What keys values, in a new action, straight from one to the next: by name of the key, (F,) frames and values."""
    action = bpy.data.actions.new(f"{keys.user.name} Keys")
    slot = action.slots.new("KEY", keys.name)
    strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
    bag = strip.channelbag(slot, ensure=True)
    animation = keys.animation_data_create()
    animation.action, animation.action_slot = action, slot

    def key_value(name: str, frames: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        curve = bag.fcurves.new(value_path(name))
        curve.keyframe_points.add(len(frames))
        curve.keyframe_points.foreach_set("co", np.stack([frames, values], axis=1).astype(np.float32).ravel())
        curve.keyframe_points.foreach_set("interpolation", np.full(len(frames), _LINEAR, np.int32))
        curve.update()

    return key_value


def keep_animation(keys: bpy.types.Key, source: bpy.types.Key) -> None:
    """The action and the drivers that move the values of `source` move those of the same names here."""
    before = source.animation_data
    if before is None:
        return
    animation = keys.animation_data_create()
    if before.action is not None:
        animation.action, animation.action_slot = before.action, before.action_slot
    for curve in before.drivers:
        animation.drivers.from_existing(src_driver=curve)


def drive_value(keys: bpy.types.Key, name: str, rig: bpy.types.Object, bone: str, expression: str) -> None:
    """By x, y and z of the bone's turn as a unit quaternion. The expression is one that Blender works out itself."""
    driver = keys.driver_add(value_path(name)).driver
    driver.type = "SCRIPTED"
    for axis in "XYZ":
        variable = driver.variables.new()
        variable.name, variable.type = axis.lower(), "TRANSFORMS"
        target = variable.targets[0]
        target.id, target.bone_target = rig, bone
        target.transform_space, target.rotation_mode = "LOCAL_SPACE", "QUATERNION"
        target.transform_type = f"ROT_{axis}"
    driver.expression = expression


def value_path(name: str) -> str:
    """RNA path of a key's value."""
    return f'key_blocks["{bpy.utils.escape_identifier(name)}"].value'


def set_groups(
    ob: bpy.types.Object,
    group_names: Iterable[str],
    offsets: NDArray[np.int32],
    groups: NDArray[np.int32],
    weights: NDArray[np.float32],
) -> None:
    """Weights of these vertex groups become those given, others stay. groups: (W,) places in `group_names`."""
    import bmesh

    places = [ob.vertex_groups[name].index for name in group_names]
    edited = bmesh.new()
    try:
        edited.from_mesh(ob.data)
        layer = edited.verts.layers.deform.verify()
        own = set(places)
        for vertex, start, stop in zip(edited.verts, offsets[:-1].tolist(), offsets[1:].tolist(), strict=True):
            row = vertex[layer]
            for place in [place for place in row.keys() if place in own]:
                del row[place]
            for group, weight in zip(groups[start:stop].tolist(), weights[start:stop].tolist(), strict=True):
                row[places[group]] = weight
        edited.to_mesh(ob.data)
    finally:
        edited.free()
