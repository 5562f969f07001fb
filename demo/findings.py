"""From two playings of a mesh, without and with Turgor, to its part of the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .enclosed_volume import Points
from .report import Component, Moment


@dataclass(frozen=True)
class Volumes:
    """Volumes of K components over F frames, (F, K), and at rest, (K,); is_corrected: (K,)."""

    before: Points
    after: Points
    skinned: Points  # before, in double precision
    rounding: Points  # added by single precision alone
    target: Points
    rest: Points
    is_corrected: NDArray[np.bool_]

    def largest_error(self, volumes: Points, intended: Points) -> float | None:
        """Largest relative error over frames and corrected components; None where nothing is corrected."""
        if not self.is_corrected.any():
            return None
        errors = np.abs(volumes - intended)[:, self.is_corrected] / np.abs(intended[..., self.is_corrected])
        return float(errors.max())

    def of_component(self, index: int, differences: Points) -> float:
        """Largest of one component, relative to its target."""
        return float(np.max(np.abs(differences[:, index] / self.target[:, index])))

    def worst_moment(self) -> int:
        """Index of the frame at which the armature alone is furthest off, all corrected components together."""
        return int(np.argmax(np.abs(self.relative(self.before) - 1.0)))

    def relative(self, volumes: Points) -> Points:
        """(F,) enclosed volume of all corrected components over their target."""
        inside = np.sign(self.rest[self.is_corrected])
        return volumes[:, self.is_corrected] @ inside / (self.target[:, self.is_corrected] @ inside)

    def moments(self, frames: Sequence[tuple[str, int]]) -> list[Moment]:
        """The points of the plot."""
        if not self.is_corrected.any():
            return []
        before, after = self.relative(self.before), self.relative(self.after)
        return [
            Moment(take, frame, float(without), float(with_turgor))
            for (take, frame), without, with_turgor in zip(frames, before, after, strict=True)
        ]

    def component(self, index: int, status: str, vertex_count: int) -> Component:
        """What became of one component."""
        facts = (status, vertex_count, float(self.rest[index]))
        if not self.is_corrected[index]:
            return Component(*facts, is_corrected=False)
        return Component(
            *facts,
            is_corrected=True,
            max_relative_volume_error_before=self.of_component(index, self.before - self.target),
            max_relative_volume_error_after=self.of_component(index, self.after - self.target),
            float32_floor=self.of_component(index, self.rounding),
            armature_float32_error=self.of_component(index, self.before - self.skinned),
        )
