"""Frames of Turgor Spine alone: each is fleshed as it is sampled, for the spine is made from what Blender evaluated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import runtime
from ..live import spine_frame
from ..logic import fingerprint
from ..scene import drivers, frame, pose_samples, rest, spine_stack
from .options import BakeError
from .skinned_rest import Posed, posed_of, skin_of


class Sample(NamedTuple):
    """One frame."""

    posed: Posed | None  # None where no Armature skins the body
    positions: NDArray[np.float32]  # (N, 3) after Turgor Spine


class SpineFrames:
    """A body with Turgor Spine, its own bones' Armature before it or none."""

    repairs_folds = False

    def __init__(self, target: bpy.types.Object) -> None:
        state = runtime.spine(target.session_uid)
        if state.binding is None:
            raise BakeError(f"{target.name}: Turgor Spine is not bound, see its panel")
        self.end = spine_stack.rest_end(target)
        self.own = spine_stack.spine_modifier(target)
        for modifier in (self.end, self.own):
            if not modifier.show_viewport:
                raise BakeError(f"{modifier.name} of {target.name} is off in the viewport: turn it on")
        self._target = target
        self._bound = state.binding
        self._limb = spine_stack.limb_modifier(target)
        self.bound_frame = target.turgor_spine.bound_frame
        self.rest = rest.read_rest(target, self.end, self.bound_frame)
        self._skin = (
            None
            if self._limb is None
            else skin_of(target, self._limb, self.rest, self._bound.placement, self.bound_frame)
        )

    @property
    def rest_positions(self) -> NDArray[np.float32]:
        """(N, 3) those of `rest`."""
        return self.rest.positions

    @property
    def placement(self) -> NDArray[np.float64]:
        """(4, 4) object_from_armature that was bound."""
        return self._bound.placement

    @property
    def leaders(self) -> list[bpy.types.ID]:
        """What it follows."""
        saved = self._target.turgor_spine
        return [each for each in (saved.rig, saved.curve) if each is not None]

    @property
    def replaced(self) -> list[bpy.types.Modifier]:
        """What a copy goes without that shows the live positions."""
        return [self.own] if self.end.type != "ARMATURE" else [self.end, self.own]

    def samples(self, frames: NDArray[np.float64]) -> Iterator[Sample]:
        """Main thread only; the scene stays as it is."""
        target, saved = self._target, self._target.turgor_spine
        rig = saved.rig if saved.source == "BONES" else None
        sources = [
            drivers.Source("TRANSFORMS", "OBJECT", target, ""),
            drivers.Source("SINGLE_PROP", "OBJECT", target, "turgor_spine.slide"),
            *drivers.shape_key_sources(target.data.shape_keys),
        ]
        if rig is not None:
            sources.append(drivers.Source("TRANSFORMS", "OBJECT", rig, ""))
        else:
            sources += drivers.curve_sources(saved.curve)
        for evaluated in pose_samples.evaluated_after(target, frames, rig, sources):
            yield self._read(evaluated)

    def _read(self, evaluated: bpy.types.Object) -> Sample:
        shape = spine_frame.read_shape(evaluated, self._bound)
        posed, positions = None, shape.positions
        if self._skin is not None:
            rig = evaluated.turgor_spine.rig
            posed = posed_of(rig, self._skin.bones, frame.read_inputs(evaluated, rig, self._skin.bones))
            positions = self._skin.maps(posed).moved(positions)
        return Sample(posed, (positions + shape.strength * shape.offsets.astype(np.float64)).astype(np.float32))

    def fingerprint(self, samples: Sequence[Sample]) -> str:
        """Fingerprint of the sampled positions themselves, and of what was bound."""
        return fingerprint.fingerprint([sample.positions for sample in samples], self._bound.content)

    def compute(
        self, samples: Sequence[Sample], positions: NDArray[np.float32], _folds: NDArray[np.int32] | None = None
    ) -> None:
        """Fills (F, N, 3) after Turgor Spine, object space."""
        for sample, row in zip(samples, positions, strict=True):
            row[:] = sample.positions
