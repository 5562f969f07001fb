"""Work that follows the hand: done at once where it is cheap, else a little later, and the last of it is never lost."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple

import bpy

from .. import runtime

# How often waiting work is looked at.
SECONDS_BETWEEN_LOOKS = 0.03
# Without a window no timer runs.
CAN_WAIT = not bpy.app.background

Work = Callable[[bpy.types.Object], None]


class _Waiting(NamedTuple):
    work: Work
    due: float  # by perf_counter
    after_stroke: bool


# By session uid of the object and the name of the work.
_waiting: dict[tuple[int, str], _Waiting] = {}
_done: dict[tuple[int, str], float] = {}


def soon(uid: int, name: str, work: Work, pause: float) -> None:
    """Do `work` on the object now, but not within `pause` seconds after it was last done."""
    due = _done.get((uid, name), 0.0) + pause
    if (uid, name) in _waiting or due > perf_counter():
        _wait(uid, name, _Waiting(work, due, after_stroke=False))
    else:
        _do(uid, name, work)


def after_stroke(uid: int, name: str, work: Work) -> None:
    """Do `work` on the object when the brush is lifted."""
    _wait(uid, name, _Waiting(work, 0.0, after_stroke=True))


def when_quiet(uid: int, name: str, work: Work, pause: float) -> None:
    """Do `work` on the object when this was not asked for `pause` seconds."""
    if CAN_WAIT:
        _wait(uid, name, _Waiting(work, perf_counter() + pause, after_stroke=False))
    else:
        _do(uid, name, work)


def drop(uid: int, name: str) -> None:
    """Cancel waiting work: the caller does it otherwise."""
    _waiting.pop((uid, name), None)


def finish(*, is_stroking: bool = False) -> float | None:
    """Do what is due; a timer. Returns when to look again."""
    now = perf_counter()
    for (uid, name), waiting in list(_waiting.items()):
        if waiting.due <= now and not (waiting.after_stroke and (is_stroking or _is_stroking())):
            del _waiting[uid, name]
            _do(uid, name, waiting.work)
    return SECONDS_BETWEEN_LOOKS if _waiting else None


def forget() -> None:
    """Cancel all waiting work: another file was loaded, or the extension goes."""
    _waiting.clear()
    _done.clear()
    if bpy.app.timers.is_registered(finish):
        bpy.app.timers.unregister(finish)


def _wait(uid: int, name: str, waiting: _Waiting) -> None:
    _waiting[uid, name] = waiting
    if not bpy.app.timers.is_registered(finish):
        bpy.app.timers.register(finish, first_interval=SECONDS_BETWEEN_LOOKS)


def _do(uid: int, name: str, work: Work) -> None:
    target = next((ob for ob in bpy.data.objects if ob.session_uid == uid), None)
    if target is None or runtime.session.is_rendering:
        return
    work(target)
    _done[uid, name] = perf_counter()


def _is_stroking() -> bool:
    windows = bpy.context.window_manager.windows
    return any(operator.bl_idname.startswith("PAINT_OT") for window in windows for operator in window.modal_operators)
