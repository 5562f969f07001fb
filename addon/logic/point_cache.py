"""PC2 point caches: one array of points per sample, as the Mesh Cache modifier reads them.

Little endian: 12 bytes `POINTCACHE2` and a zero, int32 version 1, int32 points, float32 first frame, float32 frames
from sample to sample, int32 samples; then float32 x, y, z of every point, sample by sample.
"""

from __future__ import annotations

import struct
from math import isfinite
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

MAGIC = b"POINTCACHE2\0"
VERSION = 1
_HEADER = struct.Struct("<12siiffi")
_POINT_BYTES = 12
_MOST = 2**31 - 1


class PointCacheError(ValueError):
    """No such cache, or one that is cut off; says what was found."""


class Header(NamedTuple):
    """What a file says of itself."""

    point_count: int
    first_frame: float
    step: float  # frames from sample to sample
    sample_count: int

    def packed(self) -> bytes:
        """The beginning of a file. Raises PointCacheError."""
        points, first, step, count = self
        if not 0 < points <= _MOST or not 0 < count <= _MOST:
            raise PointCacheError(f"A cache of {count} samples of {points} points holds nothing")
        return _HEADER.pack(MAGIC, VERSION, points, first, step, count)

    def place(self, sample: int) -> int:
        """Bytes before a sample; before one past the last: of the file."""
        return _HEADER.size + sample * self.point_count * _POINT_BYTES

    def mapped(self, path: Path, first: int, count: int) -> NDArray[np.float32]:
        """(S, N, 3) so many samples from `first` on, not loaded. Raises OSError, ValueError if they are missing."""
        return np.memmap(path, "<f4", "r", self.place(first), (count, self.point_count, 3))


def read(path: Path) -> tuple[Header, NDArray[np.float32]]:
    """The header and (S, N, 3) samples, mapped from the file, not loaded. Raises PointCacheError, OSError."""
    with path.open("rb") as file:
        start = file.read(_HEADER.size)
        size = file.seek(0, 2)
    if len(start) < _HEADER.size or start[: len(MAGIC)] != MAGIC:
        raise PointCacheError(f"{path.name} is no PC2 point cache")
    _, version, points, first, step, count = _HEADER.unpack(start)
    if version != VERSION:
        raise PointCacheError(f"{path.name} has version {version}, need {VERSION}")
    header = Header(points, first, step, count)
    if points < 1 or count < 1 or not (isfinite(first) and isfinite(step)):
        raise PointCacheError(
            f"{path.name} says {count} samples of {points} points, from frame {first:g} in steps of {step:g}: no cache"
        )
    if size < header.place(count):
        raise PointCacheError(f"{path.name} is cut off: {size} bytes, its header needs {header.place(count)}")
    return header, header.mapped(path, 0, count)
