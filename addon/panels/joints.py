"""The list of joints with the volume each one lost and regained at this frame."""

from __future__ import annotations

import bpy

from .. import runtime
from .percent import signed_percent

# Losses below this many percent of the rest volume are drawn without emphasis.
NOTABLE_PERCENT = 0.005


class TURGOR_UL_joints(bpy.types.UIList):
    use_order_loss: bpy.props.BoolProperty(
        name="Sort by Volume Lost", description="Joints that lose most volume at this frame first", default=True
    )

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        data: object,
        item: bpy.types.PropertyGroup,
        icon: int | None,
        active_data: object,
        active_property: str | None,
        index: int | None = 0,
        flt_flag: int | None = 0,
    ) -> None:
        figures = _figures(item)
        name, by_skinning, by_turgor = columns(layout)
        name.label(text=item.name, icon="ERROR" if figures is not None and figures.is_capped else "NONE")
        if figures is None:
            by_turgor.label(text="–")
            return
        is_notable = abs(figures.lost) >= NOTABLE_PERCENT
        for cell, value in ((by_skinning, -figures.lost), (by_turgor, figures.regained)):
            cell.active = is_notable
            cell.label(text=signed_percent(value, 2))

    def draw_filter(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        row = layout.row(align=True)
        row.prop(self, "filter_name", text="")
        row.prop(self, "use_filter_invert", text="", icon="ARROW_LEFTRIGHT")
        row.separator()
        row.prop(self, "use_order_loss", text="", icon="SORT_DESC")

    def filter_items(
        self, context: bpy.types.Context, data: bpy.types.AnyType, property: str
    ) -> tuple[list[int], list[int]]:
        """Joints of bones that are in the rig now, by loss or by name."""
        joints = getattr(data, property)
        figures = [_figures(joint) for joint in joints]
        has_figures = any(found is not None for found in figures)
        flags = [self.bitflag_filter_item] * len(joints)
        if self.filter_name:
            flags = bpy.types.UI_UL_list.filter_items_by_name(
                self.filter_name, self.bitflag_filter_item, joints, reverse=self.use_filter_invert
            )
        if has_figures:
            flags = [flag if found is not None else 0 for flag, found in zip(flags, figures, strict=True)]
        if not self.use_order_loss:
            return flags, []
        keys = [(-abs(found.lost) if found else 0.0, place) for place, found in enumerate(figures)]
        places = {place: order for order, (_, place) in enumerate(sorted(keys))}
        return flags, [places[place] for place in range(len(joints))]


def columns(layout: bpy.types.UILayout) -> tuple[bpy.types.UILayout, bpy.types.UILayout, bpy.types.UILayout]:
    """Cells of a line: the joint, what skinning does to its volume, what Turgor does; the last two right-aligned."""
    name, numbers = (split := layout.split(factor=0.55)).row(), split.row()
    by_skinning, by_turgor = (numbers.row(align=True) for _ in range(2))
    by_skinning.alignment = by_turgor.alignment = "RIGHT"
    return name, by_skinning, by_turgor


def _figures(joint: bpy.types.PropertyGroup) -> runtime.JointFigures | None:
    known = runtime.session.characters.get(joint.id_data.session_uid)
    if known is None or known.figures is None:
        return None
    return known.figures.joints.get(joint.name)
