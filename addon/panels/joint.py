"""Settings of the active joint."""

from __future__ import annotations

import bpy

from .volume import PARENT_PANEL, has_volume


class TURGOR_PT_joint(bpy.types.Panel):
    bl_label = ""
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "modifier"
    bl_parent_id = PARENT_PANEL

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_volume(context.object) and _active(context.object) is not None

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.label(text=_active(context.object).name, icon="BONE_DATA")

    def draw(self, context: bpy.types.Context) -> None:
        joint = _active(context.object)
        layout = self.layout
        layout.use_property_split = True
        layout.prop(joint, "preset")
        layout.prop(joint, "strength")
        layout.prop(joint, "size")
        layout.prop(joint, "use_auto_shares")
        if not joint.use_auto_shares:
            column = layout.column(align=True)
            for index, name in enumerate(("Along Bone", "Sideways", "Inside")):
                column.prop(joint, "shares", index=index, text=name, slider=True)


def _active(ob: bpy.types.Object) -> bpy.types.PropertyGroup | None:
    joints = ob.turgor.joints
    return joints[ob.turgor.active_joint] if 0 <= ob.turgor.active_joint < len(joints) else None
