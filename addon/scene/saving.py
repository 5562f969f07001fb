"""Copies of the open file on disk; the open one is never written."""

from __future__ import annotations

from pathlib import Path

import bpy


def check(path: Path | None) -> None:
    """Raises ValueError where a copy must not go."""
    if path is None:
        return
    if path.suffix != ".blend":
        raise ValueError(f"{path.name}: need a name that ends in .blend")
    if bpy.data.filepath and path.absolute() == Path(bpy.data.filepath).absolute():
        raise ValueError(f"{path.name} is the file that is open: save the copies under another name")


def save_copy(path: Path) -> None:
    """Save the open file as a copy at `path`; paths within it are remapped. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path.absolute()), copy=True, check_existing=False)
    except RuntimeError as error:
        raise OSError(f"{path} could not be written: {str(error).strip()}") from error


def hide(ob: bpy.types.Object) -> None:
    """Hide the object in viewports and renders, where it is not linked."""
    if ob.library is None:
        ob.hide_viewport = ob.hide_render = True
