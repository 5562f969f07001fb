"""What the demonstration found: the contents of report.json."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Component:
    """One shell of a mesh. Volumes in cubic units of the object, errors relative to the target volume.

    float32_floor: the error when the engine's own positions, in double precision, are merely rounded to the single
    precision in which Blender stores them. armature_float32_error: that of Blender's Armature modifier, which computes
    in single precision, against the same skinning in double precision: the correction is added on top of it.
    """

    status: str
    vertices: int
    rest_volume: float
    is_corrected: bool
    max_relative_volume_error_before: float | None = None
    max_relative_volume_error_after: float | None = None
    float32_floor: float | None = None
    armature_float32_error: float | None = None


@dataclass(frozen=True)
class Timings:
    """Medians over the frames, milliseconds. The four parts sum to the live frame."""

    read: float
    engine: float
    write: float
    depsgraph: float

    @property
    def frame(self) -> float:
        """The whole live frame."""
        return self.read + self.engine + self.write + self.depsgraph


@dataclass(frozen=True)
class Moment:
    """One frame of the plot: volume of all corrected shells, relative to their target."""

    take: str
    frame: int
    relative_volume_before: float
    relative_volume_after: float


@dataclass(frozen=True)
class ObjectReport:
    """One mesh. Volumes are measured on Blender's evaluated mesh, independently of the engine.

    The errors are the largest over all frames and corrected shells: against the target volume, which follows the scale
    of bones, and against the rest volume. None where no shell is corrected; `problem` then says why.
    """

    file: str
    object: str
    vertices: int
    bones: int
    frames: int
    max_relative_volume_error_before: float | None = None
    max_relative_volume_error_after: float | None = None
    max_relative_rest_volume_error_before: float | None = None
    max_relative_rest_volume_error_after: float | None = None
    median_ms_per_frame: Timings | None = None
    armature_ms: float | None = None
    armature_only_frame_ms: float | None = None
    engine_to_armature_ratio: float | None = None
    live_to_armature_only_frame_ratio: float | None = None
    worst_take: str | None = None
    worst_frame: int | None = None
    problem: str | None = None
    components: list[Component] = field(default_factory=list)
    moments: list[Moment] = field(default_factory=list)

    @property
    def is_corrected(self) -> bool:
        """True when at least one shell keeps its volume."""
        return self.max_relative_volume_error_after is not None


@dataclass(frozen=True)
class Report:
    """One file played in one Blender."""

    blender: str
    turgor: str
    processors: int
    objects: list[ObjectReport]

    def write(self, path: Path) -> None:
        """Saves as JSON; numbers that are not finite are an error, not a value."""
        path.write_text(json.dumps(asdict(self), indent=2, allow_nan=False) + "\n", encoding="utf-8")
