"""Presets of joints, as a popover in the header of the joint's settings."""

from __future__ import annotations

import bpy
from bl_ui.utils import PresetPanel


class TURGOR_PT_joint_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Joint Presets"
    preset_subdir = "turgor/joint"
    preset_operator = "object.turgor_joint_preset"
    preset_add_operator = "object.turgor_joint_preset_add"


CLASSES = (TURGOR_PT_joint_presets,)
