"""The node groups of the modifiers: each adds its carrier's offset to each vertex.

The graph adds nothing where the carrier has another number of vertices than the geometry (changed topology), and
nothing where it is switched off, in the viewport and in renders apart: where the Armature is that it corrects.
"""

from __future__ import annotations

from typing import NamedTuple

import bpy


class Kind(NamedTuple):
    """A modifier of ours."""

    label: str  # of the modifier and of its node group
    mark: str  # custom property that marks the group; its value is the version of the graph below


VOLUME = Kind("Turgor Volume", "turgor_graph")
SPINE = Kind("Turgor Spine", "turgor_spine")
KINDS = {"VOLUME": VOLUME, "SPINE": SPINE}

TICK_GROUP_NAME = "Turgor Tick"
TICK_MARK = "turgor_tick"
GRAPH_VERSION = 1

OFFSET_ATTRIBUTE = "turgor_offset"

# Identifiers are given in order of creation; files refer to them.
GEOMETRY, STRENGTH, CARRIER, IN_VIEWPORT, IN_RENDER = ("Socket_1", "Socket_2", "Socket_3", "Socket_4", "Socket_5")


def is_of_kind(group: bpy.types.NodeTree | None, kind: Kind) -> bool:
    """Whether the extension wrote the group, for this modifier."""
    return group is not None and kind.mark in group


def exists() -> bool:
    """Whether anything of ours can be in the file."""
    return any(kind.mark in group for group in bpy.data.node_groups for kind in KINDS.values())


def ensure(kind: Kind) -> bpy.types.GeometryNodeTree:
    """The local group, written when the file has none."""
    group = _local_group(kind.mark)
    if group is None:
        group = _new_group(kind.label, kind.mark)
        _write_interface(group)
        _write_graph(group)
    return group


def ensure_tick() -> bpy.types.GeometryNodeTree:
    """The group of the carrier's modifier, which changes nothing: without one Blender skips the evaluation."""
    group = _local_group(TICK_MARK)
    if group is None:
        group = _new_group(TICK_GROUP_NAME, TICK_MARK)
        inputs, outputs = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
        group.links.new(inputs.outputs[0], outputs.inputs[0])
    return group


def _local_group(mark: str) -> bpy.types.GeometryNodeTree | None:
    for group in bpy.data.node_groups:
        if group.library is None and group.get(mark) == GRAPH_VERSION:
            return group
    return None


def _new_group(name: str, mark: str) -> bpy.types.GeometryNodeTree:
    group = bpy.data.node_groups.new(name, "GeometryNodeTree")
    group[mark] = GRAPH_VERSION
    group.is_modifier = True
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    return group


def remove_unused() -> None:
    """Local groups of ours that no modifier uses."""
    marks = {TICK_MARK, *(kind.mark for kind in KINDS.values())}
    for group in [group for group in bpy.data.node_groups if marks.intersection(group.keys())]:
        if group.library is None and group.users == 0:
            bpy.data.node_groups.remove(group)


def _write_interface(group: bpy.types.GeometryNodeTree) -> None:
    new_socket = group.interface.new_socket
    strength = new_socket("Strength", in_out="INPUT", socket_type="NodeSocketFloat")
    strength.description = "Part of the effect to show; 0 is the mesh without it"
    strength.subtype = "FACTOR"
    strength.structure_type = "SINGLE"
    strength.force_non_field = True
    strength.min_value, strength.max_value, strength.default_value = 0.0, 1.0, 1.0
    hidden = [new_socket("Carrier", in_out="INPUT", socket_type="NodeSocketObject")]
    for name in ("On in Viewport", "On in Render"):
        socket = new_socket(name, in_out="INPUT", socket_type="NodeSocketBool")
        socket.default_value = True
        hidden.append(socket)
    for socket in hidden:
        socket.hide_in_modifier = True


