"""Stiffness in the Deform panel of a bone."""

from __future__ import annotations

import bpy


def draw(panel: bpy.types.Panel, context: bpy.types.Context) -> None:
    bone = context.bone or context.edit_bone
    if bone is not None:
        column = panel.layout.column()
        column.use_property_split = True
        column.active = bone.use_deform
        column.prop(bone, "turgor_stiffness")


def register() -> None:
    bpy.types.BONE_PT_deform.append(draw)


def unregister() -> None:
    bpy.types.BONE_PT_deform.remove(draw)
