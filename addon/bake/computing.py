"""Live positions of many frames, chunk by chunk: Blender samples one while the engine works on the one before."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from itertools import islice
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..logic.chunk_store import ChunkStore
from .skinned_rest import Posed
from .spine_frames import SpineFrames
from .volume_frames import VolumeFrames

# Frames of one chunk: so many, and so many bytes of positions.
CHUNK_FRAMES, CHUNK_BYTES = 32, 1 << 23
POSITION_BYTES = 12
# Between two steps: to begin sampling takes as long as some frames.
SECONDS_OF_WORK = 0.1
# Chunks that may be in memory at one time.
CHUNKS_UNDER_WAY = 3


class Computing:
    """The chunks of some frames. Nothing of it works on once its `with` has ended."""

    def __init__(
        self,
        source: VolumeFrames | SpineFrames,
        frames: NDArray[np.float64],
        *,
        chunk_frames: int = 0,
        store: ChunkStore | None = None,
    ) -> None:
        """chunk_frames: 0 by the size of the mesh. store: None keeps them in memory."""
        self._source, self._frames, self._store = source, frames, store
        self._vertex_count = len(source.rest_positions)
        by_size = min(CHUNK_FRAMES, max(CHUNK_BYTES // (POSITION_BYTES * max(self._vertex_count, 1)), 1))
        self.chunk_frames = chunk_frames if chunk_frames > 0 else by_size
        self.poses: list[Posed | None] = []
        # (S, 3) of each chunk that is done, as `VolumeSkin.deform_many` counts folds; none where they are not repaired.
        self.folds: list[NDArray[np.float32]] = []
        self._fold_store = None if store is None else store.beside("folds")
        self._pending: list[Future[NDArray[np.float32]]] = []
        self._engine = ThreadPoolExecutor(1, "turgor-bake")
        self._disk = ThreadPoolExecutor(1, "turgor-write")

    def __enter__(self) -> Computing:
        return self

    def __exit__(self, *_: object) -> None:
        for executor in (self._engine, self._disk):
            executor.shutdown(cancel_futures=True)
        self._pending.clear()

    @property
    def chunk_count(self) -> int:
        """Chunks of all frames."""
        return -(-len(self._frames) // self.chunk_frames)

    def frames_of(self, number: int) -> NDArray[np.float64]:
        """Of one chunk."""
        return self._frames[number * self.chunk_frames : (number + 1) * self.chunk_frames]

    @property
    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """(S, N, 3) each, in order of the frames, as they are done. Raises as the engine and the store do."""
        return (pending.result() for pending in self._pending)

    def sample(self, numbers: range) -> Iterator[int]:
        """Begins these chunks, main thread only; tells how many frames are sampled. Raises as `chunks`."""
        ahead = deque(numbers)
        while ahead:
            until = perf_counter() + SECONDS_OF_WORK
            frames = np.concatenate([self.frames_of(number) for number in ahead])
            with closing(self._source.samples(frames)) as sampled:
                while ahead and perf_counter() < until:
                    number = ahead.popleft()
                    samples = list(islice(sampled, len(self.frames_of(number))))
                    self.poses.extend(sample.posed for sample in samples)
                    if len(self._pending) >= CHUNKS_UNDER_WAY:
                        self._pending[-CHUNKS_UNDER_WAY].result()
                    made = self._engine.submit(self._chunk, number, samples)
                    self._pending.append(self._disk.submit(self._kept, number, made))
            yield len(self.poses)

    def _chunk(self, number: int, samples: list) -> _Chunk:
        counts = np.zeros((len(samples), 3), np.int32)
        if self._store is None or self._fold_store is None:
            return _Chunk("", self._source.positions(samples, counts), counts.astype(np.float32), True)
        name = self._source.fingerprint(samples)
        folds = counts.astype(np.float32)
        if self._source.repairs_folds:
            folds = self._fold_store.find(number, name, counts.shape)
        known = None if folds is None else self._store.find(number, name, (len(samples), self._vertex_count, 3))
        if known is not None and folds is not None:
            return _Chunk(name, known, folds, True)
        return _Chunk(name, self._source.positions(samples, counts), counts.astype(np.float32), False)

    def _kept(self, number: int, made: Future[_Chunk]) -> NDArray[np.float32]:
        name, positions, folds, is_kept = made.result()
        if self._source.repairs_folds:
            self.folds.append(folds)
        if is_kept or self._store is None or self._fold_store is None:
            return positions
        if self._source.repairs_folds:
            self._fold_store.put(number, name, folds)
        return self._store.put(number, name, positions)


class _Chunk(NamedTuple):
    """Positions, counts of folds, and whether both are where they will be kept."""

    name: str
    positions: NDArray[np.float32]
    folds: NDArray[np.float32]
    is_kept: bool