def _write_graph(group: bpy.types.GeometryNodeTree) -> None:
    def node(kind: str, column: int, row: int, **settings: object) -> bpy.types.Node:
        made = group.nodes.new(kind)
        made.location = (column * 220, -row * 180)
        for name, value in settings.items():
            setattr(made, name, value)
        return made

    def link(source: bpy.types.NodeSocket, *targets: bpy.types.NodeSocket) -> None:
        for target in targets:
            group.links.new(source, target)

    inputs = node("NodeGroupInput", 0, 0)
    carrier = node("GeometryNodeObjectInfo", 1, 1, transform_space="ORIGINAL")
    offset = node("GeometryNodeInputNamedAttribute", 1, 3, data_type="FLOAT_VECTOR")
    offset.inputs["Name"].default_value = OFFSET_ATTRIBUTE
    index = node("GeometryNodeInputIndex", 0, 4)
    # A sum leaves plain numbers: Sample Index of Blender 4.5 reads those faster than what a field makes one by one.
    numbers = node("FunctionNodeIntegerMath", 1, 4, operation="ADD")
    numbers.inputs[1].default_value = 0
    # Nothing is clamped where the counts agree; asking for it is cheaper than having every index looked at.
    sample = node("GeometryNodeSampleIndex", 2, 2, data_type="FLOAT_VECTOR", domain="POINT", clamp=True)
    own_count = node("GeometryNodeAttributeDomainSize", 2, 0, component="MESH")
    carrier_count = node("GeometryNodeAttributeDomainSize", 2, 1, component="MESH")
    counts_agree = node("FunctionNodeCompare", 3, 1, data_type="INT", operation="EQUAL")
    is_viewport = node("GeometryNodeIsViewport", 1, 5)
    is_on = node("GeometryNodeSwitch", 2, 5, input_type="BOOLEAN")
    is_live = node("FunctionNodeBooleanMath", 4, 2, operation="AND")
    factor = node("GeometryNodeSwitch", 5, 2, input_type="FLOAT")
    scaled = node("ShaderNodeVectorMath", 6, 3, operation="SCALE")
    # All of it, the usual case, without a pass over the vertices that changes nothing.
    is_whole = node("FunctionNodeCompare", 6, 2, data_type="FLOAT", operation="EQUAL")
    is_whole.inputs["Epsilon"].default_value = 0.0
    added = node("GeometryNodeSwitch", 7, 2, input_type="VECTOR")
    moved = node("GeometryNodeSetPosition", 8, 0)
    outputs = node("NodeGroupOutput", 9, 0)

    given = {socket.identifier: socket for socket in inputs.outputs}
    link(given[GEOMETRY], own_count.inputs["Geometry"], moved.inputs["Geometry"])
    link(given[CARRIER], carrier.inputs["Object"])
    link(carrier.outputs["Geometry"], sample.inputs["Geometry"], carrier_count.inputs["Geometry"])
    link(_enabled(offset.outputs, "Attribute"), _enabled(sample.inputs, "Value"))
    link(index.outputs["Index"], numbers.inputs[0])
    link(numbers.outputs["Value"], sample.inputs["Index"])
    link(own_count.outputs["Point Count"], _enabled(counts_agree.inputs, "A"))
    link(carrier_count.outputs["Point Count"], _enabled(counts_agree.inputs, "B"))
    link(is_viewport.outputs["Is Viewport"], is_on.inputs["Switch"])
    link(given[IN_RENDER], _enabled(is_on.inputs, "False"))
    link(given[IN_VIEWPORT], _enabled(is_on.inputs, "True"))
    link(counts_agree.outputs["Result"], is_live.inputs[0])
    link(_enabled(is_on.outputs, "Output"), is_live.inputs[1])
    link(is_live.outputs["Boolean"], factor.inputs["Switch"])
    link(given[STRENGTH], _enabled(factor.inputs, "True"))
    link(_enabled(sample.outputs, "Value"), scaled.inputs[0])
    link(_enabled(factor.outputs, "Output"), scaled.inputs["Scale"], _enabled(is_whole.inputs, "A"))
    _enabled(is_whole.inputs, "B").default_value = 1.0
    link(is_whole.outputs["Result"], _enabled(added.inputs, "Switch"))
    link(scaled.outputs["Vector"], _enabled(added.inputs, "False"))
    link(_enabled(sample.outputs, "Value"), _enabled(added.inputs, "True"))
    link(_enabled(added.outputs, "Output"), moved.inputs["Offset"])
    link(moved.outputs["Geometry"], outputs.inputs[0])


def _enabled(sockets: bpy.types.bpy_prop_collection, name: str) -> bpy.types.NodeSocket:
    """Nodes keep one socket per data type under the same name; only that of their type is enabled."""
    return next(socket for socket in sockets if socket.name == name and socket.enabled)
