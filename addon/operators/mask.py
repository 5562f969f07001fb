"""Paint a mask: make its vertex group where there is none, and go to Weight Paint on it."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_data as data_
from bpy.props import EnumProperty

from ..messages import message
from .polling import hidden, is_allowed, linked, linked_mesh, without_volume

MASKS = (
    ("vertex_group", "Mask", "Where volume may come back"),
    ("pin_group", "Pin", "Vertices that stay where skinning puts them"),
)
NAMES = {"vertex_group": "Turgor Mask", "pin_group": "Turgor Pin"}


class OBJECT_OT_turgor_mask_paint(bpy.types.Operator):
    bl_idname = "object.turgor_mask_paint"
    bl_label = "Paint Mask"
    bl_description = "Paint the mask in Weight Paint; the mesh follows the brush"
    bl_options = {"REGISTER", "UNDO"}

    mask: EnumProperty(name="Mask", items=MASKS, options={"SKIP_SAVE"})

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        if getattr(context.object.turgor, properties.mask) in context.object.vertex_groups:
            return "Paint this vertex group in Weight Paint; the mesh follows the brush"
        if properties.mask == "pin_group":
            return "Make a vertex group that pins nothing yet, and paint it in Weight Paint; the mesh follows the brush"
        return "Make a vertex group of all vertices, and paint it in Weight Paint; the mesh follows the brush"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        elsewhere = message("The mesh is linked: paint it in its own file")
        return is_allowed(cls, without_volume(ob) or linked(ob) or linked_mesh(ob, elsewhere) or hidden(ob))

    def execute(self, context: bpy.types.Context) -> set[str]:
        ob = context.object
        saved = ob.turgor
        group = ob.vertex_groups.get(getattr(saved, self.mask))
        if group is None:
            # Weights cannot be given in the mode that changes vertices.
            if ob.mode == "EDIT":
                bpy.ops.object.mode_set(mode="OBJECT")
            group = ob.vertex_groups.new(name=data_(NAMES[self.mask]))
            # Where the mask says nothing yet, nothing changes.
            if self.mask == "vertex_group" and not saved.invert_vertex_group:
                group.add(range(len(ob.data.vertices)), 1.0, "REPLACE")
            setattr(saved, self.mask, group.name)
        ob.vertex_groups.active = group
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_mask_paint,)
