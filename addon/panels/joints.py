"""The list of joints with the volume each one lost and regained at this frame."""

from __future__ import annotations

import bpy

from .. import runtime
from ..messages import signed_percent

# Losses below this many percent of the rest volume are drawn without emphasis.
NOTABLE_PERCENT = 0.005
# Below this many pixels, at a user interface scale of 1, the list has one column of numbers.
NARROW_WIDTH = 270


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
        name, *numbers = columns(layout, context)
        name.label(text=item.name, icon="ERROR" if figures is not None and figures.is_capped else "NONE")
        if figures is None:
            numbers[-1].label(text="–")
            return
        is_notable = abs(figures.lost) >= NOTABLE_PERCENT
        for cell, value in zip(numbers, (-figures.lost, figures.regained), strict=False):
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


def columns(layout: bpy.types.UILayout, context: bpy.types.Context) -> list[bpy.types.UILayout]:
    """Cells of a line: the joint, what skinning does to its volume, and where there is room what Turgor does."""
    is_narrow = context.region.width < NARROW_WIDTH * context.preferences.system.ui_scale
    split = layout.split(factor=0.6 if is_narrow else 0.55)
    cells = [split.row()]
    numbers = split.row()
    for _ in range(1 if is_narrow else 2):
        cell = numbers.row(align=True)
        cell.alignment = "RIGHT"
        cells.append(cell)
    return cells


def _figures(joint: bpy.types.PropertyGroup) -> runtime.JointFigures | None:
    known = runtime.session.characters.get(joint.id_data.session_uid)
    if known is None or known.figures is None:
        return None
    return known.figures.joints.get(joint.name)
