"""Live positions of many frames, chunk by chunk: Blender samples some while the engine works on those before."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from itertools import islice
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..logic.chunk_store import ChunkStore
from ..logic.point_cache_store import PointCacheStore
from .skinned_rest import Posed
from .spine_frames import SpineFrames
from .volume_frames import VolumeFrames

# Frames of one chunk: so many, and so many bytes of positions.
CHUNK_FRAMES, CHUNK_BYTES = 64, 1 << 23
POSITION_BYTES = 12
# The engine is called after so many frames, for it to begin early; it takes all that are sampled by then.
PART_FRAMES = 16
# Between two steps: to begin sampling takes as long as some frames.
SECONDS_OF_WORK = 0.1
# Sampling waits where more is under way: so many chunks, or so many bytes of positions.
CHUNKS_UNDER_WAY, BYTES_UNDER_WAY = 3, 1 << 26


def frames_of_chunk(vertex_count: int, asked: int = 0) -> int:
    """asked: 0 by the size of the mesh."""
    by_size = min(CHUNK_FRAMES, max(CHUNK_BYTES // _frame_bytes(vertex_count), 1))
    return asked if asked > 0 else by_size


def _frame_bytes(vertex_count: int) -> int:
    """Bytes of the positions of one frame; an empty mesh takes some too."""
    return POSITION_BYTES * max(vertex_count, 1)


class Computing:
    """The chunks of some frames. Nothing of it works on once its `with` has ended."""

    def __init__(
        self,
        source: VolumeFrames | SpineFrames,
        frames: NDArray[np.float64],
        *,
        chunk_frames: int = 0,
        store: ChunkStore | PointCacheStore | None = None,
    ) -> None:
        """chunk_frames: 0 by the size of the mesh. store: None keeps them in memory."""
        self._source, self._frames, self._store = source, frames, store
        self._vertex_count = len(source.rest_positions)
        self.chunk_frames = frames_of_chunk(self._vertex_count, chunk_frames)
        chunk_bytes = self.chunk_frames * _frame_bytes(self._vertex_count)
        self._most_under_way = max(CHUNKS_UNDER_WAY, BYTES_UNDER_WAY // chunk_bytes)
        # Chunks that there is room for: those that no store keeps stay.
        self._places = self.chunk_count if store is None else min(self._most_under_way, self.chunk_count)
        self.poses: list[Posed | None] = []
        # (S, 3) of each chunk that is done, as `VolumeSkin.deform_many` counts folds; none where they are not repaired.
        self.folds: list[NDArray[np.float32]] = []
        self._fold_store = None if store is None else store.beside("folds")
        self._pending: list[tuple[int, Future[NDArray[np.float32] | None]]] = []
        self._room: NDArray[np.float32] | None = None
        self._engine = ThreadPoolExecutor(1, "turgor-bake")
        self._disk = ThreadPoolExecutor(1, "turgor-write")

    def __enter__(self) -> Computing:
        return self

    def __exit__(self, *_: object) -> None:
        for executor in (self._engine, self._disk):
            executor.shutdown(cancel_futures=True)
        self._pending.clear()
        if self._store is not None:
            self._store.close()

    @property
    def chunk_count(self) -> int:
        """Chunks of all frames."""
        return -(-len(self._frames) // self.chunk_frames)

    def frames_of(self, number: int) -> NDArray[np.float64]:
        """The frames of one chunk."""
        return self._frames[number * self.chunk_frames : (number + 1) * self.chunk_frames]

    @property
    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """(S, N, 3) each, in order of the frames, as they are done. Raises as the engine and the store do."""
        for number, pending in self._pending:
            positions = pending.result()
            if positions is None:
                assert self._store is not None
                positions = self._store.read(number, self._shape(number))
            yield positions

    def sample(self, numbers: range) -> Iterator[int]:
        """Begins these chunks, main thread only; tells how many frames are sampled. Raises as `chunks`."""
        ahead = deque(numbers)
        while ahead:
            until = perf_counter() + SECONDS_OF_WORK
            frames = np.concatenate([self.frames_of(number) for number in ahead])
            with closing(self._source.samples(frames)) as sampled:
                while ahead and perf_counter() < until:
                    self._begin(ahead.popleft(), sampled)
            yield len(self.poses)

    def finished(self) -> Iterator[int]:
        """Waits for all chunks that are begun; tells how many frames are done. Raises as `chunks`."""
        done = 0
        for number, pending in self._pending:
            pending.result()
            done += len(self.frames_of(number))
            yield done

    def _begin(self, number: int, sampled: Iterator[Any]) -> None:
        if len(self._pending) >= self._most_under_way:
            self._pending[-self._most_under_way][1].result()
        count = len(self.frames_of(number))
        chunk = _Chunk(number, self._room_of(number), np.zeros((count, 3), np.int32))
        store, folds = self._store, self._fold_store
        may_be_there = (store is not None and store.may_have(number)) or (folds is not None and folds.may_have(number))
        for start in range(0, count, PART_FRAMES):
            chunk.samples += list(islice(sampled, min(PART_FRAMES, count - start)))
            if not may_be_there and len(chunk.samples) < count:
                self._engine.submit(self._compute, chunk)
        self.poses.extend(sample.posed for sample in chunk.samples)
        computed = self._engine.submit(self._find_or_compute if may_be_there else self._compute, chunk)
        self._pending.append((number, self._disk.submit(self._kept, chunk, computed)))

    def _shape(self, number: int) -> tuple[int, int, int]:
        return len(self.frames_of(number)), self._vertex_count, 3

    def _room_of(self, number: int) -> NDArray[np.float32]:
        # Large arrays cost fewer page faults than many, and used ones none.
        if self._room is None:
            count = min(self._places * self.chunk_frames, len(self._frames))
            self._room = np.empty((count, self._vertex_count, 3), np.float32)
        first = len(self._pending) % self._places * self.chunk_frames
        return self._room[first : first + len(self.frames_of(number))]

    def _compute(self, chunk: _Chunk) -> None:
        """All frames that are sampled and not computed: those of later calls too, as far as Blender was faster."""
        start, stop = chunk.computed, len(chunk.samples)
        if start < stop:
            self._source.compute(chunk.samples[start:stop], chunk.positions[start:stop], chunk.folds[start:stop])
            chunk.computed = stop

    def _find_or_compute(self, chunk: _Chunk) -> None:
        assert self._store is not None
        assert self._fold_store is not None
        name = chunk.name = self._source.fingerprint(chunk.samples)
        folds: NDArray[Any] | None = chunk.folds
        if self._source.repairs_folds:
            folds = self._fold_store.find(chunk.number, name, chunk.folds.shape)
        if folds is not None and self._store.find(chunk.number, name, chunk.positions.shape) is not None:
            chunk.folds, chunk.is_kept = folds.astype(np.int32), True
        else:
            self._compute(chunk)

    def _kept(self, chunk: _Chunk, computed: Future[None]) -> NDArray[np.float32] | None:
        """The positions, or None where the store has them. computed: the engine's last call for this chunk."""
        computed.result()
        folds = chunk.folds.astype(np.float32)
        if self._source.repairs_folds:
            self.folds.append(folds)
        if self._store is None or self._fold_store is None:
            return chunk.positions
        if not chunk.is_kept:
            name = chunk.name or self._source.fingerprint(chunk.samples)
            if self._source.repairs_folds:
                self._fold_store.put(chunk.number, name, folds)
            self._store.put(chunk.number, name, chunk.positions)
        return None


@dataclass
class _Chunk:
    """One under way."""

    number: int
    positions: NDArray[np.float32]  # (S, N, 3)
    folds: NDArray[np.int32]  # (S, 3)
    samples: list[Any] = field(default_factory=list)
    computed: int = 0  # so many of them
    name: str = ""  # its fingerprint, once known
    is_kept: bool = False  # where it will be kept
