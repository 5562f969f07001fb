"""Chunks of a long computation, kept on disk so that a killed one goes on where it was.

Each chunk is one `.npy` file named after its number and a fingerprint of all that it was computed from: what is found
under that name is what would be computed. Files are whole or not there, whatever kills the process. Nobody waits until
they are on the disk: a checksum after the array tells which ones a power cut has torn.
"""

from __future__ import annotations

import io
import shutil
import struct
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .checksum import checksum
from .folder_lock import FolderLock
from .whole_file import UNFINISHED, explained, written

_CHECKSUM = struct.Struct("<I")


class ChunkStore:
    """Chunks in a folder of their own."""

    def __init__(self, folder: Path, kind: str = "") -> None:
        self._folder, self._kind = folder, kind
        self._lock: FolderLock | None = None
        self._paths: dict[int, Path] = {}
        self._names = {path.name.partition("-")[0] for path in folder.glob("*.npy")}
        self.found_count = 0

    def hold(self) -> ChunkStore:
        """Until `close` no other process clears the folder. Raises whole_file.WriteError."""
        with explained(self._folder / "chunks"):
            self._lock = FolderLock(self._folder)
        return self

    def beside(self, kind: str) -> ChunkStore:
        """Chunks of another kind in the same folder; cleared with these."""
        return ChunkStore(self._folder, f"{kind}_")

    def may_have(self, number: int) -> bool:
        """Whether a chunk of that number was there at the beginning, whatever it was computed from."""
        return f"{self._kind}{number:06d}" in self._names

    def find(self, number: int, fingerprint: str, shape: tuple[int, ...]) -> NDArray[np.float32] | None:
        """The chunk as it was put, float32 of this shape, mapped from its file; None where it has to be computed."""
        path, header = self._path(number, fingerprint), _header(shape)
        length = 4 * int(np.prod(shape, dtype=np.int64))
        try:
            with path.open("rb") as file:
                is_whole = file.seek(0, 2) == len(header) + length + _CHECKSUM.size
                file.seek(0)
                if not is_whole or file.read(len(header)) != header:
                    return None
                file.seek(-_CHECKSUM.size, 2)
                expected = file.read()
            chunk = _mapped(path, shape)
        except (OSError, ValueError):
            return None
        if expected != _CHECKSUM.pack(checksum(number, self._kind + fingerprint, chunk)):
            return None
        self.found_count += 1
        self._paths[number] = path
        return chunk

    def put(self, number: int, fingerprint: str, chunk: NDArray[np.float32]) -> None:
        """Raises whole_file.WriteError."""
        path = self._path(number, fingerprint)
        chunk = np.ascontiguousarray(chunk, "<f4")
        with written(path, is_kept=False) as file:
            file.write(_header(chunk.shape))
            file.write(chunk.data)
            file.write(_CHECKSUM.pack(checksum(number, self._kind + fingerprint, chunk)))
        if self.may_have(number):
            for older in self._folder.glob(f"{path.name.partition('-')[0]}-*"):
                if older != path and not older.name.endswith(UNFINISHED):
                    with suppress(OSError):
                        older.unlink()
        self._paths[number] = path

    def read(self, number: int, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """A chunk that was found or put, mapped from its file. Raises OSError, ValueError."""
        return _mapped(self._paths[number], shape)

    def close(self) -> None:
        """Let go of the folder; finished chunks stay for another try."""
        if self._lock is not None:
            self._lock.close()

    def clear(self) -> None:
        """Remove all chunks, unless another process uses them; it will.

        Those still mapped live on until they are let go, where the system allows it.
        """
        is_shared = self._lock is not None and self._lock.is_shared
        self.close()
        if not is_shared:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _path(self, number: int, fingerprint: str) -> Path:
        return self._folder / f"{self._kind}{number:06d}-{fingerprint}.npy"


def _header(shape: tuple[int, ...]) -> bytes:
    """How the file of a chunk begins: no other header is read, so none can mislead."""
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(file, {"descr": "<f4", "fortran_order": False, "shape": tuple(shape)})
    return file.getvalue()


def _mapped(path: Path, shape: tuple[int, ...]) -> NDArray[np.float32]:
    if not np.prod(shape):
        return np.zeros(shape, np.float32)
    return np.memmap(path, "<f4", "r", len(_header(shape)), tuple(shape))
