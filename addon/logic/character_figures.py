"""Figures of one character: what panels and overlays write of its last frame, and of the frames that were measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class JointFigures:
    """What one joint took and got back in a frame, in percent of the character's rest volume."""

    lost: float
    regained: float
    is_capped: bool  # its field ran out of room


@dataclass(frozen=True)
class Folds:
    """Pairs of triangles that the correction alone makes pass through each other, and vertices held against that."""

    found_count: int
    left_count: int
    blocked_count: int


@dataclass(frozen=True)
class VolumeFigures:
    """One frame of a character in the viewport. Deviations in percent of the volume at full strength."""

    # As the engine says of its own solution, and of skinning.
    corrected_deviation: float
    skinned_deviation: float
    # Measured on the mesh that the viewport shows; None where that has other vertices than were bound.
    shown_deviation: float | None
    joints: dict[str, JointFigures]  # by the name of the bone at whose head the joint is
    folds: Folds | None = None  # where they are repaired
    # (K,) of each shell, as the mesh right after Turgor Volume should have it; None where it shows only a part of that.
    computed_volumes: NDArray[np.float64] | None = None
    reach: float = 0.0  # how far the armature's origin is, object space
    target_volume: float = 0.0  # at full strength


@dataclass(frozen=True)
class Motion:
    """A character over many poses, as `VolumeFigures` of each: F poses, J joints."""

    # (F,) of the scene, rising; None: poses of the test range of motion, which has no time.
    frames: NDArray[np.float64] | None
    corrected_deviations: NDArray[np.float64]  # (F,) percent
    skinned_deviations: NDArray[np.float64]  # (F,) percent
    targets: NDArray[np.float64]  # (F,) volumes at full strength
    joint_names: tuple[str, ...]
    joint_losses: NDArray[np.float64]  # (F, J) percent of the rest volume
    # Largest loss of each joint in the unit of `TurgorJoint.fold_loss`.
    fold_losses: dict[str, float]
    # (F,) percent, measured on Blender's mesh beside the solver: right after Turgor Volume, and after all modifiers
    # but simulations, NaN where those make other vertices. None where no mesh was evaluated.
    measured_deviations: NDArray[np.float64] | None = None
    final_deviations: NDArray[np.float64] | None = None

    @property
    def is_measured(self) -> bool:
        """Whether `seen_deviations` were measured."""
        return self.final_deviations is not None and bool(np.isfinite(self.final_deviations).all())

    @property
    def seen_deviations(self) -> NDArray[np.float64]:
        """(F,) percent of the mesh that is seen: measured where that could be done, else as the engine says."""
        found = self.final_deviations
        return found if found is not None and self.is_measured else self.corrected_deviations


@dataclass(frozen=True)
class SpineFigures:
    """One frame of a fleshed body. Deviations in percent of the rest volume; None where nothing encloses one."""

    point_count: int
    clamped_count: int
    fleshed_deviation: float | None
    kept_deviation: float | None
    # Measured on the mesh that the viewport shows; None where that has other vertices than were bound.
    shown_deviation: float | None = None


@dataclass(frozen=True)
class Timing:
    """What one frame took, in milliseconds."""

    read: float
    engine: float
    write: float

    @property
    def total(self) -> float:
        """Milliseconds of reading, engine and writing together."""
        return self.read + self.engine + self.write
