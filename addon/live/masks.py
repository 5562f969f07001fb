"""The masks of a character: where volume may come back, and which vertices stay where skinning puts them.

They are read apart from the binding, which stays: a dab of the brush costs what reading one vertex group does.
"""

from __future__ import annotations

from time import perf_counter

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import runtime
from ..logic import weights
from ..scene import carrier, group_weights, stack
from . import findings, strokes

# While painting, of the time at most one part in so many goes to reading weights.
READING_SHARE = 3.0


def chosen(target: bpy.types.Object) -> tuple[str, bool, str]:
    """The masks that are chosen: vertex group, whether it is inverted, group that pins; empty names for none."""
    saved = target.turgor
    return saved.vertex_group, saved.invert_vertex_group, saved.pin_group


def read_mask(target: bpy.types.Object) -> NDArray[np.float32] | None:
    """Read the mask, (N,), from the vertex groups as they are now; None without any.

    Groups that do not exist count as not chosen.
    """
    group, is_inverted, pin_group = chosen(target)
    names = [name for name in dict.fromkeys((group, pin_group)) if name in target.vertex_groups]
    if not names:
        return None
    read = group_weights.read_groups(target, stack.body_end(target), target.turgor.bound_frame, names)
    columns = dict(zip(names, read, strict=True))
    return weights.effect_mask(columns.get(group), is_inverted, columns.get(pin_group))


def follow(target: bpy.types.Object, *, is_edited: bool) -> None:
    """Use other groups that were chosen, and what is being painted on them."""
    character = runtime.character(target.session_uid)
    if character.binding is None:
        return
    if character.binding.masked_by != chosen(target):
        refresh(target)
    elif is_edited and target.mode == "WEIGHT_PAINT" and is_painted(target):
        strokes.soon(target.session_uid, "mask", refresh, character.mask_seconds * READING_SHARE)


def refresh(target: bpy.types.Object) -> None:
    """Read the masks and show the character with them."""
    character = runtime.character(target.session_uid)
    bound = character.binding
    if bound is None:
        return
    started = perf_counter()
    with runtime.quiet():
        mask = read_mask(target)
    if mask is not None and len(mask) != bound.body.vertex_count:
        return  # other vertices than were bound: the bind that follows tells
    bound = bound._replace(masked_by=chosen(target))
    if not _equal(mask, bound.body.mask):
        bound = bound._replace(body=bound.body.masked(mask))
        carrier.carrier_of(target).turgor.carrier.mesh.update_tag()
    character.binding = bound
    character.mask_seconds = perf_counter() - started
    set_findings(target)


def set_findings(target: bpy.types.Object) -> None:
    """Keep and log what is off with the masks of a bound character."""
    character = runtime.character(target.session_uid)
    made = character.binding.body
    character.mask_findings = tuple(findings.of_masks(target, made.mask, made.pinned_shells))
    runtime.log_findings(character, target.name, character.mask_findings)


def is_painted(target: bpy.types.Object) -> bool:
    """Whether the brush is on a group that masks, or on its mirrored twin."""
    active = target.vertex_groups.active
    if active is None:
        return False
    group, _, pin_group = chosen(target)
    return not {active.name, bpy.utils.flip_name(active.name)}.isdisjoint({group, pin_group} - {""})


def _equal(one: NDArray[np.float32] | None, other: NDArray[np.float32] | None) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other)
