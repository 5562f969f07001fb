"""One mesh through the whole demonstration: played without and with Turgor, timed, summed up."""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from .characters import armature_of
from .findings import Volumes
from .live import LiveFrame, live_frame
from .playing import Track
from .report import ObjectReport, Timings
from .timing import ArmatureTimes


@dataclass
class Subject:
    """before, after: (F, K) volumes of the measured shells; targets: (F, C) of the engine's components.

    roundings: (F, K) what rounding the engine's own positions to single precision adds to the shells' volumes.
    skinned: (F, K) the shells' volumes by the engine's skinning, double precision.
    """

    track: Track
    before: NDArray[np.float64]
    problem: str | None = None
    targets: list[NDArray[np.float64]] = field(default_factory=list)
    roundings: list[NDArray[np.float64]] = field(default_factory=list)
    skinned: list[NDArray[np.float64]] = field(default_factory=list)
    after: NDArray[np.float64] | None = None
    bound: LiveFrame | None = None
    armature_times: ArmatureTimes | None = None
    live_times: Timings | None = None

    @property
    def mesh_object(self) -> bpy.types.Object:
        """The mesh itself."""
        return self.track.mesh_object

    def note_frame(self) -> None:
        """Asks the extension for the current frame: the target volumes, and what Blender's precision makes of them."""
        if self.problem is None:
            self.bound = live_frame(self.mesh_object)
            self.targets.append(self.bound.target_volumes)
            volumes, exact = self.track.shells.volumes, self.bound.positions
            self.roundings.append(volumes(exact.astype(np.float32).astype(np.float64)) - volumes(exact))
            self.skinned.append(volumes(self.bound.skinned))

    def volumes(self) -> Volumes | None:
        """Measured volumes by the engine's components; None where Turgor could not be turned on."""
        if self.bound is None or self.after is None:
            return None
        mesh = self.bound.engine.mesh
        shells = self.track.shells
        shell_numbers, first_vertices = np.unique(shells.vertex_shells, return_index=True)
        first_vertices = first_vertices[shell_numbers >= 0]
        component_of_shell = mesh.vertex_components[first_vertices]
        belongs = component_of_shell[:, None] == np.arange(len(mesh.components))
        return Volumes(
            before=self.before @ belongs,
            after=self.after @ belongs,
            skinned=np.array(self.skinned) @ belongs,
            rounding=np.array(self.roundings) @ belongs,
            target=np.array(self.targets),
            rest=self.track.rest_volumes @ belongs,
            is_corrected=np.array([component.is_sound for component in mesh.components], dtype=np.bool_),
        )

    def report(self, file: str, frames: list[tuple[str, int]]) -> ObjectReport:
        """The mesh's part of report.json."""
        armature = armature_of(self.mesh_object)
        groups = set(self.mesh_object.vertex_groups.keys())
        facts = {
            "file": file,
            "object": self.mesh_object.name,
            "vertices": len(self.track.shells.vertex_shells),
            "bones": sum(bone.use_deform and bone.name in groups for bone in armature.data.bones),
            "frames": len(frames),
        }
        volumes = self.volumes()
        if volumes is None or self.bound is None or self.armature_times is None or self.live_times is None:
            return ObjectReport(**facts, problem=self.problem)
        parts = self.bound.engine.mesh.components
        is_corrected = bool(volumes.is_corrected.any())
        take, frame = frames[volumes.worst_moment()] if is_corrected else (None, None)
        return ObjectReport(
            **facts,
            max_relative_volume_error_before=volumes.largest_error(volumes.before, volumes.target),
            max_relative_volume_error_after=volumes.largest_error(volumes.after, volumes.target),
            max_relative_rest_volume_error_before=volumes.largest_error(volumes.before, volumes.rest),
            max_relative_rest_volume_error_after=volumes.largest_error(volumes.after, volumes.rest),
            median_ms_per_frame=self.live_times,
            armature_ms=self.armature_times.modifier,
            armature_only_frame_ms=self.armature_times.frame,
            engine_to_armature_ratio=self.live_times.engine / self.armature_times.modifier,
            live_to_armature_only_frame_ratio=self.live_times.frame / self.armature_times.frame,
            worst_take=take,
            worst_frame=frame,
            problem=None if is_corrected else f"left as skinned: {', '.join(sorted({part.status for part in parts}))}",
            components=[volumes.component(index, part.status, part.vertex_count) for index, part in enumerate(parts)],
            moments=volumes.moments(frames),
        )
