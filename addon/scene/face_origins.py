"""Which face of a mesh each face comes from that modifiers make of it."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from . import rest, stack

_ATTRIBUTE = "Turgor Face"


def face_origins(ob: bpy.types.Object, end: bpy.types.Modifier, frame: int) -> NDArray[np.int32]:
    """(F,) the mesh's face from which each face before the modifier `end` comes, in the order of `rest.read_rest`.

    -1 for a face that comes from none. frame: at which the stack is evaluated.
    """
    count = len(ob.data.polygons)
    if not any(stack.modifiers_before(ob, end)):
        return np.arange(count, dtype=np.int32)
    mesh = ob.data.copy()
    numbers = mesh.attributes.new(_ATTRIBUTE, "INT", "FACE")
    numbers.data.foreach_set("value", np.arange(1, count + 1, dtype=np.int32))
    with rest.apart(ob, end, frame, mesh) as (copy, view_layer):
        view_layer.update()
        evaluated = copy.evaluated_get(view_layer.depsgraph).data
        found = np.zeros(len(evaluated.polygons), np.int32)
        kept = evaluated.attributes.get(numbers.name)
        if kept is not None and kept.domain == "FACE" and len(found):
            kept.data.foreach_get("value", found)
    return found - 1
