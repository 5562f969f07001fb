"""Presets of joints in the asset browser."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..live import joint_presets
from ..logic.joint_preset import PresetError
from ..messages import message, of_error, translated
from ..scene import joint_assets
from .character import EditsJoints, edited

LIBRARY_NAME = "Turgor"
# Written by `make package`.
SHIPPED = Path(__file__).resolve().parents[1] / "assets"


class OBJECT_OT_turgor_joint_asset_add(EditsJoints, bpy.types.Operator):
    bl_idname = "object.turgor_joint_asset_add"
    bl_label = "Save Joint as Asset"
    bl_description = "Keep the settings and curves of the active joint as an asset of this file"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the asset", options={"SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not self.name:
            self.name = edited(context)[0].name
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context: bpy.types.Context) -> set[str]:
        joint = edited(context)[0]
        joint_assets.create(self.name or joint.name, joint_presets.text_of(joint), joint_presets.picture_of(joint))
        return {"FINISHED"}


class OBJECT_OT_turgor_joint_asset_apply(EditsJoints, bpy.types.Operator):
    bl_idname = "object.turgor_joint_asset_apply"
    bl_label = "Apply to Turgor Joint"
    bl_description = "Give the active and the selected joints of the active object the settings of this asset"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    asset: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        asset = context.asset
        self.asset = asset.name
        self.filepath = "" if asset.local_id is not None else asset.full_library_path
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            text = joint_assets.text_of(self.filepath, self.asset)
            if text is None:
                raise PresetError(message("{asset} is no joint of Turgor: choose one tagged Turgor", asset=self.asset))
            joint_presets.apply(text, edited(context))
        except (OSError, PresetError) as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        return {"FINISHED"}


class PREFERENCES_OT_turgor_asset_library(bpy.types.Operator):
    bl_idname = "preferences.turgor_asset_library"
    bl_label = "Add Turgor's Assets"
    bl_description = "Show the joints that ship with Turgor in the asset browser"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not SHIPPED.is_dir():
            cls.poll_message_set("This build of Turgor ships no assets")
            return False
        if any(Path(library.path) == SHIPPED for library in context.preferences.filepaths.asset_libraries):
            cls.poll_message_set("They are shown already")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        context.preferences.filepaths.asset_libraries.new(name=LIBRARY_NAME, directory=str(SHIPPED))
        return {"FINISHED"}


CLASSES = (
    OBJECT_OT_turgor_joint_asset_add,
    OBJECT_OT_turgor_joint_asset_apply,
    PREFERENCES_OT_turgor_asset_library,
)


def draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Add an entry to the context menu of the asset browser, for node trees."""
    asset = context.asset
    if asset is not None and asset.id_type == "NODETREE":
        menu.layout.separator()
        menu.layout.operator(OBJECT_OT_turgor_joint_asset_apply.bl_idname)


def register() -> None:
    bpy.types.ASSETBROWSER_MT_context_menu.append(draw)


def unregister() -> None:
    bpy.types.ASSETBROWSER_MT_context_menu.remove(draw)
