"""What is to be baked, and how."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..logic import compared_frames

Method = Literal["ABSOLUTE", "CORRECTIVE", "REDUCED", "DRIVEN", "POINT_CACHE"]
CORRECTIVE_METHODS = frozenset({"CORRECTIVE", "REDUCED", "DRIVEN"})


class BakeError(ValueError):
    """Why nothing is baked, and what to do."""


@dataclass(frozen=True)
class Options:
    """Settings of one bake."""

    method: Method
    frames: NDArray[np.float64]  # (F,) rising
    # Largest error of reduced and driven keys: units of the object, or part of the size of the mesh.
    tolerance: float = 0.0
    tolerance_is_relative: bool = False
    # Key values from 0 to 1 only, as some engines clamp them.
    unit_values: bool = False
    # Reduced keys that move the skin around one joint each.
    local_keys: bool = False
    # The skinning that will play corrective keys: this many influences of each vertex, 0 for all, and blended linearly.
    influences: int = 0
    use_linear: bool = False
    # Most pose-driven keys.
    most_keys: int = 64
    # Where caches, chunks and reports go; None: memory only.
    folder: Path | None = None
    # Files of other characters in that folder may be overwritten.
    overwrite: bool = False
    verify: bool = True
    # Frames that are compared with the live character; 0: all.
    live_frames: int = compared_frames.MOST_FRAMES
    # Repair folds on every frame, also where the character does not.
    repair_folds: bool = False
    name: str = ""
    # Frames of a chunk; 0: by the size of the mesh.
    chunk_frames: int = 0

    def as_dict(self) -> dict[str, Any]:
        """What tells this bake from another of the same frames, for JSON."""
        names = ("unit_values", "local_keys", "influences", "use_linear", "most_keys", "repair_folds")
        return {name: getattr(self, name) for name in names}
