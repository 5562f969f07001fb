"""Relative shape keys: all but the reference, in their order."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

# Widest range that Blender allows for a key's value.
RANGE = 10.0


def count(keys: bpy.types.Key | None) -> int:
    """Keys without the reference."""
    return 0 if keys is None else max(len(keys.key_blocks) - 1, 0)


def read_values(ob: bpy.types.Object) -> NDArray[np.float32]:
    """(K,) what each key contributes to this object now: a muted key 0, the pinned key of the object alone 1."""
    keys = ob.data.shape_keys
    if keys is None or len(keys.key_blocks) < 2:
        return np.zeros(0, np.float32)
    values = np.empty(len(keys.key_blocks), np.float32)
    muted = np.empty(len(keys.key_blocks), bool)
    keys.key_blocks.foreach_get("value", values)
    keys.key_blocks.foreach_get("mute", muted)
    if ob.show_only_shape_key:
        values = (np.arange(len(values)) == ob.active_shape_key_index).astype(np.float32)
    values[muted] = 0.0
    return values[1:]


def set_all(keys: bpy.types.Key | None, value: float) -> None:
    """One value for every key, none muted."""
    if keys is not None:
        if not keys.use_relative:
            keys.eval_time = 0.0
        for key in keys.key_blocks:
            key.slider_min, key.slider_max = -RANGE, RANGE
            key.mute, key.value = False, value


def set_only(keys: bpy.types.Key, index: int) -> None:
    """Key `index`, counted without the reference, at one and the others at zero."""
    for position, key in enumerate(keys.key_blocks):
        key.value = float(position == index + 1)
