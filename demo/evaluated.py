"""Reads meshes as Blender's dependency graph evaluates them, as whole arrays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from .enclosed_volume import Indices, Points, Shells, shells


def evaluated(mesh_object: bpy.types.Object) -> bpy.types.Object:
    """The object as the current frame shows it."""
    return mesh_object.evaluated_get(bpy.context.evaluated_depsgraph_get())


def positions(mesh_object: bpy.types.Object) -> Points:
    """(N, 3) vertices of the evaluated mesh, object space."""
    mesh = evaluated(mesh_object).data
    values = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.attributes["position"].data.foreach_get("vector", values.ravel())
    return values.astype(np.float64)


def faces(mesh_object: bpy.types.Object) -> tuple[Indices, Indices]:
    """Sizes of the faces and vertices of their corners, of the evaluated mesh."""
    mesh = evaluated(mesh_object).data
    sizes = np.empty(len(mesh.polygons), dtype=np.intc)
    corners = np.empty(len(mesh.loops), dtype=np.intc)
    mesh.polygons.foreach_get("loop_total", sizes)
    mesh.loops.foreach_get("vertex_index", corners)
    return sizes.astype(np.intp), corners.astype(np.intp)


def undeformed_shells(mesh_object: bpy.types.Object) -> Shells:
    """The shells of the mesh where the armature receives it: after a Mirror before it, for instance."""
    with only_modifiers_before(mesh_object, armature_modifier(mesh_object)):
        return shells(positions(mesh_object), *faces(mesh_object))


def armature_modifier(mesh_object: bpy.types.Object) -> bpy.types.Modifier:
    """The last Armature modifier that is shown."""
    return [item for item in mesh_object.modifiers if item.type == "ARMATURE" and item.show_viewport][-1]


def modifier_after(mesh_object: bpy.types.Object, modifier: bpy.types.Modifier) -> bpy.types.Modifier | None:
    """The next modifier in the stack."""
    place = list(mesh_object.modifiers).index(modifier) + 1
    return mesh_object.modifiers[place] if place < len(mesh_object.modifiers) else None


@contextmanager
def only_modifiers_before(mesh_object: bpy.types.Object, end: bpy.types.Modifier | None) -> Iterator[None]:
    """Within it, `end` and every modifier after it are off in the viewport; None: nothing is off."""
    names = [modifier.name for modifier in mesh_object.modifiers]
    later = [] if end is None else [mesh_object.modifiers[name] for name in names[names.index(end.name) :]]
    shown = [(modifier, modifier.show_viewport) for modifier in later]
    for modifier, _ in shown:
        modifier.show_viewport = False
    bpy.context.view_layer.update()
    try:
        yield
    finally:
        for modifier, was_shown in shown:
            modifier.show_viewport = was_shown
        bpy.context.view_layer.update()
