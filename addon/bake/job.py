"""A bake from start to end, in slices short enough for a window to stay alive."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from ..logic import chunk_store, frame_range, whole_file
from ..logic.bake_report import BakeReport
from ..scene import baked_copy, spine_stack, stack
from . import correctives, driven, point_caches, shape_key_frames, verification
from .baking import FRAMES_DONE, Baking, Progress
from .options import CORRECTIVE_METHODS, BakeError, Options
from .spine_frames import SpineFrames
from .volume_frames import VolumeFrames

# Frames of one slice: so many, and so many bytes of positions.
CHUNK_FRAMES, CHUNK_BYTES = 64, 1 << 23
POSITION_BYTES = 12
# Chunks that may be in memory at one time.
CHUNKS_UNDER_WAY = 3
METHOD_NAMES = {
    "ABSOLUTE": "absolute shape keys",
    "CORRECTIVE": "corrective shape keys, one per frame",
    "REDUCED": "corrective shape keys, reduced",
    "DRIVEN": "corrective shape keys, driven by the pose",
    "POINT_CACHE": "point cache",
}


class Job:
    """One bake of one object. `run` it to its end, or close it: then nothing of it is left but finished chunks."""

    def __init__(self, target: bpy.types.Object, options: Options) -> None:
        """Raises BakeError where it cannot be done; nothing has changed then."""
        self._target, self._options = target, options
        if not len(options.frames):
            raise BakeError("There is no frame to bake: give a range such as 1-100")
        self._source = self._frames_of(target)
        if options.method in CORRECTIVE_METHODS and self._source.end.type != "ARMATURE":
            raise BakeError(
                "Corrective keys stand before an Armature, there is none: bake absolute keys or a point cache"
            )
        if options.method == "DRIVEN":
            driven.check(self._source)
        if options.method == "POINT_CACHE":
            point_caches.check(options)
        if options.method in {"REDUCED", "DRIVEN"} and not options.tolerance > 0.0:
            raise BakeError("The error is 0: give the largest that may be seen")
        positions = self._source.rest.positions
        size = float(np.linalg.norm(np.ptp(positions.astype(np.float64), axis=0))) if len(positions) else 0.0
        if options.tolerance_is_relative:
            self._options = options = replace(options, tolerance=options.tolerance * size, tolerance_is_relative=False)
        report = BakeReport(
            target.name,
            METHOD_NAMES[options.method],
            frame_range.text_of(options.frames),
            len(options.frames),
            len(positions),
            size,
            tolerance=float(options.tolerance) if options.method in {"REDUCED", "DRIVEN"} else None,
        )
        self._baking = Baking(target, self._source, options, report)

    @property
    def baked(self) -> bpy.types.Object | None:
        """The copy that carries the bake; None until it is made."""
        return self._baking.copy

    @property
    def report(self) -> BakeReport:
        """Complete once `run` has ended."""
        return self._baking.report

    @property
    def chunk_count(self) -> int:
        """Chunks of all frames."""
        return -(-len(self._options.frames) // self._chunk_frames)

    @property
    def _chunk_frames(self) -> int:
        if self._options.chunk_frames > 0:
            return self._options.chunk_frames
        return min(CHUNK_FRAMES, max(CHUNK_BYTES // (POSITION_BYTES * max(self.report.vertex_count, 1)), 1))

    @property
    def chunk_folder(self) -> Path | None:
        """Where finished chunks wait for another try."""
        folder = self._options.folder
        return None if folder is None else folder / f".{bpy.path.clean_name(self._target.name)}.chunks"

    def run(self) -> Iterator[Progress]:
        """Main thread only. Raises BakeError, whole_file.WriteError and what the engine raises."""
        started = perf_counter()
        options, baking = self._options, self._baking
        self._check_folder(2 * len(options.frames))
        store = chunk_store.ChunkStore(self.chunk_folder)
        with closing(self._compute(store, range(self.chunk_count))) as steps:
            yield from steps
        baking.report.resumed_chunks = store.found_count
        try:
            yield from _METHODS[options.method](baking)
            if options.verify:
                yield from verification.verify(baking)
        except BaseException:
            if baking.copy is not None:
                baked_copy.discard(baking.copy)
                baking.copy = None
            raise
        baking.report.seconds = perf_counter() - started
        if options.folder is not None:
            name = options.folder / f"{bpy.path.clean_name(self._target.name)}_{options.method.lower()}"
            for suffix, text in ((".json", baking.report.as_json()), (".txt", baking.report.as_text())):
                with whole_file.written(name.with_suffix(suffix)) as file:
                    file.write(text.encode())
        baking.chunks.clear()
        store.clear()

    def compute(self, numbers: range) -> Iterator[Progress]:
        """Only these chunks, for a `run` with the same options, in another process or on another machine.

        Raises as `run`, and BakeError without a folder to leave them in.
        """
        if self._options.folder is None:
            raise BakeError("Chunks need a folder: save the file first, or choose one")
        self._check_folder(min(len(numbers) * self._chunk_frames, len(self._options.frames)))
        with closing(self._compute(chunk_store.ChunkStore(self.chunk_folder), numbers)) as steps:
            yield from (Progress(step.part / FRAMES_DONE, step.text) for step in steps)

    def verify(self, copy: bpy.types.Object) -> Iterator[Progress]:
        """Compares a copy that was baked earlier: errors go to the report. Raises what the engine raises."""
        with closing(self._compute(chunk_store.ChunkStore(None), range(self.chunk_count))) as steps:
            yield from steps
        self._baking.copy, self._baking.last = copy, baked_copy.shown_by(copy)
        yield from verification.verify(self._baking)

    def _check_folder(self, frame_count: int) -> None:
        if self._options.folder is not None:
            whole_file.check_folder(self._options.folder, frame_count * self.report.vertex_count * POSITION_BYTES)

    def _frames_of(self, target: bpy.types.Object) -> VolumeFrames | SpineFrames:
        if target.type == "MESH" and stack.volume_modifier(target) is not None:
            return VolumeFrames(target)
        if target.type == "MESH" and spine_stack.spine_modifier(target) is not None:
            return SpineFrames(target)
        raise BakeError(f"{target.name} has neither Turgor Volume nor Turgor Spine: there is nothing to bake")

    def _compute(self, store: chunk_store.ChunkStore, numbers: range) -> Iterator[Progress]:
        """The engine works on a chunk, and another is written, while Blender samples the next."""
        frames, baking, count = self._options.frames, self._baking, self._chunk_frames
        asked = max(sum(len(frames[number * count : (number + 1) * count]) for number in numbers), 1)
        pending: list[Future[NDArray[np.float32]]] = []
        with ThreadPoolExecutor(1, "turgor-bake") as engine, ThreadPoolExecutor(1, "turgor-write") as disk:
            for number in numbers:
                samples = self._source.sample(frames[number * count : (number + 1) * count])
                baking.poses.extend(sample.posed for sample in samples)
                if len(pending) >= CHUNKS_UNDER_WAY:
                    pending[-CHUNKS_UNDER_WAY].result()
                found = engine.submit(self._chunk, store, number, samples)
                pending.append(disk.submit(_kept, store, number, found))
                done = len(baking.poses)
                yield Progress(FRAMES_DONE * done / asked, f"{done} of {asked} frames")
            baking.chunks.extend(future.result() for future in pending)

    def _chunk(self, store: chunk_store.ChunkStore, number: int, samples: list) -> _Chunk:
        name = self._source.fingerprint(samples) if self._options.folder is not None else ""
        known = store.find(number, name, (len(samples), self._baking.report.vertex_count, 3))
        return _Chunk(name, self._source.positions(samples) if known is None else known, known is not None)


class _Chunk(NamedTuple):
    """Positions, and whether they were found under their name."""

    name: str
    positions: NDArray[np.float32]
    is_kept: bool


def _kept(store: chunk_store.ChunkStore, number: int, found: Future[_Chunk]) -> NDArray[np.float32]:
    name, positions, is_kept = found.result()
    return positions if is_kept else store.put(number, name, positions)


_METHODS = {
    "ABSOLUTE": shape_key_frames.absolute,
    "CORRECTIVE": correctives.per_frame,
    "REDUCED": correctives.reduced,
    "DRIVEN": driven.driven,
    "POINT_CACHE": point_caches.write,
}
