"""The list of joints: the volume each one loses, who is heard, who is edited together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_iface as iface_

from .. import runtime
from ..messages import signed_percent
from ..properties.character import TurgorObject
from ..properties.joint import TurgorJoint
from ..properties.joint_names import label
from ..properties.saved import volume_settings

if TYPE_CHECKING:
    from ..logic.character_figures import JointFigures

# Losses below this many percent of the rest volume are drawn without emphasis.
NOTABLE_PERCENT = 0.005
# Below this many pixels, at a user interface scale of 1, the list has one column of numbers.
NARROW_WIDTH = 400
# What a row has before and after its columns, the list's scroll bar included, in widgets; the header above, in
# separators.
TICK_WIDTH = 1.4
SWITCHES_WIDTH = 3.2
HEADER_HEIGHT = 3.2

ORDERS = (
    ("MOTION", "Volume Lost over Frames", "Joints that lose most volume in the measured motion first"),
    ("NOW", "Volume Lost Now", "Joints that lose most volume at this frame first"),
    ("NAME", "Name", "By the name of the bone"),
    ("HIERARCHY", "Hierarchy", "Parents first, as the bones stand in the armature"),
)


class TURGOR_UL_joints(bpy.types.UIList):
    order: bpy.props.EnumProperty(name="Sort by", description="Order of the joints", items=ORDERS)
    use_all: bpy.props.BoolProperty(
        name="Show All", description="Show joints that lose no volume too, at this frame or in the measured motion"
    )

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        data: object,
        item: TurgorJoint,
        icon: int | None,
        active_data: object,
        active_property: str | None,
        index: int | None = 0,
        flt_flag: int | None = 0,
    ) -> None:
        figures = (_figures(item.id_data) or {}).get(item.name)
        row = layout.row(align=True)
        row.prop(item, "select", text="")
        name, *numbers = columns(row, context)
        is_capped = figures is not None and figures.is_capped
        name.label(text=label(item.name, iface_), translate=False, icon="ERROR" if is_capped else "NONE")
        _draw_numbers(numbers, figures)
        switches = row.row(align=True)
        switches.prop(item, "is_solo", text="", icon="SOLO_ON" if item.is_solo else "SOLO_OFF", emboss=False)
        switches.prop(item, "mute", text="", icon="HIDE_ON" if item.mute else "HIDE_OFF", emboss=False)

    def draw_filter(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        row = layout.row(align=True)
        row.prop(self, "filter_name", text="")
        row.prop(self, "use_filter_invert", text="", icon="ARROW_LEFTRIGHT")
        row.separator()
        row.prop(self, "order", text="", icon="SORTSIZE")
        row.prop(self, "use_filter_sort_reverse", text="", icon="SORT_ASC")
        row.separator()
        row.prop(self, "use_all", text="", icon="HIDE_OFF")

    def filter_items(
        self, context: bpy.types.Context, data: TurgorObject, property: str
    ) -> tuple[list[int], list[int]]:
        """Joints that matter, of bones that are in the rig now."""
        joints = getattr(data, property)
        count = len(joints)
        figures = _figures(data.id_data)
        flags = [self.bitflag_filter_item] * count
        if self.filter_name:
            found = bpy.types.UI_UL_list.filter_items_by_name(
                self.filter_name, self.bitflag_filter_item, joints, reverse=self.use_filter_invert
            )
            flags = found or flags
        names = [joint.name for joint in joints]
        peaks = [0.0] * count
        joints.foreach_get("peak_loss", peaks)
        if figures is not None:
            flags = [flag if name in figures else 0 for flag, name in zip(flags, names, strict=True)]
        losses = [abs(figures[name].lost) if figures and name in figures else 0.0 for name in names]
        if not (self.use_all or self.filter_name):
            is_marked = _marked(joints, data.active_joint)
            flags = [
                flag if marked or not 0.0 <= peak < NOTABLE_PERCENT or loss >= NOTABLE_PERCENT else 0
                for flag, marked, peak, loss in zip(flags, is_marked, peaks, losses, strict=True)
            ]
        keys = {"MOTION": [-peak for peak in peaks], "NOW": [-loss for loss in losses], "NAME": names}.get(self.order)
        if keys is None:
            return flags, []
        return flags, _places(keys)


def columns(layout: bpy.types.UILayout, context: bpy.types.Context) -> list[bpy.types.UILayout]:
    """Cells of a line: the joint, what skinning does to its volume, and where there is room what Turgor does."""
    is_narrow = context.region.width < NARROW_WIDTH * context.preferences.system.ui_scale
    split = layout.split(factor=0.68 if is_narrow else 0.5)
    cells = [split.row()]
    numbers = split.row()
    for _ in range(1 if is_narrow else 2):
        cell = numbers.row(align=True)
        cell.alignment = "RIGHT"
        cells.append(cell)
    return cells


def draw_joints(layout: bpy.types.UILayout, context: bpy.types.Context, ob: bpy.types.Object) -> None:
    """The list with its header, and the buttons beside it."""
    row = layout.row()
    column = row.column(align=True)
    _draw_header(column, context)
    saved = volume_settings(ob)
    column.template_list("TURGOR_UL_joints", "", saved, "joints", saved, "active_joint", rows=6)
    beside = row.column(align=True)
    beside.separator(factor=HEADER_HEIGHT)
    beside.menu("TURGOR_MT_joints", text="", icon="DOWNARROW_HLT")
    beside.separator()
    beside.operator("object.turgor_volume_measure", text="", icon="TIME")
    beside.separator()
    beside.operator("object.turgor_joints_mirror", text="", icon="MOD_MIRROR")
    beside.operator("object.turgor_joint_to_bone", text="", icon="RESTRICT_SELECT_OFF")


class TURGOR_MT_joints(bpy.types.Menu):
    bl_label = "Joints"
    bl_idname = "TURGOR_MT_joints"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("object.turgor_joints_copy", icon="COPYDOWN")
        layout.operator("object.turgor_joints_mirror", icon="MOD_MIRROR")
        layout.operator("object.turgor_joints_reset", icon="LOOP_BACK")
        layout.separator()
        for action, text in (("ALL", "Select All"), ("NONE", "Select None"), ("INVERT", "Invert Selection")):
            layout.operator("object.turgor_joints_select", text=text).action = action
        layout.separator()
        layout.operator("object.turgor_joint_to_bone", icon="BONE_DATA")
        layout.operator("object.turgor_joint_from_bone")
        layout.separator()
        layout.operator("object.turgor_joint_asset_add", icon="ASSET_MANAGER")
        layout.operator("object.turgor_volume_measure", icon="TIME")


CLASSES = (
    TURGOR_UL_joints,
    TURGOR_MT_joints,
)


def _draw_header(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    header = layout.row(align=True)
    header.active = False
    _draw_gap(header, TICK_WIDTH)
    name, *numbers = columns(header, context)
    name.label(text="Joint")
    if len(numbers) == 1:
        numbers[0].label(text="%", translate=False)
    else:
        for cell, text in zip(numbers, ("Skinning", "Turgor"), strict=True):
            cell.label(text=text)
    _draw_gap(header, SWITCHES_WIDTH)


def _draw_gap(row: bpy.types.UILayout, width: float) -> None:
    gap = row.row()
    gap.ui_units_x = width
    gap.label()


def _draw_numbers(cells: list[bpy.types.UILayout], figures: JointFigures | None) -> None:
    if figures is None:
        cells[-1].label(text="–")
        return
    is_notable = abs(figures.lost) >= NOTABLE_PERCENT
    for cell, value in zip(cells, (-figures.lost, figures.regained), strict=False):
        cell.active = is_notable
        text = signed_percent(value, 2)
        cell.label(text=text.removesuffix(" %") if len(cells) == 1 else text, translate=False)


def _marked(joints: bpy.types.bpy_prop_collection[TurgorJoint], active: int) -> list[bool]:
    """Whether the artist has taken up each joint: selected, solo, muted or active."""
    marks = [False] * len(joints)
    for name in ("select", "is_solo", "mute"):
        flags = [False] * len(joints)
        joints.foreach_get(name, flags)
        marks = [mark or flag for mark, flag in zip(marks, flags, strict=True)]
    if 0 <= active < len(marks):
        marks[active] = True
    return marks


def _places(keys: list[float] | list[str]) -> list[int]:
    """Where each of the keys stands when they are sorted."""
    places = [0] * len(keys)
    for order, place in enumerate(sorted(range(len(keys)), key=keys.__getitem__)):
        places[place] = order
    return places


def _figures(ob: bpy.types.Object) -> dict[str, JointFigures] | None:
    character = runtime.session.characters.get(ob.session_uid)
    figures = None if character is None else character.figures
    return None if figures is None else figures.joints
