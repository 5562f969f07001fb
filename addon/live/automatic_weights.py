"""Automatic weights of some meshes on one armature: read, found by the engine in any thread, written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
import turgor

from ..logic import automatic_weights as merging
from ..logic import weights as bone_weights
from ..messages import message
from ..scene import weight_groups


@dataclass(frozen=True)
class Options:
    """What the artist chooses, for `turgor.automatic_weights`; 0 stands for automatic and for any number."""

    resolution: int = 0
    falloff: float = 12.0
    smoothing: float = 0.83
    max_influences: int = 4
    use_symmetry: bool = False
    keep_locked: bool = True


class WeightError(ValueError):
    """Why there are no weights, and what to do."""


class Job:
    """One run. `run` touches nothing of Blender."""

    def __init__(
        self,
        rig: bpy.types.Object,
        objects: Sequence[bpy.types.Object],
        options: Options,
        chosen: set[str] | None = None,
    ) -> None:
        """chosen: names of bones that get weights; None: all. Raises WeightError."""
        self.rig, self.objects, self._options = rig, _with_own_meshes(objects), options
        self.names = weight_groups.deform_bone_names(rig)
        if not self.names:
            raise WeightError(message("{armature} has no deform bone: turn Deform on for its bones", armature=rig.name))
        self._targets = [weight_groups.read_target(ob) for ob in self.objects]
        self._ends = weight_groups.read_bone_ends(rig, self.names)
        self._parents = weight_groups.read_parents(rig, self.names)
        self._stiffness = weight_groups.read_stiffness(rig, self.names)
        self._plane = weight_groups.mirror_plane(rig)
        self._partners = weight_groups.mirrored_bones(self.names)
        locked = {name for target in self._targets for name in target.locked_names} if options.keep_locked else set()
        self._is_locked = np.array([name in locked for name in self.names])
        self._chosen = np.array([chosen is None or name in chosen for name in self.names])
        if not (self._chosen & ~self._is_locked).any():
            raise WeightError(message("All chosen bones are locked: unlock a vertex group, or turn Keep Locked off"))
        self._existing = [self._existing_of(target) for target in self._targets]
        self._rows: list[bone_weights.BoneWeights] = []
        self.fallback_count = 0
        self.vertex_count = sum(int(target.is_selected.sum()) for target in self._targets)

    def run(self, progress: Callable[[float], bool | None] | None = None) -> None:
        """Raises turgor.CancelledError, turgor.TurgorError."""
        options = self._options
        # Vertices of the meshes first; bodies that modifiers made are there for their inside only.
        bodies = [target.body for target in self._targets if target.body is not None]
        meshes = [tuple(surface) for surface in [*(target.surface for target in self._targets), *bodies]]
        is_solid = [target.body is None for target in self._targets] + [True] * len(bodies)
        added = sum(len(body.positions) for body in bodies)
        none = bone_weights.BoneWeights(np.zeros(added + 1, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32))
        found = turgor.automatic_weights(
            meshes,
            *self._ends,
            bone_parents=self._parents,
            resolution=max(options.resolution, 8) if options.resolution else None,
            falloff=options.falloff,
            smoothing=options.smoothing,
            max_influences=options.max_influences or None,
            stiffness=self._stiffness,
            is_solid=is_solid,
            is_locked=self._is_locked,
            locked_weights=merging.joined([*self._existing, none]),
            symmetry_plane=self._plane if options.use_symmetry else None,
            mirrored_bones=self._partners if options.use_symmetry else None,
            progress=progress,
        )
        rows = bone_weights.BoneWeights(found.offsets, found.bones, found.weights)
        starts = found.vertex_starts
        body_rows = (
            merging.part(rows, start, stop)
            for start, stop in zip(starts[len(self._targets) :], starts[len(self._targets) + 1 :], strict=False)
        )
        for number, (target, existing) in enumerate(zip(self._targets, self._existing, strict=True)):
            choice = merging.Choice(self._chosen, self._is_locked, target.is_selected)
            part = merging.part(rows, starts[number], starts[number + 1])
            if target.body is not None:
                part = merging.as_on_body(part, next(body_rows), target.body_vertices, self._is_locked)
            self._rows.append(merging.merged(part, existing, choice))
            self.fallback_count += int(
                (found.is_fallback[starts[number] : starts[number + 1]] & target.is_selected).sum()
            )

    def write(self) -> None:
        """The vertex groups of all meshes."""
        for ob, rows in zip(self.objects, self._rows, strict=True):
            weight_groups.write_weights(ob, self.names, rows)

    def _existing_of(self, target: weight_groups.Target) -> bone_weights.BoneWeights:
        index = {name: number for number, name in enumerate(self.names)}
        return bone_weights.bone_weights(
            target.weight_offsets, target.weight_groups, target.weights, target.group_names, index
        )


def _with_own_meshes(objects: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """One object per mesh: vertex groups belong to meshes. Raises WeightError for linked ones."""
    found: dict[bpy.types.Mesh, bpy.types.Object] = {}
    for ob in sorted(objects, key=lambda ob: ob.name):
        if ob.data.library is not None:
            raise WeightError(message("The mesh of {object} is linked: make it local first", object=ob.name))
        found.setdefault(ob.data, ob)
    return list(found.values())
