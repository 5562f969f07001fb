"""A body bound to a rest spine: the engine's binding, and the same binding under the settings of a frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from . import splines

Kind = Literal["radial", "normal", "binormal"] | tuple[float, float, float]
Match = Literal["stations", "relative_length", "length"]

# Vertices of less than this part of the largest area do not move further than others.
LEAST_AREA = 1e-6


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
    fleshed_volume: float | None  # total, before the rest was removed
    kept_volume: float | None


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
    skin: _Skin | None  # where the total volume can be kept


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
        self._faces = (face_offsets, face_corners)
        self._current: tuple[object, Bound | None] = (None, None)

    @property
    def vertex_count(self) -> int:
        """Vertices of the stack at Turgor Spine."""
        return len(self._positions)

    @property
    def positions(self) -> NDArray[np.float64]:
        """(N, 3) at rest, without shape keys."""
        return self._positions

    @property
    def box(self) -> NDArray[np.float64]:
        """(2, 3) least and greatest coordinates at rest."""
        return np.array([self._positions.min(axis=0), self._positions.max(axis=0)])

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
            bound = Bound(
                rest, fleshing, kind, match, None if self.limb else _Skin(positions, *self._faces, self._influence)
            )
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
            skinned = self.limb.skinning.deform(self._positions, pose_matrices, object_from_armature)
            offsets -= (self._influence[:, None] * (skinned - self._positions)).astype(np.float32)
        if bound.skin is None or bound.skin.rest_volume == 0.0:
            return Outcome(offsets, report.clamped_count, None, None)
        return bound.skin.keep(offsets, report.clamped_count, keep_volume and pose.stretch)


class _Skin:
    """The surface of a body that follows its spine as a whole: what is left of its volume can be given back."""

    def __init__(
        self,
        positions: NDArray[np.float64],
        face_offsets: NDArray[np.int32],
        face_corners: NDArray[np.int32],
        influence: NDArray[np.float64],
    ) -> None:
        self._positions = positions
        self._mesh = turgor.Mesh(positions, face_offsets, face_corners)
        self._volumes = self._mesh.component_volumes(positions)
        self._may_move = influence * _evenly(self._mesh, positions)
        components = self._mesh.vertex_components
        moves = np.zeros(len(self._volumes), bool)
        moves[components[(components >= 0) & (self._may_move > 0)]] = True
        self._moves = moves

    @property
    def rest_volume(self) -> float:
        return float(np.abs(self._volumes).sum())

    def keep(self, offsets: NDArray[np.float32], clamped_count: int, keep_volume: bool) -> Outcome:
        """Adds to `offsets` what each shell misses, evenly over its skin."""
        fleshed = self._positions + offsets
        found = self._mesh.component_volumes(fleshed)
        total = float((found * np.sign(self._volumes)).sum())
        if not keep_volume or not self._moves.any():
            return Outcome(offsets, clamped_count, total, total)
        target = np.where(self._moves, self._volumes, found)
        kept = turgor.correct(self._mesh, fleshed, target, self._may_move)
        np.subtract(kept, self._positions, out=offsets, casting="same_kind")
        kept_volumes = self._mesh.component_volumes(kept)
        return Outcome(offsets, clamped_count, total, float((kept_volumes * np.sign(self._volumes)).sum()))


def _evenly(mesh: turgor.Mesh, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) factor on the volume's gradient that moves all of the skin alike; 0 where there is no skin."""
    areas = np.linalg.norm(mesh.volume_gradient(positions), axis=1)
    most = areas.max(initial=0.0)
    return 1.0 / np.maximum(areas, LEAST_AREA * most) if most > 0.0 else np.zeros(len(areas))
