"""Plain colours that Workbench, EEVEE and Cycles show alike, by material or by vertex."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Vector

from .datablocks import of_kind

Colour = tuple[float, float, float]
"""Linear RGB."""
PAINT = "paint"
"""The colour attribute that painted materials read."""


def make_material(name: str, colour: Colour, roughness: float = 0.6, use_paint: bool = False) -> bpy.types.Material:
    """A material of one colour; `use_paint` takes the rendered colours from `paint` instead."""
    material = bpy.data.materials.new(name)
    setattr(material, "diffuse_color", (*colour, 1.0))  # noqa: B010 (the stubs know no tuples here)
    material.roughness = roughness
    if material.node_tree is None:
        material.use_nodes = True
    tree = of_kind(material.node_tree, bpy.types.NodeTree)
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    set_input(shader, "Base Color", (*colour, 1.0))
    set_input(shader, "Roughness", roughness)
    if use_paint:
        attribute = tree.nodes.new("ShaderNodeVertexColor")
        of_kind(attribute, bpy.types.ShaderNodeVertexColor).layer_name = PAINT
        attribute.location = Vector((-220.0, 250.0))
        tree.links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
    return material


def paint(mesh: bpy.types.Mesh, colours: np.ndarray) -> None:
    """Give each vertex a colour (N, 3)."""
    attribute = of_kind(mesh.color_attributes.new(PAINT, "FLOAT_COLOR", "POINT"), bpy.types.FloatColorAttribute)
    opaque = np.concatenate([colours, np.ones((len(colours), 1))], axis=1)
    attribute.data.foreach_set("color", opaque.astype(np.float32).ravel())
    mesh.color_attributes.active_color = attribute
    mesh.color_attributes.render_color_index = 0


def set_input(node: bpy.types.Node, name: str, value: float | tuple[float, ...]) -> None:
    """Set an unlinked socket; the base class of sockets has no `default_value`."""
    setattr(node.inputs[name], "default_value", value)  # noqa: B010
