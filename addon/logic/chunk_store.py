"""Chunks of a long computation, kept on disk so that a killed one goes on where it was.

Each chunk is one `.npy` file named after its number and a fingerprint of all that it was computed from: what is found
under that name is what would be computed. Files are whole or not there, whatever kills the process. Nobody waits until
they are on the disk: a checksum after the array tells which ones a power cut has torn.
"""

from __future__ import annotations

import shutil
import struct
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .whole_file import UNFINISHED, written

_CHECKSUM = struct.Struct("<Q")


class ChunkStore:
    """Chunks in a folder of their own."""

    def __init__(self, folder: Path, kind: str = "") -> None:
        self._folder, self._kind = folder, kind
        self._paths: dict[int, Path] = {}
        self._names = {path.name.partition("-")[0] for path in folder.glob("*.npy")}
        self.found_count = 0

    def beside(self, kind: str) -> ChunkStore:
        """Chunks of another kind in the same folder; cleared with these."""
        return ChunkStore(self._folder, f"{kind}_")

    def may_have(self, number: int) -> bool:
        """Whether a chunk of that number was there at the beginning, whatever it was computed from."""
        return f"{self._kind}{number:06d}" in self._names

    def find(self, number: int, fingerprint: str, shape: tuple[int, ...]) -> NDArray[np.float32] | None:
        """The chunk as it was put, float32 of this shape, mapped from its file; None where it has to be computed."""
        path = self._path(number, fingerprint)
        try:
            chunk = np.load(path, mmap_mode="r", allow_pickle=False)
            with path.open("rb") as file:
                file.seek(-_CHECKSUM.size, 2)
                checksum = file.read()
        except (OSError, ValueError, EOFError):
            return None
        if chunk.shape != shape or chunk.dtype != np.float32 or checksum != _CHECKSUM.pack(checksum_of(chunk)):
            return None
        self.found_count += 1
        self._paths[number] = path
        return chunk

    def put(self, number: int, fingerprint: str, chunk: NDArray[np.float32]) -> None:
        """Raises whole_file.WriteError."""
        path = self._path(number, fingerprint)
        with written(path, is_kept=False) as file:
            np.lib.format.write_array_header_1_0(file, np.lib.format.header_data_from_array_1_0(chunk))
            file.write(chunk.data)
            file.write(_CHECKSUM.pack(checksum_of(chunk)))
        if self.may_have(number):
            for older in self._folder.glob(f"{path.name.partition('-')[0]}-*"):
                if older != path and not older.name.endswith(UNFINISHED):
                    with suppress(OSError):
                        older.unlink()
        self._paths[number] = path

    def read(self, number: int, _shape: tuple[int, ...]) -> NDArray[np.float32]:
        """A chunk that was found or put, mapped from its file. Raises OSError, ValueError."""
        return np.load(self._paths[number], mmap_mode="r", allow_pickle=False)

    def close(self) -> None:
        """What is there waits for another try."""

    def clear(self) -> None:
        """Remove all chunks; those still mapped live on until they are let go, where the system allows it."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def _path(self, number: int, fingerprint: str) -> Path:
        return self._folder / f"{self._kind}{number:06d}-{fingerprint}.npy"


def checksum_of(chunk: NDArray[np.float32]) -> int:
    """Sum of its 64-bit words, modulo 2^64: as fast as memory. Parts that a power cut has left out do not go unseen."""
    words = chunk.reshape(-1).view("<u4")
    pairs = words[: len(words) // 2 * 2].view("<u8")
    return (int(np.add.reduce(pairs, dtype=np.uint64)) + int(words[2 * len(pairs) :].sum(dtype=np.uint64))) % (1 << 64)
