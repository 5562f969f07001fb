"""Pull: the dependency graph reads the carrier's `tick`, and the offsets are written into its evaluated copy.

One evaluation per frame; viewport, render and exporter each get their own. The original attribute stays zero.
"""

from __future__ import annotations

import ctypes

from .. import runtime
from ..properties.carrier import TurgorCarrier
from ..scene import carrier
from .frame_by_kind import FRAMES

FLOAT3_BYTES = 12


def on_tick(evaluated: TurgorCarrier) -> None:
    """What `TurgorCarrier.on_tick` is while the add-on runs; called with the evaluated carrier's group."""
    if runtime.session.route != "PULL" or not evaluated.id_data.is_evaluated:
        return
    mesh, target = evaluated.mesh, evaluated.target
    if mesh is None or not mesh.is_evaluated:
        return
    address, vertex_count = carrier.offsets_address(mesh)
    if not vertex_count:
        return
    deform = FRAMES[evaluated.kind]
    # What an earlier evaluation wrote may still be there.
    if target is None or not target.is_evaluated or not deform(target, address, vertex_count):
        ctypes.memset(address, 0, vertex_count * FLOAT3_BYTES)
