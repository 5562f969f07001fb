"""Whose a bake is: the character, its scene and its file."""

from __future__ import annotations

from pathlib import Path

import bpy

from .. import runtime
from ..logic.bake_files import Source, digest_of, seen_from


def of(target: bpy.types.Object, folder: Path) -> Source:
    """folder: of the bake."""
    path = bpy.data.filepath
    return Source(
        file=seen_from(path, folder) if path else f"a file without a name ({runtime.session.unnamed})",
        digest=digest_of(path) if path else "",
        scene=bpy.context.scene.name,
        object=target.name,
        library="" if target.library is None else target.library.filepath.replace("\\", "/"),
    )
