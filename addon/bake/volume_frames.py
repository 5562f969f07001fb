"""Frames of Turgor Volume: poses are sampled once, and the engine computes many of them at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..live import frame as live_frame
from ..live import twins
from ..logic import fingerprint, range_of_motion
from ..messages import message
from ..scene import frame, modifier_inputs, node_group, pose_samples, rest, settings, stack, stack_proof
from .options import BakeError
from .skinned_rest import Posed, posed_of


class Sample(NamedTuple):
    """One frame as Blender evaluated it."""

    posed: Posed
    request: live_frame.Request
    effect: float  # Strength of the modifier


class VolumeFrames:
    """A character with Turgor Volume."""

    def __init__(self, target: bpy.types.Object, *, repair_folds: bool = False) -> None:
        """repair_folds: also where the character does not."""
        character = runtime.character(target.session_uid)
        if character.binding is None:
            raise BakeError(f"{target.name}: Turgor Volume is not bound, see its panel")
        ours, end = stack.volume_modifier(target), stack.body_end(target)
        evaluated = character.binding.evaluated
        for modifier in (end, ours) if evaluated is None else (ours,):
            if not modifier.show_viewport:
                raise BakeError(f"{modifier.name} of {target.name} is off in the viewport: turn it on")
        self._target = target
        self._character, self._bound = character, character.binding
        self.end = end
        self.own = ours
        self.bound_frame = target.turgor.bound_frame
        self.repairs_folds: bool = repair_folds or target.turgor.repair_folds
        self._last_test: tuple[turgor.VolumeSkin, NDArray[np.float32]] | None = None

    @cached_property
    def rest(self) -> rest.RestMesh:
        """Read when it is first asked for: most bakes do without."""
        evaluated = self._bound.evaluated
        with_keys = evaluated is None or not evaluated.has_body
        return rest.read_rest(self._target, self.end, self.bound_frame, with_keys=with_keys)

    @property
    def rest_positions(self) -> NDArray[np.float32]:
        """(N, 3) those of `rest`."""
        return self._bound.body.rest.positions

    @property
    def placement(self) -> NDArray[np.float64]:
        """(4, 4) object_from_armature that was bound."""
        return self._bound.placement

    @property
    def bends(self) -> bool:
        """Whether bendy bones or envelopes of this character hold skin."""
        return self._bound.bones.bends is not None

    @property
    def leaders(self) -> list[bpy.types.ID]:
        """What it follows."""
        spine, armature = self._target.turgor_spine, stack.armature_modifier(self._target)
        rig = None if armature is None else armature.object
        followed = (rig, spine.rig, spine.curve) if self.is_fleshed else (rig,)
        return [*(each for each in followed if each is not None), *twins.of(self._target)]

    @property
    def replaced(self) -> list[bpy.types.Modifier]:
        """What a copy goes without that shows the live positions: ours, and all that poses the body."""
        modifiers = list(self._target.modifiers)
        between = modifiers[modifiers.index(self.end) : modifiers.index(self.own) + 1]
        return [modifier for modifier in between if modifier.type not in stack.STILL_TYPES]

    def check_keys(self, *, is_driven: bool) -> None:
        """Raises BakeError where corrective keys, or those driven by the pose, cannot follow."""
        evaluated, armature = self._bound.evaluated, stack.armature_modifier(self._target)
        if evaluated is None:
            return
        lane = stack_proof.lane_of(self._target)
        is_plain = not lane.moves and armature is not None and not stack_proof.is_blended(self._target, armature)
        if is_driven or not is_plain:
            text = message(
                "Corrective keys cannot follow a stack that is read as Blender evaluates it ({reason}): choose absolute"
                " keys or a point cache, or export USD or Alembic",
                reason=next(iter(lane.reasons), ""),
            )
            raise BakeError(text)

    @property
    def is_fleshed(self) -> bool:
        """Whether Turgor Spine moves bones of this character."""
        return self._bound.fleshed is not None

    @property
    def joint_bones(self) -> list[int]:
        """Bones with a joint, parents first."""
        return self._bound.body.joint_bones

    def posed(self, poses: NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        """(M, N, 3) of poses (M, B, 4, 4), without shape keys, as the character stands to its armature when bound.

        The settings are those of the last sample. Beside it object_from_armature, (4, 4).
        """
        place = self._bound.placement
        engine = self._bound.body.current_engine
        return engine.deform_many(poses, object_from_armature=place, repair_folds=self.repairs_folds), place

    def joint_losses(self, poses: Sequence[Posed]) -> NDArray[np.float64]:
        """(F, J) volume that skinning loses at each joint, cubic units of the object; settings are those of now."""
        shapes = [posed.shape_values for posed in poses]
        found = self._bound.body.current_engine.measure(
            np.stack([posed.matrices for posed in poses]),
            object_from_armature=np.stack([posed.object_from_armature for posed in poses]),
            shape_values=np.stack(shapes) if len(shapes[0]) else None,
        )
        return found.joint_losses

    def samples(self, frames: NDArray[np.float64]) -> Iterator[Sample]:
        """Main thread only; the scene stays as it is."""
        for evaluated in pose_samples.evaluated_apart(self._target, frames):
            yield self._read(evaluated)

    def _read(self, evaluated: bpy.types.Object) -> Sample:
        strength = float(modifier_inputs.read_input(evaluated.modifiers[self.own.name], node_group.STRENGTH))
        request = live_frame.read(evaluated, self._character, self._bound)
        asked = request.options
        if self.repairs_folds:
            asked["repair_folds"] = True
        shape_values = asked.get("shape_values", np.zeros(0, np.float32))
        inputs = frame.FrameInputs(request.pose_matrices, asked["object_from_armature"], shape_values)
        posed = posed_of(evaluated.modifiers[self.end.name].object, self._bound.bones, inputs)
        return Sample(posed, request, strength)

    def fingerprint(self, samples: Sequence[Sample]) -> str:
        """Fingerprint of all that the positions are computed from.

        What is bound, and the engine, count by what becomes of a test pose.
        """
        arrays: list[object] = []
        words: list[object] = [self._bound.content]
        before = None
        for sample in samples:
            request = sample.request
            if before is None or request.engine is not before.engine:
                arrays.append(self._tested(request.engine))
            if before is None or not _is_same(request.saved, before.saved):
                for value in _flat(request.saved):
                    (arrays if isinstance(value, np.ndarray) else words).append(value)
            before = request
            arrays += [request.pose_matrices, *request.options.values()]
            words.append(sample.effect)
        return fingerprint.fingerprint(arrays, *words)

    def _tested(self, engine: turgor.VolumeSkin) -> NDArray[np.float32]:
        """(1, N, 3) with all joints bent; worked out once per engine."""
        if self._last_test is None or self._last_test[0] is not engine:
            bones = self._bound.bones
            poses = range_of_motion.all_bent(bones.parents.tolist(), bones.rest_matrices, self.joint_bones)
            self._last_test = engine, engine.deform_many(poses, object_from_armature=self._bound.placement)
        return self._last_test[1]

    def compute(self, samples: Sequence[Sample], positions: NDArray[np.float32], folds: NDArray[np.int32]) -> None:
        """Fills (F, N, 3) after Turgor Volume, object space, and (F, 3) as `VolumeSkin.deform_many` counts folds.

        Safe on a worker thread.
        """
        done = 0
        for _, group in groupby(samples, key=_kind):
            of_group = list(group)
            rows = slice(done, done + len(of_group))
            _many(of_group, positions[rows], folds[rows])
            done += len(of_group)


def _flat(value: object) -> Iterator[object]:
    if isinstance(value, tuple):
        for part in value:
            yield from _flat(part)
    else:
        yield value


def _is_same(a: settings.BodySettings, b: settings.BodySettings) -> bool:
    return a is b or all(np.array_equal(x, y) for x, y in zip(_flat(a), _flat(b), strict=True))


def _kind(sample: Sample) -> tuple[object, ...]:
    return id(sample.request.engine), *sample.request.options


def _many(samples: Sequence[Sample], positions: NDArray[np.float32], folds: NDArray[np.int32]) -> None:
    options = [sample.request.options for sample in samples]

    def stacked(name: str) -> NDArray[np.float32] | None:
        return np.stack([part[name] for part in options]) if name in options[0] else None

    samples[0].request.engine.deform_many(
        np.stack([sample.request.pose_matrices for sample in samples]),
        object_from_armature=np.stack([part["object_from_armature"] for part in options]),
        shape_values=stacked("shape_values"),
        rest_positions=stacked("rest_positions"),
        target_scale=[part["target_scale"] for part in options],
        added_offsets=stacked("added_offsets"),
        posed_positions=stacked("posed_positions"),
        fleshed=options[0].get("fleshed"),
        effect=[sample.effect for sample in samples],
        repair_folds="repair_folds" in options[0],
        fold_counts=folds,
        positions=positions,
    )
