"""All modules that have something to register, in order; undone in reverse.

Such a module has `CLASSES`, or `register` and `unregister` for whatever else is its own, or both: then its classes come
first. Blender draws panels in the order of their classes, and entries of menus in the order in which they were added.
"""

from __future__ import annotations

import bpy

from . import handlers, properties, translations
from .commands import command_line
from .operators import (
    add,
    export,
    fix,
    fold_loss,
    joint_assets,
    mask,
    measure,
    rebind,
    remove,
    weights,
)
from .operators import bake as bake_operators
from .operators import curves as curves_operators
from .operators import joint_presets as joint_presets_operators
from .operators import joints as joints_operators
from .operators import refine as refine_operators
from .operators import spine as spine_operators
from .overlays import spine as spine_overlay
from .overlays import volume as volume_overlay
from .panels import bake as bake_panels
from .panels import bone as bone_panels
from .panels import curves as curves_panels
from .panels import display as display_panels
from .panels import joint_presets as joint_presets_panels
from .panels import joints as joints_panels
from .panels import masks as masks_panels
from .panels import refine as refine_panels
from .panels import settings as settings_panels
from .panels import sidebar as sidebar_panels
from .panels import spine as spine_panels
from .panels import volume as volume_panels
from .properties import bone as bone_properties

MODULES = (
    translations,
    properties,
    bone_properties,
    add,
    remove,
    rebind,
    curves_operators,
    fold_loss,
    spine_operators,
    fix,
    measure,
    joints_operators,
    export,
    mask,
    bake_operators,
    joint_presets_operators,
    joint_assets,
    weights,
    refine_operators,
    joint_presets_panels,
    joints_panels,
    volume_panels,
    curves_panels,
    masks_panels,
    refine_panels,
    settings_panels,
    display_panels,
    spine_panels,
    bake_panels,
    sidebar_panels,
    bone_panels,
    handlers,
    spine_overlay,
    volume_overlay,
    command_line,
)


def register() -> None:
    for module in MODULES:
        for cls in getattr(module, "CLASSES", ()):
            bpy.utils.register_class(cls)
        if hasattr(module, "register"):
            module.register()


def unregister() -> None:
    for module in reversed(MODULES):
        if hasattr(module, "unregister"):
            module.unregister()
        for cls in reversed(getattr(module, "CLASSES", ())):
            bpy.utils.unregister_class(cls)
