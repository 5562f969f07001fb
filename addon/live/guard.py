"""What keeps every frame from harm: nothing may leave a getter or a handler. Safe on a worker thread."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import bpy

from .. import runtime
from ..states import SpineState, VolumeState
from . import findings

State = TypeVar("State", VolumeState, SpineState)


def guarded(states: dict[int, State], target: bpy.types.Object, compute: Callable[[State], bool]) -> bool:
    """Run one frame of the evaluated `target`; False: there is nothing to show, offsets must be zero.

    states: by session uid, of this kind of modifier. compute: False where no binding fits. What it raises is for the
    panel.
    """
    original = target.original
    state = states.get(original.session_uid)
    if state is None:
        runtime.session.waiting.add(original.session_uid)
        return False
    try:
        is_shown = compute(state)
    except BaseException as error:  # the artist reads it in the panel; what else passes freezes the pose without a word
        runtime.set_failure(state, original.name, findings.of_error(original, error))
        return False
    if is_shown:
        runtime.set_failure(state, original.name, None)
    return is_shown
