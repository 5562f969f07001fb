"""All texts that the add-on shows, as Blender's translations look them up."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import bpy

ADDON = Path(__file__).resolve().parents[2] / "addon"

# Calls whose first text is shown, or whose argument of this name is.
SHOWN_FIRST = {"message", "iface_", "rpt_", "poll_message_set"}
SHOWN_SECOND = {"report"}
SHOWN_BY_NAME = {"text"}
UNITS = {"ms"}
# Blender's own properties of every class.
UNSHOWN = {"rna_type", "name"}


def of_classes(package: str) -> Iterator[str]:
    """Labels and tooltips of registered classes, their properties and settings. package: name of the add-on."""
    for name in dir(bpy.types):
        if "turgor" in name.lower():
            cls = getattr(bpy.types, name)
            yield getattr(cls, "bl_label", "")
            yield getattr(cls, "bl_description", "")
            yield from _of_struct(cls.bl_rna)
    for prop in bpy.types.Object.bl_rna.properties:
        if prop.identifier.startswith("turgor"):
            yield from _of_struct(prop.fixed_type)
    for prop in bpy.types.Bone.bl_rna.properties:
        if prop.identifier.startswith("turgor"):
            yield from _of_property(prop)
    for cls in bpy.types.AddonPreferences.__subclasses__():
        if cls.bl_idname == package:
            yield from _of_struct(cls.bl_rna)


def _of_struct(rna: bpy.types.Struct) -> Iterator[str]:
    inherited = set() if rna.base is None else set(rna.base.properties.keys())
    for prop in rna.properties:
        if prop.identifier in inherited or prop.identifier in UNSHOWN:
            continue
        if prop.type in {"POINTER", "COLLECTION"} and prop.fixed_type.identifier.startswith("Turgor"):
            yield from _of_struct(prop.fixed_type)
        elif not prop.is_hidden:
            yield from _of_property(prop)


def _of_property(prop: bpy.types.Property) -> Iterator[str]:
    if prop.name != prop.identifier:  # one without a name is shown nowhere
        yield prop.name
    yield prop.description
    if prop.type == "ENUM":
        for item in prop.enum_items:
            yield item.name
            yield item.description


def in_sources() -> Iterator[tuple[str, str | None]]:
    """(place, text) of literals in calls that show them; None for f-strings with words: none can translate those."""
    for path in sorted(ADDON.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call):
                for shown in _shown(node):
                    place = f"{path.relative_to(ADDON)}:{shown.lineno}"
                    if isinstance(shown, ast.Constant) and isinstance(shown.value, str):
                        yield place, shown.value
                    elif isinstance(shown, ast.JoinedStr) and _has_words(shown):
                        yield place, None


def _has_words(text: ast.JoinedStr) -> bool:
    constants = " ".join(str(part.value) for part in text.values if isinstance(part, ast.Constant))
    return bool(set(re.findall("[A-Za-z]+", constants)) - UNITS)


def _shown(call: ast.Call) -> Iterator[ast.expr]:
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    if name in SHOWN_FIRST:
        yield from call.args[:1]
    if name in SHOWN_SECOND:
        yield from call.args[1:2]
    yield from (keyword.value for keyword in call.keywords if keyword.arg in SHOWN_BY_NAME)
