"""Which route carries the correction: the artist's choice, or pull where a self-test proves that it works."""

from __future__ import annotations

import ctypes

import bpy
import numpy as np

from .. import runtime
from ..properties.carrier import TurgorCarrier
from ..scene import carrier, node_group, pull_probe

PACKAGE = __package__.rpartition(".")[0]

# Offset that the self-test writes for its one vertex.
TEST_OFFSET = np.array([[1.0, 2.0, 3.0]], np.float32)


def choose() -> None:
    """Set the session's route if it is not chosen yet or the preference changed."""
    wanted = preference()
    session = runtime.session
    if session.route and (session.route == wanted or (wanted == "AUTOMATIC" and not session.is_forced)):
        return
    session.is_forced = wanted != "AUTOMATIC"
    if session.is_forced:
        session.route, session.route_reason = wanted, "chosen in the preferences"
        return
    failure = self_test()
    if failure is None:
        session.route, session.route_reason = "PULL", "self-test passed"
    else:
        session.route, session.route_reason = "PUSH", failure
        runtime.log.warning("live by push, twice the evaluations: %s", failure)


def preference() -> str:
    """The artist's choice, AUTOMATIC when the add-on runs without saved preferences."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    return "AUTOMATIC" if addon is None or addon.preferences is None else addon.preferences.route


def self_test() -> str | None:
    """Why pull does not work in this Blender, or None: a tick moved the evaluated mesh and left the original alone."""
    hook = TurgorCarrier.on_tick
    TurgorCarrier.on_tick = staticmethod(_write_test_offset)
    try:
        with runtime.quiet():
            reading = pull_probe.read_probe()
            node_group.remove_unused()
    finally:
        TurgorCarrier.on_tick = staticmethod(hook)
    if not np.array_equal(reading.evaluated, TEST_OFFSET):
        return "a driver's reading did not reach the evaluated mesh"
    if reading.original.any():
        return "a driver's reading changed the saved mesh"
    return None


def _write_test_offset(evaluated: TurgorCarrier) -> None:
    mesh = evaluated.mesh
    if evaluated.id_data.is_evaluated and mesh is not None and mesh.is_evaluated:
        address, vertex_count = carrier.offsets_address(mesh)
        if vertex_count:
            ctypes.memmove(address, TEST_OFFSET.ctypes.data, TEST_OFFSET.nbytes)
