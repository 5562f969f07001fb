"""Drawing on the skin, a little nearer to the viewer than it is drawn itself."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import gpu

# Towards the viewer, as part of the median edge: for skin that is drawn as it is, and for skin that a modifier after
# ours smooths, which then runs up to so far beside it.
BIAS, SMOOTHED_BIAS = 0.02, 0.3
SMOOTHING = frozenset({"SUBSURF", "MULTIRES", "SMOOTH", "CORRECTIVE_SMOOTH", "LAPLACIANSMOOTH", "REMESH", "BEVEL"})


@contextmanager
def over_skin(context: bpy.types.Context, ob: bpy.types.Object, edge_length: float) -> Iterator[None]:
    """Within it what is drawn is in the object's space, transparent, and hidden by what is before it.

    edge_length: median of the mesh, object space.
    """
    bias = (SMOOTHED_BIAS if _is_smoothed(ob) else BIAS) * edge_length * _scale(ob)
    gpu.matrix.push()
    gpu.matrix.push_projection()
    gpu.matrix.load_projection_matrix(_nearer(gpu.matrix.get_projection_matrix(), context.region_data, ob, bias))
    gpu.matrix.multiply_matrix(ob.matrix_world)
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    try:
        yield
    finally:
        gpu.state.color_mask_set(True, True, True, True)
        gpu.state.depth_mask_set(False)
        gpu.state.depth_test_set("NONE")
        gpu.state.blend_set("NONE")
        gpu.matrix.pop_projection()
        gpu.matrix.pop()


def draw_front(batch: gpu.types.GPUBatch, shader: gpu.types.GPUShader) -> None:
    """What of it is nearest first, so that far skin does not shine through near skin."""
    gpu.state.depth_mask_set(True)
    gpu.state.color_mask_set(False, False, False, False)
    batch.draw(shader)
    gpu.state.depth_mask_set(False)
    gpu.state.color_mask_set(True, True, True, True)
    batch.draw(shader)


def _nearer(projection: Any, view: bpy.types.RegionView3D, ob: bpy.types.Object, bias: float) -> Any:
    """The projection with depths as if everything were nearer to the viewer by `bias` where the object is."""
    moved = projection.copy()
    if view.is_perspective:
        distance = -(view.view_matrix @ ob.matrix_world.translation).z
        # z' / w with z -> z (1 - part), w as it is.
        moved[2][3] /= 1.0 - min(bias / max(distance, bias * 2.0), 0.5)
    else:
        moved[2][3] += moved[2][2] * bias
    return moved


def _is_smoothed(ob: bpy.types.Object) -> bool:
    return any(modifier.type in SMOOTHING and modifier.show_viewport for modifier in ob.modifiers)


def _scale(ob: bpy.types.Object) -> float:
    return max(abs(part) for part in ob.matrix_world.to_scale())
