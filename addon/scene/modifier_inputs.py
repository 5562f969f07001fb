"""Inputs of a Geometry Nodes modifier: RNA from Blender 5.2 on, item access before. Only this file knows."""

from __future__ import annotations

import re
from typing import Any

import bpy

HAS_RNA_INPUTS = bpy.app.version >= (5, 2, 0)


def read_input(modifier: bpy.types.NodesModifier, identifier: str) -> Any:
    """The value now, evaluated when the modifier is."""
    if HAS_RNA_INPUTS:
        return getattr(modifier.properties.inputs, identifier).value
    return modifier[identifier]


def write_input(modifier: bpy.types.NodesModifier, identifier: str, value: Any) -> None:
    """Set the input; the object must be tagged by the caller."""
    if HAS_RNA_INPUTS:
        getattr(modifier.properties.inputs, identifier).value = value
    else:
        modifier[identifier] = value


def input_path(modifier: bpy.types.NodesModifier, identifier: str) -> str:
    """Path from the object, for drivers and keyframes."""
    name = bpy.utils.escape_identifier(modifier.name)
    if HAS_RNA_INPUTS:
        return f'modifiers["{name}"].properties.inputs.{identifier}.value'
    return f'modifiers["{name}"]["{identifier}"]'


def parse_path(path: str) -> tuple[str, str] | None:
    """Names of modifier and input of an `input_path`; None of any other path."""
    found = re.fullmatch(r'modifiers\["(.*)"\](?:\["(\w+)"\]|\.properties\.inputs\.(\w+)\.value)', path)
    return None if found is None else (bpy.utils.unescape_identifier(found[1]), found[2] or found[3])


def read_values(modifier: bpy.types.NodesModifier, but: frozenset[str] = frozenset()) -> list[Any]:
    """Plain values of all inputs but these, in order; objects and other data by name."""
    values = []
    for identifier in identifiers(modifier):
        if identifier not in but:
            value = read_input(modifier, identifier)
            if isinstance(value, bpy.types.ID):
                value = value.name
            values.append(tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value)
    return values


def read_pointers(modifier: bpy.types.NodesModifier) -> list[bpy.types.ID]:
    """Objects and other data that inputs name."""
    values = (read_input(modifier, identifier) for identifier in identifiers(modifier))
    return [value for value in values if isinstance(value, bpy.types.ID)]


def identifiers(modifier: bpy.types.NodesModifier) -> list[str]:
    """Of all inputs that hold a value, in order."""
    return [
        item.identifier
        for item in modifier.node_group.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT" and has_input(modifier, item.identifier)
    ]


def has_input(modifier: bpy.types.NodesModifier, identifier: str) -> bool:
    """Whether the input holds a value; geometry has none."""
    if HAS_RNA_INPUTS:
        return hasattr(getattr(modifier.properties.inputs, identifier, None), "value")
    return identifier in modifier.keys()


def read_attributes(modifier: bpy.types.NodesModifier) -> list[Any]:
    """For each input whether an attribute gives its values, and its name."""
    found: list[Any] = []
    for identifier in identifiers(modifier):
        if HAS_RNA_INPUTS:
            given = getattr(modifier.properties.inputs, identifier)
            found.append((getattr(given, "type", None), getattr(given, "attribute_name", None)))
        else:
            found.append((modifier.get(f"{identifier}_use_attribute"), modifier.get(f"{identifier}_attribute_name")))
    return found
