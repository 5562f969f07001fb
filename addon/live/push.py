"""Push: frame handlers write the carriers and have them evaluated again. Two evaluations per frame."""

from __future__ import annotations

from collections.abc import Collection
from time import perf_counter

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import runtime
from ..logic.character_figures import Timing
from ..scene import carrier
from .frame_by_kind import FRAMES


def write_all(depsgraph: bpy.types.Depsgraph, behind: Collection[int] = ()) -> None:
    """Correct every character of this evaluation; what is equal already is not written, so nothing runs in circles.

    behind: session uids of those that were edited after it, which are plain until the next one.
    """
    for holder in carrier.carriers():
        target = holder.turgor.carrier.target
        if target is not None:
            evaluated = target.evaluated_get(depsgraph)
            if evaluated.is_evaluated:
                _write(holder, evaluated, is_behind=target.session_uid in behind)


def settle(depsgraph: bpy.types.Depsgraph) -> None:
    """Make what was evaluated in a scene that is not the artist's final: handlers write no offsets there."""
    if runtime.session.route == "PUSH":
        write_all(depsgraph)
        depsgraph.update()


def clear_all() -> None:
    """Zero the carriers: what is saved shows plain skinning without the extension."""
    for holder in carrier.carriers():
        mesh = holder.turgor.carrier.mesh
        _write_changed(mesh, np.zeros((len(mesh.vertices), 3), np.float32))


def _write(holder: bpy.types.Object, target: bpy.types.Object, *, is_behind: bool) -> None:
    mesh = holder.turgor.carrier.mesh
    offsets = np.zeros((len(mesh.vertices), 3), np.float32)
    if not len(offsets):
        return

    kind = holder.turgor.carrier.kind
    if is_behind or not FRAMES[kind](target, offsets.ctypes.data, len(offsets)):
        offsets[...] = 0.0
    started = perf_counter()
    _write_changed(mesh, offsets)
    state = runtime.state_of(kind, target.original.session_uid)
    if state.timing is not None:
        milliseconds = 1e3 * (perf_counter() - started)
        state.timing = Timing(state.timing.read, state.timing.engine, milliseconds)


def _write_changed(mesh: bpy.types.Mesh, offsets: NDArray[np.float32]) -> None:
    if not np.array_equal(carrier.read_offsets(mesh), offsets):
        carrier.write_offsets(mesh, offsets)
