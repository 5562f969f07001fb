"""Weights of single vertex groups, as the stack before a modifier gives them: fast enough for every dab of a brush.

Geometry Nodes write the groups into attributes, which are read as whole arrays; reading `vertices` or a bmesh takes a
hundred times as long.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np
from numpy.typing import NDArray

from . import rest

_ATTRIBUTE = "turgor_group_{}"


def read_groups(
    ob: bpy.types.Object, end: bpy.types.Modifier | None, frame: int, names: Sequence[str]
) -> NDArray[np.float32]:
    """(len(names), N) at rest before `end`, at `frame`; 0 where a vertex is not in the group, which exists."""
    with _reader(names) as group, rest.apart(ob, end, frame, ob.data) as (copy, view_layer):
        copy.modifiers.new("Groups", "NODES").node_group = group
        view_layer.update()
        evaluated = copy.evaluated_get(view_layer.depsgraph).data
        weights = np.zeros((len(names), len(evaluated.vertices)), np.float32)
        for index, row in enumerate(weights):
            attribute = evaluated.attributes.get(_ATTRIBUTE.format(index))
            if attribute is not None and len(row):
                attribute.data.foreach_get("value", row)
    return weights


@contextmanager
def _reader(names: Sequence[str]) -> Iterator[bpy.types.GeometryNodeTree]:
    group = bpy.data.node_groups.new("Turgor Groups", "GeometryNodeTree")
    try:
        group.is_modifier = True
        for in_out in ("OUTPUT", "INPUT"):
            group.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
        last = group.nodes.new("NodeGroupInput").outputs[0]
        for index, name in enumerate(names):
            read = group.nodes.new("GeometryNodeInputNamedAttribute")
            store = group.nodes.new("GeometryNodeStoreNamedAttribute")
            read.inputs["Name"].default_value = name
            store.inputs["Name"].default_value = _ATTRIBUTE.format(index)
            group.links.new(last, store.inputs[0])
            weight = next(socket for socket in read.outputs if socket.name == "Attribute" and socket.enabled)
            group.links.new(weight, next(s for s in store.inputs if s.name == "Value" and s.enabled))
            last = store.outputs[0]
        group.links.new(last, group.nodes.new("NodeGroupOutput").inputs[0])
        yield group
    finally:
        bpy.data.node_groups.remove(group)
