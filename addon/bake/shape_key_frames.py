"""Absolute shape keys: a copy without armature has one key per frame, and between two frames a part of both."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..scene import baked_copy, shape_key_writing, spine_stack, stack
from .baking import Baking, Progress
from .computing import POSITION_BYTES


def absolute(baking: Baking) -> Iterator[Progress]:
    """Makes the copy."""
    source, frames = baking.source, baking.options.frames
    baking.copy = baked_copy.make(
        baking.target, source.end, source.bound_frame, own_modifiers(baking), baking.options.name
    )
    key_value = None
    number = 0
    for chunk in baking.chunks:
        with shape_key_writing.adding_keys(baking.copy) as add:
            names = [add(f"Frame {frame:g}", at, 0.0, 1.0) for frame, at in zip(frames[number:], chunk, strict=False)]
        # At once: the engine is at work on the next ones.
        key_value = key_value or shape_key_writing.keying(baking.copy.data.shape_keys)
        for name in names:
            key_value(name, *tent(frames, number))
            number += 1
        yield baking.making(number / len(frames), f"{number} of {len(frames)} keys")
    baking.report.key_count = len(frames)
    baking.report.byte_count = (len(frames) + 1) * baking.report.vertex_count * POSITION_BYTES


def own_modifiers(baking: Baking, *, keep_armature: bool = False) -> list:
    """Modifiers that a copy does without: ours, and what poses it, but the Armature that its keys stand before."""
    target, end = baking.target, baking.source.end
    own = [stack.volume_modifier(target), spine_stack.spine_modifier(target), *baking.source.replaced]
    kept = end if keep_armature and end.type == "ARMATURE" else None
    return list(dict.fromkeys(modifier for modifier in own if modifier is not None and modifier != kept))


def tent(frames: NDArray[np.float64], number: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frames and values of the key of one frame: 1 there, 0 from its neighbours on. All keys sum to 1 at any time."""
    around = frames[max(number - 1, 0) : number + 2]
    return around, (around == frames[number]).astype(np.float64)
