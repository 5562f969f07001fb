"""Pull: the dependency graph reads the carrier's `tick`, and the offsets are written into its evaluated copy.

One evaluation per frame; viewport, render and exporter each get their own. The original attribute stays zero.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import turgor
from numpy.typing import NDArray

from .. import properties, runtime
from ..scene import carrier
from . import frame

FLOAT3_BYTES = 12


def on_tick(evaluated: properties.TurgorCarrier) -> None:
    """The hook of `properties.TurgorCarrier`, called with the evaluated carrier's group."""
    if runtime.session.route != "PULL" or not evaluated.id_data.is_evaluated:
        return
    mesh, target = evaluated.mesh, evaluated.target
    if mesh is None or not mesh.is_evaluated:
        return
    address, vertex_count = carrier.offsets_address(mesh)
    if not vertex_count:
        return

    def run(engine: turgor.VolumeSkin, pose_matrices: NDArray[np.float32], options: dict[str, Any]) -> turgor.Report:
        return engine.deform_into_address(address, vertex_count, pose_matrices, **options)

    if target is None or not target.is_evaluated or not frame.correct(target, vertex_count, run):
        ctypes.memset(address, 0, vertex_count * FLOAT3_BYTES)
