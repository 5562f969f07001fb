"""Chunks of a point cache, at their places in the file that becomes it: no position is written twice.

Beside the growing file lies a journal: a line per chunk, with the fingerprint of all that it was computed from and a
checksum. A killed bake goes on with what stands in both, and with what it has moved to its last place before the kill.
Who bakes holds a lock on them; another bake beside it takes files of its own.
"""

from __future__ import annotations

import os
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from .checksum import checksum
from .chunk_store import ChunkStore
from .folder_lock import FolderLock
from .point_cache import Header, PointCacheError
from .whole_file import explained


class PointCacheStore:
    """Chunks of one cache. Those that another machine left as files of their own are found too."""

    def __init__(self, folder: Path, header: Header, chunk_samples: int, finished: Path | None = None) -> None:
        """finished: where the file goes in the end. Raises whole_file.WriteError, PointCacheError."""
        self._folder, self._header, self._chunk_samples, self._finished = folder, header, chunk_samples, finished
        self._others = ChunkStore(folder)
        self._written = Lock()
        self._syncs = ThreadPoolExecutor(1, "turgor-sync")
        self._syncing: Future[None] | None = None
        self._known: dict[int, tuple[str, int]] = {}
        self._put: set[int] = set()
        self.found_count = 0
        start = header.packed()
        with explained(folder / "cache"):
            self._lock = FolderLock(folder)
            name = f"cache{self._lock.number or ''}"
            self.path = folder / f"{name}.pc2"
            self._journal_path = folder / f"{name}.journal"
            layout = f"{header} {chunk_samples}".encode()
            is_known = self._read_journal(layout)
            self._file = self.path.open("r+b" if _begins_with(self.path, start) else "w+b", buffering=0)
            self._file.write(start)
            self._journal = self._journal_path.open("ab" if is_known else "wb", buffering=0)
            # A line that a kill has cut stays one of its own.
            self._journal.write(b"\n" if is_known else layout + b"\n")

    def beside(self, kind: str) -> ChunkStore:
        """A store beside this one, see `ChunkStore.beside`."""
        return self._others.beside(kind)

    def may_have(self, number: int) -> bool:
        """Whether a chunk of this number may be there, see `ChunkStore.may_have`."""
        return number in self._known or self._others.may_have(number)

    def find(self, number: int, fingerprint: str, shape: tuple[int, ...]) -> NDArray[np.float32] | None:
        """What `ChunkStore.find` returns. Raises whole_file.WriteError, PointCacheError."""
        known, expected = self._known.get(number, ("", 0))
        if known == fingerprint:
            for path in (self.path, self._finished):
                chunk = None if path is None else self._whole(path, number, shape)
                if chunk is not None and checksum(number, fingerprint, chunk) == expected:
                    if path == self.path:
                        self._put.add(number)
                    else:
                        self.put(number, fingerprint, chunk)
                    self.found_count += 1
                    return self.read(number, shape)
        chunk = self._others.find(number, fingerprint, shape)
        if chunk is not None:
            self.put(number, fingerprint, chunk)
            self.found_count += 1
        return chunk

    def _whole(self, path: Path, number: int, shape: tuple[int, ...]) -> NDArray[np.float32] | None:
        """(S, N, 3) of a file with the header of this cache, whatever is in it."""
        if shape != self._shape(number) or not _begins_with(path, self._header.packed()):
            return None
        with suppress(OSError, ValueError):
            return self._header.mapped(path, number * self._chunk_samples, shape[0])
        return None

    def _shape(self, number: int) -> tuple[int, int, int]:
        samples = min(self._chunk_samples, self._header.sample_count - number * self._chunk_samples)
        return samples, self._header.point_count, 3

    def put(self, number: int, fingerprint: str, chunk: NDArray[np.float32]) -> None:
        """Raises whole_file.WriteError, PointCacheError."""
        if chunk.shape != self._shape(number):
            raise PointCacheError(f"Chunk {number} is {chunk.shape}, need {self._shape(number)}")
        with self._written, explained(self.path):
            self._file.seek(self._header.place(number * self._chunk_samples))
            chunk = np.ascontiguousarray(chunk, "<f4")
            found, rest = checksum(number, fingerprint, chunk), chunk.data.cast("B")
            while rest:
                rest = rest[self._file.write(rest) :]
            self._begin_to_sync()
            self._journal.write(f"{number} {fingerprint} {found:08x}\n".encode())
            self._known[number] = fingerprint, found
            self._put.add(number)

    def read(self, number: int, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """A chunk that was found or put, mapped from the file. Raises OSError, ValueError."""
        return self._header.mapped(self.path, number * self._chunk_samples, shape[0])

    def complete(self) -> int:
        """The file holds every sample and is on the disk, not yet at its last place: its bytes.

        Raises whole_file.WriteError, and PointCacheError where a chunk is missing.
        """
        missing = set(range(-(-self._header.sample_count // self._chunk_samples))) - self._put
        if missing:
            raise PointCacheError(f"Chunks {sorted(missing)} were not computed: no sample may be missing")
        size = self._header.place(self._header.sample_count)
        with explained(self.path):
            if self._syncing is not None:
                self._syncing.result()
            self._file.truncate(size)
            os.fsync(self._file.fileno())
        return size

    def finish(self, path: Path) -> int:
        """The file is complete and stands at `path`: its bytes. No chunk may be mapped. Raises as `complete`."""
        size = self.complete()
        with explained(path):
            self._file.close()
            self.path.replace(path)
        self.path = path
        return size

    def close(self) -> None:
        """Close the files; finished chunks stay for another try."""
        self._syncs.shutdown()
        for file in (self._file, self._journal):
            with suppress(OSError):
                file.close()
        self._lock.close()

    def clear(self) -> None:
        """Remove what waits for another try; what another process uses stays."""
        is_shared = self._lock.is_shared
        self.close()
        if not is_shared:
            self._others.clear()
            return
        for path in (self.path, self._journal_path):
            if path.parent == self._folder:
                with suppress(OSError):
                    path.unlink()

    def _begin_to_sync(self) -> None:
        # While more is computed: there is little left to wait for at the end. A checksum tells what did not arrive.
        if self._syncing is None or self._syncing.done():
            if self._syncing is not None:
                self._syncing.result()
            self._syncing = self._syncs.submit(_sync, self._file.fileno())

    def _read_journal(self, layout: bytes) -> bool:
        """Whether it is of this cache; fills what it knows. Lines that say nothing are passed over."""
        try:
            first, *lines = self._journal_path.read_bytes().split(b"\n")
        except OSError:
            return False
        if first != layout:
            return False
        for line in lines:
            with suppress(ValueError):
                number, fingerprint, found = line.decode("ascii").split(" ")
                self._known[int(number)] = fingerprint, int(found, 16)
        return True


def _begins_with(path: Path, start: bytes) -> bool:
    """Whether the file is there and begins so."""
    try:
        with path.open("rb") as file:
            return file.read(len(start)) == start
    except OSError:
        return False


def _sync(file: int) -> None:
    """Returns when the data of the file is on the disk."""
    getattr(os, "fdatasync", os.fsync)(file)
