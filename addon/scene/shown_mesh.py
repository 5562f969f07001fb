"""The mesh that a viewport shows of an object, after all of its modifiers."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray


def positions(ob: bpy.types.Object) -> NDArray[np.float32] | None:
    """(N, 3) of the evaluated mesh, object space; None in Edit Mode and where the object is not shown. Main thread only."""
    target = ob.evaluated_get(bpy.context.view_layer.depsgraph)
    if not target.is_evaluated or ob.mode == "EDIT":
        return None
    attribute = target.data.attributes.get("position")
    if attribute is None:
        return None
    found = np.empty((len(attribute.data), 3), np.float32)
    attribute.data.foreach_get("vector", found.ravel())
    return found
