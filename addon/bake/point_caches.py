"""Point caches: a copy follows a PC2 file of all positions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import bpy

from ..logic import frame_range, point_cache
from ..logic.bake_files import BakeFiles
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


def store(options: Options, files: BakeFiles, vertex_count: int) -> PointCacheStore:
    """Where the chunks of a bake go: they are the file. Raises whole_file.WriteError."""
    header = point_cache.Header(vertex_count, float(options.frames[0]), check(options), len(options.frames))
    return PointCacheStore(files.chunks, header, frames_of_chunk(vertex_count, options.chunk_frames), files.cache)


def write(baking: Baking) -> Iterator[Progress]:
    """Waits for the file and makes the copy, which follows it where it grew until `move`."""
    source, options, live = baking.source, baking.options, baking.live
    step, first = check(options), float(options.frames[0])
    assert live is not None
    assert isinstance(baking.store, PointCacheStore)
    for done in live.finished():
        yield baking.making(done / len(options.frames), "Writing the point cache")
    baking.report.byte_count = baking.store.complete()
    removed = own_modifiers(baking)
    place = list(baking.target.modifiers).index(source.end)
    before = list(baking.target.modifiers)[:place]
    baking.copy = baked_copy.make(baking.target, source.end, source.bound_frame, removed, options.name)
    path = str(baking.store.path)
    baking.last = baked_copy.follow_point_cache(baking.copy, path, first, 1.0 / step, place - len(before))


def move(baking: Baking, path: Path) -> None:
    """The file to its last place, and the copy follows it there. Raises whole_file.WriteError."""
    assert isinstance(baking.store, PointCacheStore)
    assert baking.copy is not None
    assert baking.last is not None
    baking.store.finish(path)
    cache = baking.copy.modifiers[baking.last]
    cache.filepath = bpy.path.relpath(str(path)) if bpy.data.filepath else str(path)
