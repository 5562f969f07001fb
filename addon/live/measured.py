"""Whether the mesh that Blender makes has the volume that was computed: measured in float64, beside the solver."""

from __future__ import annotations

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from ..logic import stack_volumes
from ..logic.character_figures import SpineFigures, VolumeFigures
from ..logic.finding import Finding
from ..messages import message, signed_percent
from ..scene import modifier_inputs, node_group, shown_mesh, spine_stack, stack
from ..states import SpineBinding
from . import findings


def of_volume(
    target: bpy.types.Object, mesh: turgor.Mesh, figures: VolumeFigures, positions: NDArray[np.float32]
) -> tuple[Finding, ...]:
    """An error where the mesh right after Turgor Volume has another volume than was computed.

    positions: (N, 3) of that mesh, object space. Single precision explains as much as `stack_volumes.rounding_volume`.
    """
    computed = figures.computed_volumes
    if computed is None or len(positions) != mesh.vertex_count or not np.isfinite(positions).all():
        return ()
    measured = mesh.component_volumes(positions)
    reach = figures.reach + float(np.abs(positions).max(initial=0.0))
    if np.abs(measured - computed).sum() <= stack_volumes.rounding_volume(mesh, positions, reach):
        return ()
    percents = [_percent(float(np.abs(each).sum()), figures.target_volume) for each in (measured, computed)]
    return (_finding(target, stack.volume_modifier(target), *percents),)


def of_spine(target: bpy.types.Object, bound: SpineBinding, figures: SpineFigures) -> tuple[Finding, ...]:
    """The same of Turgor Spine, where nothing stands after it."""
    ours, mesh = spine_stack.spine_modifier(target), bound.flesh.mesh
    if ours is None or mesh is None or figures.shown_deviation is None or figures.kept_deviation is None:
        return ()
    if not ours.show_viewport or modifier_inputs.read_input(ours, node_group.STRENGTH) != 1.0:
        return ()
    modifiers = list(target.modifiers)
    positions = shown_mesh.positions(target)
    if positions is None or any(each.show_viewport for each in modifiers[modifiers.index(ours) + 1 :]):
        return ()
    most = stack_volumes.rounding_volume(mesh, positions, float(np.abs(positions).max(initial=0.0)))
    volume = float(np.abs(mesh.component_volumes(positions)).sum())
    computed = volume * (1.0 + 0.01 * figures.kept_deviation) / (1.0 + 0.01 * figures.shown_deviation)
    if abs(volume - computed) <= most:
        return ()
    return (_finding(target, ours, figures.shown_deviation, figures.kept_deviation),)


def spine_volumes(target: bpy.types.Object | None, bound: SpineBinding) -> NDArray[np.float64] | None:
    """(K,) volumes of the shells of the mesh that is shown, after all modifiers; None where they are other ones."""
    mesh = bound.flesh.mesh
    positions = None if target is None or mesh is None else shown_mesh.positions(target)
    if mesh is None or positions is None or len(positions) != mesh.vertex_count or not np.isfinite(positions).all():
        return None
    return mesh.component_volumes(positions)


def _percent(volume: float, target_volume: float) -> float:
    return 100.0 * (volume / target_volume - 1.0) if target_volume > 0.0 else 0.0


def _finding(target: bpy.types.Object, ours: bpy.types.Modifier, measured: float, computed: float) -> Finding:
    text = message(
        "The mesh has another volume than was computed: measured {measured}, computed {computed}; something else moves"
        " its vertices, or the node group of {modifier} was edited",
        measured=signed_percent(measured, 4),
        computed=signed_percent(computed, 4),
        modifier=ours.name,
    )
    return findings.finding(target, "ERROR", "measured_volume", text)
