"""PC2 point caches: one array of points per sample, as the Mesh Cache modifier reads them.

Little endian: 12 bytes `POINTCACHE2` and a zero, int32 version 1, int32 points, float32 first frame, float32 frames
from sample to sample, int32 samples; then float32 x, y, z of every point, sample by sample.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO, NamedTuple

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


def write(file: BinaryIO, header: Header, samples: Iterable[NDArray[np.float32]]) -> int:
    """`samples`: arrays (S, N, 3) whose S sum to the header's. The bytes written. Raises PointCacheError."""
    if not 0 < header.point_count <= _MOST or not 0 < header.sample_count <= _MOST:
        raise PointCacheError(f"A cache of {header.sample_count} samples of {header.point_count} points holds nothing")
    points, first, step, count = header
    file.write(_HEADER.pack(MAGIC, VERSION, points, first, step, count))
    written = 0
    for part in samples:
        if part.ndim != 3 or part.shape[1:] != (points, 3):
            raise PointCacheError(f"Samples are {part.shape}, need (S, {points}, 3)")
        file.write(np.ascontiguousarray(part, "<f4").data)
        written += len(part)
    if written != count:
        raise PointCacheError(f"{written} samples were given, the header says {count}: no sample may be missing")
    return _HEADER.size + written * points * _POINT_BYTES


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
    needed = _HEADER.size + points * count * _POINT_BYTES
    if points < 1 or count < 1 or size < needed:
        raise PointCacheError(f"{path.name} is cut off: {size} bytes, its header needs {needed}")
    samples = np.memmap(path, "<f4", "r", _HEADER.size, (count, points, 3))
    return Header(points, first, step, count), samples
