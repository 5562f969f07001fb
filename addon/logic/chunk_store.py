"""Chunks of a long computation, kept on disk so that a killed one goes on where it was.

Each chunk is one `.npy` file named after its number and a fingerprint of all that it was computed from: what is found
under that name is what would be computed. Files are whole or not there.
"""

from __future__ import annotations

import shutil
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .whole_file import UNFINISHED, written


class ChunkStore:
    """Chunks in a folder of their own, or in memory without one."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self.found_count = 0

    def find(self, number: int, fingerprint: str, shape: tuple[int, ...]) -> NDArray[np.float32] | None:
        """The chunk as it was put, float32 of this shape, mapped from its file; None where it has to be computed."""
        if self._folder is None:
            return None
        try:
            chunk = np.load(self._path(number, fingerprint), mmap_mode="r", allow_pickle=False)
        except (OSError, ValueError, EOFError):
            return None
        if chunk.shape != shape or chunk.dtype != np.float32:
            return None
        self.found_count += 1
        return chunk

    def put(self, number: int, fingerprint: str, chunk: NDArray[np.float32]) -> NDArray[np.float32]:
        """The chunk to go on with, mapped from its file where there is one. Raises whole_file.WriteError."""
        if self._folder is None:
            return chunk
        path = self._path(number, fingerprint)
        with written(path) as file:
            np.save(file, chunk, allow_pickle=False)
        for older in self._folder.glob(f"{path.name.partition('-')[0]}-*"):
            if older != path and not older.name.endswith(UNFINISHED):
                with suppress(OSError):
                    older.unlink()
        return np.load(path, mmap_mode="r", allow_pickle=False)

    def clear(self) -> None:
        """Remove all chunks; those still mapped live on until they are let go, where the system allows it."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _path(self, number: int, fingerprint: str) -> Path:
        assert self._folder is not None
        return self._folder / f"{number:06d}-{fingerprint}.npy"
