"""A bake from start to end, in slices short enough for a window to stay alive."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import bpy
import numpy as np

from ..logic import frame_range, whole_file
from ..logic.bake_files import BakeFiles
from ..logic.bake_report import BakeReport
from ..logic.chunk_store import ChunkStore
from ..logic.point_cache_store import PointCacheStore
from ..messages import message
from ..scene import baked_copy, scene_drivers, spine_stack, stack
from . import correctives, driven, point_caches, shape_key_frames, sources, verification
from .baking import FRAMES_DONE, Baking, Progress
from .computing import POSITION_BYTES, Computing
from .options import CORRECTIVE_METHODS, BakeError, Options
from .spine_frames import SpineFrames
from .volume_frames import VolumeFrames

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
        try:
            scene_drivers.check(bpy.context.scene, [target, *self._source.leaders])
        except scene_drivers.SceneDriverError as error:
            raise BakeError(*error.args) from error
        if options.method in CORRECTIVE_METHODS and self._source.end.type != "ARMATURE":
            raise BakeError(
                "Corrective keys stand before an Armature, there is none: bake absolute keys or a point cache"
            )
        if options.method in CORRECTIVE_METHODS and isinstance(self._source, VolumeFrames):
            self._source.check_keys(is_driven=options.method == "DRIVEN")
        if options.method == "DRIVEN":
            driven.check(self._source)
        if options.method == "POINT_CACHE":
            point_caches.check(options)
        if options.method in {"REDUCED", "DRIVEN"} and not options.tolerance > 0.0:
            raise BakeError("The error is 0: give the largest that may be seen")
        positions = self._source.rest_positions
        size = float(np.linalg.norm(np.ptp(positions.astype(np.float64), axis=0))) if len(positions) else 0.0
        if options.tolerance_is_relative:
            self._options = options = replace(options, tolerance=options.tolerance * size, tolerance_is_relative=False)
        self._files: BakeFiles | None = None
        if options.folder is not None:
            self._files = BakeFiles(options.folder, sources.of(target, options.folder), options.method)
        report = BakeReport(
            target.name,
            METHOD_NAMES[options.method],
            frame_range.text_of(options.frames),
            len(options.frames),
            len(positions),
            size,
            tolerance=float(options.tolerance) if options.method in {"REDUCED", "DRIVEN"} else None,
            settings=options.as_dict(),
            source=None if self._files is None else self._files.source,
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
        with self._computing() as computing:
            return computing.chunk_count

    @property
    def chunk_folder(self) -> Path | None:
        """Where finished chunks wait for another try; None: in memory."""
        return None if self._files is None else self._files.chunks

    def run(self, *, clears: bool = True) -> Iterator[Progress]:
        """Main thread only. Raises BakeError, OccupiedError, whole_file.WriteError and what the engine raises.

        clears: take the chunks away at the end, else `clear` does once the copy is saved: they are all that is left of
        a bake whose process ends before.
        """
        started = perf_counter()
        options, baking = self._options, self._baking
        self._check_folder(len(options.frames))
        self._check_earlier()
        store = baking.store = self._store()
        with self._computing(store) as computing:
            yield from self._sampled(computing, range(computing.chunk_count))
            baking.live = computing
            try:
                yield from _METHODS[options.method](baking)
                baking.report.count_folds(computing.folds)
                if options.verify:
                    yield from verification.verify(baking)
                baking.report.resumed_chunks = 0 if store is None else store.found_count
                baking.report.seconds = perf_counter() - started
                self._keep()
            except BaseException:
                if baking.copy is not None:
                    baked_copy.discard(baking.copy)
                    baking.copy = None
                raise
        if clears:
            self.clear()

    def clear(self) -> None:
        """Take away what waits for another try."""
        if self._baking.store is not None:
            self._baking.store.clear()

    def compute(self, numbers: range) -> Iterator[Progress]:
        """Only these chunks, for a `run` with the same options, in another process or on another machine.

        Raises as `run`, and BakeError without a folder to leave them in.
        """
        if self._options.folder is None:
            raise BakeError("Chunks need a folder: save the file first, or choose one")
        if self._files is not None:
            self._files.earlier(may_overwrite=self._options.overwrite)
        with self._computing(self._chunk_store()) as computing:
            self._check_folder(sum(len(computing.frames_of(number)) for number in numbers))
            for step in self._sampled(computing, numbers):
                yield Progress(step.part / FRAMES_DONE, step.text)
            for _ in computing.chunks:
                pass

    def verify(self, copy: bpy.types.Object) -> Iterator[Progress]:
        """Compares a copy that was baked earlier: errors go to the report. Raises what the engine raises."""
        with self._computing() as computing:
            yield from self._sampled(computing, range(computing.chunk_count))
            self._baking.live = computing
            self._baking.copy, self._baking.last = copy, baked_copy.shown_by(copy)
            yield from verification.verify(self._baking)

    def _store(self) -> ChunkStore | PointCacheStore | None:
        if self._files is not None and self._options.method == "POINT_CACHE":
            return point_caches.store(self._options, self._files, self.report.vertex_count)
        return self._chunk_store()

    def _chunk_store(self) -> ChunkStore | None:
        return None if self._files is None else ChunkStore(self._files.chunks).hold()

    def _check_earlier(self) -> None:
        """Raises OccupiedError; what is replaced with other settings is told."""
        if self._files is None:
            return
        earlier = self._files.earlier(may_overwrite=self._options.overwrite)
        if earlier is None:
            return
        now = self.report.as_dict()
        if any(earlier.get(name) != now[name] for name in ("frames", "tolerance", "settings")):
            self.report.notes.append(
                message(
                    "{file} was of a bake of frames {frames} with other settings, and was replaced",
                    file=self._files.report.name,
                    frames=str(earlier.get("frames")),
                )
            )

    def _keep(self) -> None:
        """Report and cache go to their last places; until then all chunks are where another try finds them."""
        files, report = self._files, self._baking.report
        if files is None:
            return
        # Another character's bake may have ended meanwhile.
        files.earlier(may_overwrite=self._options.overwrite)
        # The report first: it says whose the cache is.
        for path, text in ((files.report, report.as_json()), (files.text, report.as_text())):
            with whole_file.written(path, is_kept=False) as file:
                file.write(text.encode())
        if self._options.method == "POINT_CACHE":
            point_caches.move(self._baking, files.cache)

    def _check_folder(self, frame_count: int) -> None:
        if self._options.folder is not None:
            whole_file.check_folder(self._options.folder, frame_count * self.report.vertex_count * POSITION_BYTES)

    def _frames_of(self, target: bpy.types.Object) -> VolumeFrames | SpineFrames:
        if target.type == "MESH" and stack.volume_modifier(target) is not None:
            return VolumeFrames(target, repair_folds=self._options.repair_folds)
        if target.type == "MESH" and spine_stack.spine_modifier(target) is not None:
            return SpineFrames(target)
        raise BakeError(f"{target.name} has neither Turgor Volume nor Turgor Spine: there is nothing to bake")

    def _computing(self, store: ChunkStore | PointCacheStore | None = None) -> Computing:
        return Computing(self._source, self._options.frames, chunk_frames=self._options.chunk_frames, store=store)

    def _sampled(self, computing: Computing, numbers: range) -> Iterator[Progress]:
        asked = max(sum(len(computing.frames_of(number)) for number in numbers), 1)
        with closing(computing.sample(numbers)) as steps:
            for done in steps:
                yield Progress(FRAMES_DONE * done / asked, f"{done} of {asked} frames")


_METHODS = {
    "ABSOLUTE": shape_key_frames.absolute,
    "CORRECTIVE": correctives.per_frame,
    "REDUCED": correctives.reduced,
    "DRIVEN": driven.driven,
    "POINT_CACHE": point_caches.write,
}
