"""Chunks of a point cache, at their places in the file that becomes it: no position is written twice.

Beside the growing file lies a journal: a line per chunk, with the fingerprint of all that it was computed from and a
checksum. A killed bake goes on with what stands in both. Who bakes holds a lock on them; another bake beside it takes
files of its own.
"""

from __future__ import annotations

import errno
import os
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from itertools import count
from pathlib import Path
from threading import Lock
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from .chunk_store import ChunkStore, checksum_of
from .point_cache import Header, PointCacheError
from .whole_file import explained


class PointCacheStore:
    """Chunks of one cache. Those that another machine left as files of their own are found too."""

    def __init__(self, folder: Path, header: Header, chunk_samples: int) -> None:
        """Raises whole_file.WriteError, PointCacheError."""
        self._folder, self._header, self._chunk_samples = folder, header, chunk_samples
        self._others = ChunkStore(folder)
        self._written = Lock()
        self._syncs = ThreadPoolExecutor(1, "turgor-sync")
        self._syncing: Future[None] | None = None
        self._known: dict[int, tuple[str, int]] = {}
        self.found_count = 0
        start = header.packed()
        with explained(folder / "cache"):
            folder.mkdir(parents=True, exist_ok=True)
            self._lock, name = _locked(folder)
            self.path = folder / f"{name}.pc2"
            self._journal_path = folder / f"{name}.journal"
            layout = f"{header} {chunk_samples}"
            self._read_journal(layout)
            self._file = self.path.open("r+b" if self._known else "w+b", buffering=0)
            self._journal = self._journal_path.open("a" if self._known else "w", encoding="utf-8", buffering=1)
            if not self._known:
                self._file.write(start)
                self._journal.write(layout)
            # A line that a kill has cut stays one of its own.
            self._journal.write("\n")

    def beside(self, kind: str) -> ChunkStore:
        """As of `ChunkStore`."""
        return self._others.beside(kind)

    def may_have(self, number: int) -> bool:
        """As of `ChunkStore`."""
        return number in self._known or self._others.may_have(number)

    def find(self, number: int, fingerprint: str, shape: tuple[int, ...]) -> NDArray[np.float32] | None:
        """As of `ChunkStore`. Raises whole_file.WriteError."""
        known, checksum = self._known.get(number, ("", 0))
        if known == fingerprint:
            with suppress(OSError, ValueError):
                chunk = self.read(number, shape)
                if checksum_of(chunk) == checksum:
                    self.found_count += 1
                    return chunk
        chunk = self._others.find(number, fingerprint, shape)
        if chunk is not None:
            self.put(number, fingerprint, chunk)
            self.found_count += 1
        return chunk

    def put(self, number: int, fingerprint: str, chunk: NDArray[np.float32]) -> None:
        """Raises whole_file.WriteError, PointCacheError."""
        first = number * self._chunk_samples
        samples = min(self._chunk_samples, self._header.sample_count - first)
        if chunk.shape != (samples, self._header.point_count, 3):
            raise PointCacheError(
                f"Samples from {first} on are {chunk.shape}, need ({samples}, {self._header.point_count}, 3)"
            )
        with self._written, explained(self.path):
            self._file.seek(self._header.place(first))
            chunk = np.ascontiguousarray(chunk, "<f4")
            checksum, rest = checksum_of(chunk), chunk.data.cast("B")
            while rest:
                rest = rest[self._file.write(rest) :]
            self._begin_to_sync()
            self._journal.write(f"{number} {fingerprint} {checksum:08x}\n")
            self._known[number] = fingerprint, checksum

    def read(self, number: int, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """A chunk that was found or put, mapped from the file. Raises OSError, ValueError."""
        return self._header.mapped(self.path, number * self._chunk_samples, shape[0])

    def finish(self, path: Path) -> int:
        """The file is complete, on the disk, and stands at `path`: its bytes. No chunk may be mapped.

        Raises whole_file.WriteError, and PointCacheError where a chunk is missing.
        """
        missing = set(range(-(-self._header.sample_count // self._chunk_samples))) - self._known.keys()
        if missing:
            raise PointCacheError(f"Chunks {sorted(missing)} were not computed: no sample may be missing")
        with explained(path):
            if self._syncing is not None:
                self._syncing.result()
            os.fsync(self._file.fileno())
            self.close()
            self.path.replace(path)
        self.path = path
        return self._header.place(self._header.sample_count)

    def close(self) -> None:
        """What is there waits for another try."""
        self._syncs.shutdown()
        for file in (self._file, self._journal, self._lock):
            with suppress(OSError):
                file.close()

    def clear(self) -> None:
        """Remove what waits for another try."""
        self.close()
        self._others.clear()

    def _begin_to_sync(self) -> None:
        # While more is computed: there is little left to wait for at the end. A checksum tells what did not arrive.
        if self._syncing is None or self._syncing.done():
            if self._syncing is not None:
                self._syncing.result()
            self._syncing = self._syncs.submit(_sync, self._file.fileno())

    def _read_journal(self, layout: str) -> None:
        try:
            first, *lines = self._journal_path.read_text("utf-8").splitlines()
        except (OSError, ValueError):
            return
        if first != layout or not self.path.exists():
            return
        for line in lines:
            with suppress(ValueError):
                number, fingerprint, checksum = line.split(" ")
                self._known[int(number)] = fingerprint, int(checksum, 16)


def _sync(file: int) -> None:
    """Returns when the data of the file is on the disk."""
    getattr(os, "fdatasync", os.fsync)(file)


def _locked(folder: Path) -> tuple[BinaryIO, str]:
    """A lock that no other process holds, let go when closed or its process ends, and a name that goes with it."""
    for number in count():
        name = f"cache{number or ''}"
        file = (folder / f"{name}.lock").open("ab")
        try:
            _lock(file)
        except OSError as error:
            if error.errno in {errno.EACCES, errno.EAGAIN, errno.EDEADLK}:
                file.close()
                continue
            # A file system without locks: two bakes of one object at one time would be odd.
        return file, name
    raise AssertionError("numbers do not end")


def _lock(file: BinaryIO) -> None:
    """Raises OSError where another process holds it."""
    if os.name == "nt":
        import msvcrt

        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
