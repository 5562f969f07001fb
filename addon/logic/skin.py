"""The surface of a body that follows its spine as a whole: what fleshing leaves of its volume is given back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray


class Volumes(NamedTuple):
    """Totals of all shells, each counted positive."""

    rest: float
    fleshed: float
    kept: float


class Skin:
    """Immutable; safe to call from several threads."""

    def __init__(
        self,
        positions: NDArray[np.float32],
        face_offsets: NDArray[np.int32],
        face_corners: NDArray[np.int32],
        shape_deltas: NDArray[np.float32],
        influence: NDArray[np.float64],
    ) -> None:
        """Shapes as in `scene.rest.RestMesh`. influence: (N,), vertices of 0 stay where they are."""
        self._mesh = turgor.Mesh(positions, face_offsets, face_corners)
        # To the engine a skin without bones: all that moves it is added.
        still = turgor.Skinning(turgor.Skeleton([-1], [np.eye(4)]), np.zeros(len(positions) + 1, np.int32), [], [])
        deltas = shape_deltas if len(shape_deltas) else None
        body = turgor.VolumeSkin(self._mesh, still, shape_deltas=deltas)
        self._body = body if (influence == 1.0).all() else body.with_mask(influence.astype(np.float32))

    @property
    def mesh(self) -> turgor.Mesh:
        """The mesh that was bound."""
        return self._mesh

    def keep(self, offsets: NDArray[np.float32], shape_values: NDArray[np.float32]) -> Volumes:
        """Adds to `offsets`, (N, 3), what each shell misses, evenly over the skin that may move."""
        correction = np.empty_like(offsets)
        report = self._body.deform_into(correction, [np.eye(4)], added_offsets=offsets, shape_values=shape_values)
        offsets += correction
        volumes = (report.target_volumes, report.skinned_volumes, report.corrected_volumes)
        return Volumes(*(float(np.abs(each).sum()) for each in volumes))

    def measure(self, offsets: NDArray[np.float32], rest: NDArray[np.float64]) -> Volumes:
        """The volumes with nothing given back."""
        before, after = (float(np.abs(self._mesh.component_volumes(p)).sum()) for p in (rest, rest + offsets))
        return Volumes(before, after, after)
