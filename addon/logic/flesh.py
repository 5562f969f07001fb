"""A body bound to a rest spine: the engine's binding, and the same binding under the settings of a frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from . import splines
from .skin import Skin, Volumes

Kind = Literal["radial", "normal", "binormal"] | tuple[float, float, float]
Match = Literal["stations", "relative_length", "length"]


class Pose(NamedTuple):
    """How the spine lies in one frame."""

    spine: turgor.Spine
    twist: NDArray[np.float64]  # (n,) radians at each station of the rest spine
    slide: float
    stretch: bool


class Outcome(NamedTuple):
    """What a frame came to."""

    offsets: NDArray[np.float32]  # (N, 3)
    clamped_count: int
    volumes: Callable[[], Volumes] | None  # None of a limb


class Limb(NamedTuple):
    """What skinning makes of the vertices that the chain's bones hold, for the spine to replace."""

    skinning: turgor.Skinning
    weights: NDArray[np.float64]  # (N,) part of each vertex that the chain holds


class Bound(NamedTuple):
    """A body under the settings of a frame."""

    rest: turgor.Spine  # all of it
    fleshing: turgor.Fleshing  # along the part within reach
    kind: Kind
    match: Match
    shape_values: NDArray[np.float32]
    positions: NDArray[np.float64]  # (N, 3) at rest, with its shape keys


class Flesh:
    """Keeps the binding of the last settings, swapped as a whole: safe to call from several threads."""

    def __init__(
        self,
        positions: NDArray[np.float32],
        face_offsets: NDArray[np.int32],
        face_corners: NDArray[np.int32],
        shape_deltas: NDArray[np.float32],
        influence: NDArray[np.float64],
        limb: Limb | None,
    ) -> None:
        """Shapes as in `scene.rest.RestMesh`. influence: (N,) part of the way that a vertex goes."""
        self._positions = positions.astype(np.float64)
        self._shape_deltas = shape_deltas
        self._influence = influence if limb is None else influence * limb.weights
        self.limb = limb
        self._box = np.array([self._positions.min(axis=0), self._positions.max(axis=0)])
        # Of a limb other bones move the rest: what is missing there is for Turgor Volume to say.
        self._skin = None if limb else Skin(positions, face_offsets, face_corners, shape_deltas, influence)
        self._current: tuple[object, Bound | None] = (None, None)

    @property
    def vertex_count(self) -> int:
        """Vertices of the stack at Turgor Spine."""
        return len(self._positions)

    @property
    def mesh(self) -> turgor.Mesh | None:
        """The mesh whose volume is kept; None of a limb."""
        return None if self._skin is None else self._skin.mesh

    @property
    def shape_count(self) -> int:
        """Shape keys without the reference."""
        return len(self._shape_deltas)

    @property
    def box(self) -> NDArray[np.float64]:
        """(2, 3) least and greatest coordinates at rest."""
        return self._box

    def bind(
        self,
        key: object,
        rest_spine: Callable[[], turgor.Spine],
        reach: tuple[float, float],
        kind: Kind,
        match: Match,
        shape_values: NDArray[np.float32],
    ) -> Bound:
        """The binding for these settings. key: changes whenever what else they stand for does.

        reach: parts of the spine's length between which the body bends.
        """
        key = (key, reach, kind, match, shape_values.tobytes())
        known_key, bound = self._current
        if bound is None or known_key != key:
            positions = self._positions
            if shape_values.any():
                positions = positions + np.tensordot(shape_values.astype(np.float64), self._shape_deltas, 1)
            rest = rest_spine()
            within = splines.trimmed(rest, *reach)
            fleshing = turgor.Fleshing(within, positions, kind, match=match, influence=self._influence)
            bound = Bound(rest, fleshing, kind, match, shape_values, positions)
            self._current = (key, bound)
        return bound

    def deform(
        self,
        bound: Bound,
        pose: Pose,
        keep_volume: bool,
        pose_matrices: NDArray[np.float32] | None = None,
        object_from_armature: NDArray[np.float64] | None = None,
    ) -> Outcome:
        """One frame. The matrices are those of the limb's bones, as `turgor.Skinning.deform` takes them."""
        offsets = np.empty((self.vertex_count, 3), np.float32)
        report = bound.fleshing.deform_into(
            offsets, pose.spine, twist=pose.twist, slide=pose.slide, stretch=pose.stretch
        )
        if self.limb is not None and pose_matrices is not None:
            skinned = self.limb.skinning.deform(bound.positions, pose_matrices, object_from_armature)
            offsets -= (self._influence[:, None] * (skinned - bound.positions)).astype(np.float32)
        if self._skin is None:
            return Outcome(offsets, report.clamped_count, None)
        if keep_volume and pose.stretch:
            found = self._skin.keep(offsets, bound.shape_values)
            return Outcome(offsets, report.clamped_count, lambda: found)
        measure = self._skin.measure
        return Outcome(offsets, report.clamped_count, lambda: measure(offsets, bound.positions))
