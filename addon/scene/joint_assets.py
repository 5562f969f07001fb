"""Presets of joints as assets: node trees that hold nothing but the preset's text and its picture."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

TEXT_MARK = "turgor_joint"
DESCRIPTION = "Settings and curves of a joint of Turgor Volume"


def create(name: str, text: str, picture: NDArray[np.float32] | None) -> bpy.types.NodeTree:
    """An asset of this file. picture: (n, n, 4) RGBA, rows from the bottom up; None for Blender's own icon."""
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    tree[TEXT_MARK] = text
    tree.asset_mark()
    tree.asset_data.description = DESCRIPTION
    tree.asset_data.tags.new("Turgor", skip_if_exists=True)
    if picture is not None:
        preview = tree.preview_ensure()
        preview.image_size = picture.shape[:2]
        preview.image_pixels_float.foreach_set(np.ascontiguousarray(picture).ravel())
    return tree


def text_of(filepath: str, name: str) -> str | None:
    """The preset that an asset holds; None when it is not one of ours. filepath: empty for an asset of this file.

    Raises OSError for a file that cannot be read.
    """
    if not filepath:
        tree = bpy.data.node_groups.get(name)
        return None if tree is None else tree.get(TEXT_MARK)
    with bpy.data.libraries.load(filepath, link=False, assets_only=True) as (given, taken):
        taken.node_groups = [found for found in given.node_groups if found == name]
    for tree in taken.node_groups:
        text = tree.get(TEXT_MARK)
        bpy.data.node_groups.remove(tree)
        return text
    return None
