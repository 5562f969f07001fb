"""The carrier: a local object outside every scene, with one vertex per vertex of the stack at its modifier.

Its attribute is zero in saved files, so that a file opened without the extension shows the mesh without ours.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import bpy
import numpy as np
from numpy.typing import NDArray

from . import drivers, modifier_inputs, node_group, stack


def carriers() -> Iterator[bpy.types.Object]:
    """All carriers of the file, with or without a target."""
    for ob in bpy.data.objects:
        if is_carrier(ob):
            yield ob


def is_carrier(ob: bpy.types.Object) -> bool:
    """Whether the object is one of ours that hold offsets."""
    return ob.turgor.carrier.mesh is not None


def kind_of(carrier: bpy.types.Object) -> node_group.Kind:
    """The kind of modifier that reads it."""
    return node_group.KINDS[carrier.turgor.carrier.kind]


def carrier_of(ob: bpy.types.Object, kind: node_group.Kind = node_group.VOLUME) -> bpy.types.Object | None:
    """The carrier that the object's modifier reads, which after Shift-D is still that of the original."""
    ours = stack.own_modifier(ob, kind)
    if ours is None or not modifier_inputs.has_input(ours, node_group.CARRIER):
        return None
    return modifier_inputs.read_input(ours, node_group.CARRIER)


def create(target: bpy.types.Object, kind: node_group.Kind = node_group.VOLUME) -> bpy.types.Object:
    """A carrier without vertices."""
    mesh = bpy.data.meshes.new(f"{kind.label} {target.name}")
    carrier = bpy.data.objects.new(mesh.name, mesh)
    carrier.modifiers.new(drivers.TICK_MODIFIER, "NODES").node_group = node_group.ensure_tick()
    carrier.turgor.carrier.mesh = mesh
    carrier.turgor.carrier.target = target
    carrier.turgor.carrier.kind = next(name for name, known in node_group.KINDS.items() if known == kind)
    resize(carrier, 0)
    return carrier


def assign(target: bpy.types.Object, carrier: bpy.types.Object) -> None:
    """Let the object's modifier read this carrier."""
    modifier_inputs.write_input(stack.own_modifier(target, kind_of(carrier)), node_group.CARRIER, carrier)
    target.update_tag()


def give_own_meshes(holders: Iterable[bpy.types.Object]) -> None:
    """A mesh of its own for each of these carriers that may be written and shares one.

    Overrides of a linked character share the linked mesh: Blender would let each show the offsets of whichever was
    evaluated last. Binding lets the carrier's driver wait for the new mesh.
    """
    taken: set[bpy.types.Mesh] = set()
    for holder in holders:
        mesh = holder.turgor.carrier.mesh
        if holder.library is None and (mesh.library is not None or mesh in taken or holder.data != mesh):
            own = mesh.copy()
            holder.data = holder.turgor.carrier.mesh = own
            mesh = own
        taken.add(mesh)


def resize(carrier: bpy.types.Object, vertex_count: int) -> None:
    """Zero offsets for so many vertices; nothing happens when there are as many."""
    mesh = carrier.data
    if len(mesh.vertices) == vertex_count and node_group.OFFSET_ATTRIBUTE in mesh.attributes:
        return
    mesh.clear_geometry()
    mesh.vertices.add(vertex_count)
    mesh.attributes.new(node_group.OFFSET_ATTRIBUTE, "FLOAT_VECTOR", "POINT")


def remove(carrier: bpy.types.Object) -> None:
    """Delete a carrier with its mesh."""
    mesh = carrier.turgor.carrier.mesh
    bpy.data.objects.remove(carrier)
    if mesh is not None and mesh.users == 0:
        bpy.data.meshes.remove(mesh)


def is_orphan(carrier: bpy.types.Object) -> bool:
    """Local, and its character is gone, was deleted from every scene, or no longer reads it."""
    target = carrier.turgor.carrier.target
    if carrier.library is not None or carrier.override_library is not None:
        return False
    if target is None or carrier_of(target, kind_of(carrier)) != carrier:
        return True
    is_only_ours = target.users == 1 and not target.use_fake_user
    return is_only_ours and not target.users_collection


def offsets_address(mesh: bpy.types.Mesh) -> tuple[int, int]:
    """Where the evaluated offsets lie now, and for how many vertices; (0, 0) without any.

    Asking for the address makes the layer private to this evaluation. Never keep it: it is good for one write.
    """
    attribute = mesh.attributes.get(node_group.OFFSET_ATTRIBUTE)
    if attribute is None or len(attribute.data) == 0:
        return 0, 0
    return attribute.data[0].as_pointer(), len(attribute.data)


def read_offsets(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """(N, 3) object space."""
    attribute = mesh.attributes[node_group.OFFSET_ATTRIBUTE]
    offsets = np.empty((len(attribute.data), 3), np.float32)
    attribute.data.foreach_get("vector", offsets.ravel())
    return offsets


def write_offsets(mesh: bpy.types.Mesh, offsets: NDArray[np.float32]) -> None:
    """Write the original attribute, (N, 3) object space, and have the carrier evaluated again."""
    mesh.attributes[node_group.OFFSET_ATTRIBUTE].data.foreach_set("vector", offsets.ravel())
    mesh.update_tag()
