"""One idiom of registration: every module that has something to register is listed, and all of it is undone."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType

import bpy
import pytest

PARTS = ("commands", "operators", "overlays", "panels", "properties", "translations", "handlers")
# Shown where there is no engine, in place of all others.
ALONE = {"addon.panels.engine_missing"}
KINDS = (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu, bpy.types.UIList, bpy.types.PropertyGroup)
MENUS = (
    "OBJECT_MT_modifier_add_deform",
    "TOPBAR_MT_file_export",
    "VIEW3D_MT_object_parent",
    "VIEW3D_MT_paint_weight",
    "ASSETBROWSER_MT_context_menu",
    "BONE_PT_deform",
)


@pytest.fixture
def registration(package: ModuleType) -> ModuleType:
    return importlib.import_module("addon.registration")


def modules() -> Iterator[ModuleType]:
    for part in PARTS:
        module = importlib.import_module(f"addon.{part}")
        yield module
        for info in pkgutil.iter_modules(getattr(module, "__path__", ())):
            yield importlib.import_module(f"addon.{part}.{info.name}")


def registered_names() -> set[str]:
    return {name for name in dir(bpy.types) if "turgor" in name.lower()}


def draw_counts() -> dict[str, int]:
    return {name: len(getattr(bpy.types, name)._dyn_ui_initialize()) for name in MENUS}


def test_every_module_with_something_to_register_is_listed_once(registration):
    listed = [module.__name__ for module in registration.MODULES]
    has_something = {
        module.__name__ for module in modules() if hasattr(module, "CLASSES") or hasattr(module, "register")
    }
    assert set(listed) == has_something - ALONE
    assert len(listed) == len(set(listed))


def test_every_listed_module_undoes_what_it_does(registration):
    for module in registration.MODULES:
        assert hasattr(module, "register") == hasattr(module, "unregister"), module.__name__
        assert hasattr(module, "CLASSES") or hasattr(module, "register"), module.__name__


def test_every_class_for_blender_is_listed_in_its_own_module(registration):
    for module in modules():
        own = {
            value
            for value in vars(module).values()
            if isinstance(value, type) and issubclass(value, KINDS) and value.__module__ == module.__name__
        }
        if module.__name__ not in ALONE and own:
            listed = (
                module.CLASSES if hasattr(module, "CLASSES") else importlib.import_module("addon.properties").CLASSES
            )
            assert own <= set(listed), module.__name__


def test_registering_again_brings_the_same_and_unregistering_leaves_nothing(addon):
    with_ours, drawn = registered_names(), draw_counts()
    addon.unregister()
    assert not registered_names()
    assert all(draw_counts()[name] < count for name, count in drawn.items())
    assert not hasattr(bpy.types.Object, "turgor")
    addon.register()
    assert registered_names() == with_ours
    assert draw_counts() == drawn
