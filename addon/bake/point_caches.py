"""Point caches: a copy follows a PC2 file of all positions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import bpy

from ..logic import frame_range, point_cache
from ..logic.point_cache_store import PointCacheStore
from ..scene import baked_copy
from .baking import Baking, Progress
from .computing import frames_of_chunk
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


def store(options: Options, folder: Path, vertex_count: int) -> PointCacheStore:
    """Where the chunks of a bake go: they are the file. folder: for chunks. Raises whole_file.WriteError."""
    header = point_cache.Header(vertex_count, float(options.frames[0]), check(options), len(options.frames))
    return PointCacheStore(folder, header, frames_of_chunk(vertex_count, options.chunk_frames))


def write(baking: Baking) -> Iterator[Progress]:
    """Waits for the file and makes the copy."""
    source, options, live = baking.source, baking.options, baking.live
    step, first = check(options), float(options.frames[0])
    path = (options.folder or Path()) / f"{bpy.path.clean_name(baking.target.name)}.pc2"
    assert live is not None
    assert isinstance(baking.store, PointCacheStore)
    for done in live.finished():
        yield baking.making(done / len(options.frames), f"Writing {path.name}")
    baking.report.byte_count = baking.store.finish(path)
    removed = own_modifiers(baking)
    place = list(baking.target.modifiers).index(source.end)
    before = list(baking.target.modifiers)[:place]
    baking.copy = baked_copy.make(baking.target, source.end, source.bound_frame, removed, options.name)
    stored = bpy.path.relpath(str(path)) if bpy.data.filepath else str(path)
    baking.last = baked_copy.follow_point_cache(baking.copy, stored, first, 1.0 / step, place - len(before))
