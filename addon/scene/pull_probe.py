"""A character of one vertex in a scene of its own, to see whether a tick reaches the evaluated mesh."""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from . import carrier, drivers, node_group, rest


class Reading(NamedTuple):
    """(1, 3) each."""

    evaluated: NDArray[np.float32]  # position of the vertex, at rest in the origin
    original: NDArray[np.float32]  # saved offset, which must stay zero


def read_probe() -> Reading:
    """Evaluate the probe once and remove it."""
    mesh = bpy.data.meshes.new("Turgor Probe")
    mesh.vertices.add(1)
    probe = bpy.data.objects.new(mesh.name, mesh)
    scene = bpy.data.scenes.new(mesh.name)
    holder = carrier.create(probe)
    try:
        scene.collection.objects.link(probe)
        probe.modifiers.new(node_group.VOLUME.label, "NODES").node_group = node_group.ensure(node_group.VOLUME)
        carrier.assign(probe, holder)
        carrier.resize(holder, 1)
        drivers.write_tick(holder, ())
        view_layer = scene.view_layers[0]
        view_layer.update()
        evaluated = probe.evaluated_get(view_layer.depsgraph).data
        return Reading(rest.read_positions(evaluated), carrier.read_offsets(holder.data))
    finally:
        bpy.data.scenes.remove(scene)
        carrier.remove(holder)
        bpy.data.objects.remove(probe)
        bpy.data.meshes.remove(mesh)
