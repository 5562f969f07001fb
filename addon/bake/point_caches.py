"""Point caches: a copy follows a PC2 file of all positions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import bpy

from ..logic import frame_range, point_cache, whole_file
from ..scene import baked_copy
from .baking import Baking, Progress
from .options import BakeError, Options
from .shape_key_frames import own_modifiers


def check(options: Options) -> float:
    """Frames from sample to sample. Raises BakeError where a cache cannot hold these frames."""
    if options.folder is None:
        raise BakeError("A point cache needs a folder: save the file first, or choose one")
    step = frame_range.even_step(options.frames)
    if step is None:
        raise BakeError("A point cache needs even steps from frame to frame: give one range such as 1-100x2")
    return step


def write(baking: Baking) -> Iterator[Progress]:
    """Writes the file and makes the copy."""
    source, options = baking.source, baking.options
    step = check(options)
    path = (options.folder or Path()) / f"{bpy.path.clean_name(baking.target.name)}.pc2"
    first = float(options.frames[0])
    header = point_cache.Header(baking.report.vertex_count, first, step, len(options.frames))
    yield baking.making(0.0, f"Writing {path.name}")
    with whole_file.written(path) as file:
        baking.report.byte_count = point_cache.write(file, header, baking.chunks)
    removed = own_modifiers(baking)
    place = list(baking.target.modifiers).index(source.end)
    before = list(baking.target.modifiers)[:place]
    baking.copy = baked_copy.make(baking.target, source.end, source.bound_frame, removed, options.name)
    stored = bpy.path.relpath(str(path)) if bpy.data.filepath else str(path)
    baking.last = baked_copy.follow_point_cache(baking.copy, stored, first, 1.0 / step, place - len(before))
