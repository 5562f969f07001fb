"""What keeps every frame from harm: nothing may leave a getter or a handler. Safe on a worker thread."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from .. import runtime
from . import findings


def guarded(
    characters: dict[int, runtime.Character], target: bpy.types.Object, compute: Callable[[runtime.Character], bool]
) -> bool:
    """Runs one frame of the evaluated `target`; False: there is nothing to show, offsets must be zero.

    characters: of this kind of modifier. compute: False where no binding fits. What it raises is for the panel.
    """
    original = target.original
    known = characters.get(original.session_uid)
    if known is None:
        runtime.session.waiting.add(original.session_uid)
        return False
    try:
        is_shown = compute(known)
    except BaseException as error:  # the artist reads it in the panel; what else passes freezes the pose without a word
        runtime.set_failure(known, original.name, findings.of_error(original, error))
        return False
    if is_shown:
        runtime.set_failure(known, original.name, None)
    return is_shown
