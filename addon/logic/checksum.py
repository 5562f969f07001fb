"""Checksums that tell a chunk from any other: also from its own words, samples or neighbours in another order."""

from __future__ import annotations

from zlib import crc32

import numpy as np
from numpy.typing import NDArray


def checksum(number: int, fingerprint: str, chunk: NDArray[np.float32]) -> int:
    """32 bits, of the place of a chunk in its bake, what it was computed from, its shape and all its bytes.

    CRC-32: whatever changes within 32 bits in a row is seen for certain, anything else but for one case in 2^32. It is
    a tenth of the time that the disk takes.
    """
    named = crc32(f"{number} {fingerprint} {chunk.shape} {chunk.dtype.str}".encode())
    return crc32(np.ascontiguousarray(chunk).data.cast("B"), named) if chunk.size else named
