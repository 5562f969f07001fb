"""What a bake came to: how far its copy is off, frame by frame, from the live character and from what was computed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import frame_range
from .bake_files import Source

# Of the text, so that others can tell what they read.
FORMAT = 2


@dataclass(frozen=True)
class FrameError:
    """One frame. Lengths in units of the object, and in parts of its size."""

    frame: float
    max_error: float
    rms_error: float
    max_error_relative: float
    volume_error_relative: float  # of the copy against the other


@dataclass
class BakeReport:
    """A bake. Sizes in bytes, lengths in units of the object."""

    name: str
    method: str
    frames: str
    frame_count: int
    vertex_count: int
    size: float  # diagonal of the mesh at rest
    key_count: int = 0
    byte_count: int = 0
    seconds: float = 0.0
    tolerance: float | None = None
    held_out_error: float | None = None  # of frames that pose-driven keys were not made from
    clamped_count: int = 0  # vertices, over all frames, where the target's skinning has no inverse
    resumed_chunks: int = 0
    # Where folds are repaired: frames with any, pairs of triangles found and left; over all frames.
    fold_frame_count: int | None = None
    folds_found: int = 0
    folds_left: int = 0
    notes: list[str] = field(default_factory=list)
    settings: dict[str, Any] = field(default_factory=dict)
    source: Source | None = None  # None where nothing is written
    # Of the copy from the character as Blender evaluates it, on frames that stand for all; and from the positions that
    # it was made of, on every frame.
    live_errors: list[FrameError] = field(default_factory=list)
    computed_errors: list[FrameError] = field(default_factory=list)

    def count_folds(self, counts: Sequence[NDArray[np.float32]]) -> None:
        """counts: (S, 3) of each chunk, as `VolumeSkin.deform_many` counts them; none where folds are not repaired."""
        if not counts:
            return
        found, left, _ = np.concatenate(counts).astype(np.int64).T
        self.fold_frame_count = int(np.count_nonzero(found))
        self.folds_found, self.folds_left = int(found.sum()), int(left.sum())

    @property
    def errors(self) -> list[FrameError]:
        """All that were measured."""
        return [*self.live_errors, *self.computed_errors]

    @property
    def max_error(self) -> float:
        """The largest that was measured anywhere; 0 where nothing was."""
        return _largest(self.errors)

    @property
    def max_error_relative(self) -> float:
        """Part of the size."""
        return self.max_error / self.size if self.size else 0.0

    @property
    def rms_error(self) -> float:
        """Root of the mean square over the frames of the comparison that came out worse."""
        return max(_rms(self.live_errors), _rms(self.computed_errors))

    @property
    def volume_error_relative(self) -> float:
        """The largest in size, with its sign."""
        return max((error.volume_error_relative for error in self.errors), key=abs, default=0.0)

    @property
    def live_frames(self) -> str:
        """Frames that were compared with the live character, as text."""
        return frame_range.text_of(np.array([error.frame for error in self.live_errors]))

    def as_dict(self) -> dict[str, Any]:
        """The whole report in types of JSON."""
        return {
            "format": FORMAT,
            **asdict(self),
            "source": None if self.source is None else self.source._asdict(),
            "live_frames": self.live_frames,
            "live_frame_count": len(self.live_errors),
            "max_error": self.max_error,
            "max_error_relative": self.max_error_relative,
            "rms_error": self.rms_error,
            "volume_error_relative": self.volume_error_relative,
        }

    def as_json(self) -> str:
        """The whole report as JSON; equal reports give equal texts."""
        return json.dumps(self.as_dict(), indent=1) + "\n"

    def lines(self) -> list[str]:
        """A few lines for a person."""
        percent = 100.0 / self.size if self.size else 0.0
        found = [f"{self.frame_count} frames ({self.frames}), {self.vertex_count} vertices"]
        if self.key_count:
            found.append(f"{self.key_count} shape keys")
        found.append(f"{self.byte_count / 1e6:.1f} MB in {self.seconds:.1f} s")
        if self.errors:
            found += self.comparison()
            found.append(f"Volume within {100.0 * self.volume_error_relative:+.2g} %")
        if self.held_out_error is not None:
            found.append(f"Largest error on other poses {self.held_out_error * percent:.2g} %")
        if self.fold_frame_count is not None:
            found.append(f"Folds on {self.fold_frame_count} frames: {self.folds_found} found, {self.folds_left} left")
        if self.clamped_count:
            found.append(f"{self.clamped_count} times skinning flattened a vertex: its key was clamped")
        return found + self.notes

    def comparison(self) -> list[str]:
        """What was compared with what, and how far it is off."""
        of = f"of {self.frame_count} frames"
        parts = (
            ("the live character", self.live_errors, f"{len(self.live_errors)} {of}"),
            ("the computed positions", self.computed_errors, f"{len(self.computed_errors)} {of}"),
        )
        percent = 100.0 / self.size if self.size else 0.0
        return [
            f"Largest error {_largest(errors) * percent:.2g} % of the size, RMS {_rms(errors) * percent:.2g} %,"
            f" compared with {what} on {which}"
            if errors
            else f"Not compared with {what}"
            for what, errors, which in parts
        ]

    def as_text(self) -> str:
        """The lines, and one for each frame."""
        rows = [
            f"frame {error.frame:g}, {what}: max {error.max_error:.3e}, rms {error.rms_error:.3e},"
            f" volume {error.volume_error_relative:+.3e}"
            for what, errors in (("live", self.live_errors), ("computed", self.computed_errors))
            for error in errors
        ]
        return "\n".join([f"{self.name}: {self.method}", *self.lines(), *rows]) + "\n"


def _largest(errors: Sequence[FrameError]) -> float:
    return max((error.max_error for error in errors), default=0.0)


def _rms(errors: Sequence[FrameError]) -> float:
    squares = [error.rms_error**2 for error in errors]
    return float(np.sqrt(np.mean(squares))) if squares else 0.0
