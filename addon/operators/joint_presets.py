"""Presets of joints: files of Blender's preset system, the user's own and those that ship with the extension."""

from __future__ import annotations

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..live import joint_presets
from ..logic import whole_file
from ..logic.joint_preset import PresetError
from ..messages import of_error, translated
from .character import EditsJoints, edited

SUBDIRECTORY = "turgor/joint"
# Blender searches it for presets/SUBDIRECTORY.
SHIPPED = str(Path(__file__).resolve().parents[1])


class OBJECT_OT_turgor_joint_preset(EditsJoints, bpy.types.Operator):
    bl_idname = "object.turgor_joint_preset"
    bl_label = "Use Joint Preset"
    bl_description = "Give the active and the selected joints the settings and curves of this preset"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    # Blender's preset menus hand it over.
    menu_idname: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            joint_presets.apply(Path(self.filepath).read_text(encoding="utf-8", errors="replace"), edited(context))
        except (OSError, PresetError) as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        return {"FINISHED"}


class OBJECT_OT_turgor_joint_preset_add(EditsJoints, AddPresetBase, bpy.types.Operator):
    bl_idname = "object.turgor_joint_preset_add"
    bl_label = "Add Joint Preset"
    bl_description = "Keep the settings and curves of the active joint as a preset, or remove one"
    preset_menu = "TURGOR_PT_joint_presets"
    preset_subdir = SUBDIRECTORY

    def add(self, context: bpy.types.Context, filepath: str) -> None:
        """Write the active joint's settings; called by Blender's base class in place of its own writing."""
        with whole_file.written(Path(filepath)) as file:
            file.write(joint_presets.text_of(edited(context)[0]).encode())

    def remove(self, context: bpy.types.Context, filepath: str) -> None:
        """Delete a preset, if it is the user's own; called by Blender's base class in place of its own removing."""
        if Path(filepath).is_relative_to(SHIPPED):
            self.report({"WARNING"}, "Presets that ship with Turgor stay: remove your own ones")
        else:
            Path(filepath).unlink()


CLASSES = (
    OBJECT_OT_turgor_joint_preset,
    OBJECT_OT_turgor_joint_preset_add,
)


def register() -> None:
    bpy.utils.register_preset_path(SHIPPED)


def unregister() -> None:
    bpy.utils.unregister_preset_path(SHIPPED)
