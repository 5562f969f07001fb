"""All classes and handlers, registered in order and undone in reverse."""

from __future__ import annotations

import bpy

from . import handlers, properties, translations
from .commands import command_line
from .operators import joint_assets, joint_presets, weights
from .operators.add import OBJECT_OT_turgor_volume_add
from .operators.add import draw as draw_add
from .operators.bake import OBJECT_OT_turgor_bake, OBJECT_OT_turgor_bake_remove
from .operators.curves import OBJECT_OT_turgor_curves_reset
from .operators.export import CLASSES as EXPORT_CLASSES
from .operators.export import draw as draw_export
from .operators.fix import OBJECT_OT_turgor_volume_fix
from .operators.fold_loss import OBJECT_OT_turgor_fold_loss_measure
from .operators.joints import CLASSES as JOINT_OPERATORS
from .operators.mask import OBJECT_OT_turgor_mask_paint
from .operators.measure import OBJECT_OT_turgor_volume_measure
from .operators.rebind import OBJECT_OT_turgor_volume_rebind
from .operators.refine import OBJECT_OT_turgor_refine
from .operators.remove import OBJECT_OT_turgor_volume_remove
from .operators.spine import OBJECT_OT_turgor_spine_add, OBJECT_OT_turgor_spine_rebind, OBJECT_OT_turgor_spine_remove
from .operators.spine import draw as draw_add_spine
from .overlays import spine as spine_overlay
from .overlays import volume as volume_overlay
from .panels import bone as bone_panel
from .panels.bake import TURGOR_PT_bake, TURGOR_PT_baked, TURGOR_PT_spine_bake
from .panels.curves import TURGOR_PT_curves
from .panels.display import TURGOR_PT_display, TURGOR_PT_performance
from .panels.joint_presets import TURGOR_PT_joint_presets
from .panels.joints import TURGOR_MT_joints, TURGOR_UL_joints
from .panels.masks import TURGOR_PT_masks
from .panels.refine import TURGOR_PT_refine
from .panels.sidebar import TURGOR_PT_sidebar
from .panels.spine import TURGOR_PT_spine, TURGOR_PT_spine_settings
from .panels.volume import TURGOR_PT_settings, TURGOR_PT_volume

CLASSES = (
    OBJECT_OT_turgor_volume_add,
    OBJECT_OT_turgor_volume_remove,
    OBJECT_OT_turgor_volume_rebind,
    OBJECT_OT_turgor_curves_reset,
    OBJECT_OT_turgor_fold_loss_measure,
    OBJECT_OT_turgor_spine_add,
    OBJECT_OT_turgor_spine_remove,
    OBJECT_OT_turgor_spine_rebind,
    OBJECT_OT_turgor_volume_fix,
    OBJECT_OT_turgor_volume_measure,
    *JOINT_OPERATORS,
    *EXPORT_CLASSES,
    OBJECT_OT_turgor_mask_paint,
    OBJECT_OT_turgor_bake,
    OBJECT_OT_turgor_bake_remove,
    joint_presets.OBJECT_OT_turgor_joint_preset,
    joint_presets.OBJECT_OT_turgor_joint_preset_add,
    *joint_assets.CLASSES,
    *weights.CLASSES,
    OBJECT_OT_turgor_refine,
    TURGOR_PT_joint_presets,
    TURGOR_UL_joints,
    TURGOR_MT_joints,
    TURGOR_PT_volume,
    TURGOR_PT_curves,
    TURGOR_PT_masks,
    TURGOR_PT_refine,
    TURGOR_PT_settings,
    TURGOR_PT_display,
    TURGOR_PT_performance,
    TURGOR_PT_spine,
    TURGOR_PT_spine_settings,
    TURGOR_PT_bake,
    TURGOR_PT_spine_bake,
    TURGOR_PT_baked,
    TURGOR_PT_sidebar,
)


def register() -> None:
    translations.register()
    properties.register()
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.OBJECT_MT_modifier_add_deform.append(draw_add)
    bpy.types.OBJECT_MT_modifier_add_deform.append(draw_add_spine)
    bpy.types.TOPBAR_MT_file_export.append(draw_export)
    joint_presets.register()
    joint_assets.register()
    weights.register()
    bpy.types.BONE_PT_deform.append(bone_panel.draw)
    handlers.register()
    spine_overlay.register()
    volume_overlay.register()
    command_line.register()


def unregister() -> None:
    command_line.unregister()
    volume_overlay.unregister()
    spine_overlay.unregister()
    handlers.unregister()
    bpy.types.BONE_PT_deform.remove(bone_panel.draw)
    weights.unregister()
    joint_assets.unregister()
    joint_presets.unregister()
    bpy.types.TOPBAR_MT_file_export.remove(draw_export)
    bpy.types.OBJECT_MT_modifier_add_deform.remove(draw_add_spine)
    bpy.types.OBJECT_MT_modifier_add_deform.remove(draw_add)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    properties.unregister()
    translations.unregister()
