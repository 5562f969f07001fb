"""What the steps of a bake hand to each other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from ..logic.bake_report import BakeReport
from ..logic.chunk_store import ChunkStore
from ..logic.point_cache_store import PointCacheStore
from .computing import Computing
from .options import Options
from .skinned_rest import Posed
from .spine_frames import SpineFrames
from .volume_frames import VolumeFrames

# Part of the work that is done when the live frames are computed, and when the copy is made.
# And when the copy was compared with what it was made of.
FRAMES_DONE, MADE, COMPARED = 0.4, 0.7, 0.8


class Progress(NamedTuple):
    """How far a bake has come."""

    part: float  # 0 to 1
    text: str


@dataclass
class Baking:
    """One bake under way."""

    target: bpy.types.Object
    source: VolumeFrames | SpineFrames
    options: Options
    report: BakeReport
    live: Computing | None = None  # all of whose frames are sampled
    store: ChunkStore | PointCacheStore | None = None  # of its chunks; None: in memory
    copy: bpy.types.Object | None = None  # carries the bake
    last: str | None = None  # its modifier that shows the live positions; None: its keys do

    @property
    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """(S, N, 3) live positions, in order of the frames, as they are done."""
        assert self.live is not None
        return self.live.chunks

    @property
    def poses(self) -> list[Posed | None]:
        """(F,) None without an Armature."""
        assert self.live is not None
        return self.live.poses

    @property
    def size(self) -> float:
        return self.report.size

    def making(self, done: float, text: str) -> Progress:
        """While the copy is made; done: 0 to 1."""
        return Progress(FRAMES_DONE + (MADE - FRAMES_DONE) * done, text)
