"""Turgor on one mesh: turned on as an artist does, and asked what it did in the current frame.

Figures come from the enabled extension itself: the module that the zip installed.
"""

from __future__ import annotations

import importlib
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
import turgor

from .enclosed_volume import Points
from .evaluated import evaluated
from .extension import MODULE


def extension_module(name: str) -> Any:
    """A module of the installed extension."""
    return importlib.import_module(f"{MODULE}.{name}")


def character(mesh_object: bpy.types.Object) -> Any:
    """What the extension knows of a mesh."""
    return extension_module("runtime").character(mesh_object.session_uid)


def quiet() -> AbstractContextManager[None]:
    """Within it the extension does not look at frames: they take as long as without it."""
    return extension_module("runtime").quiet()


def turn_on(mesh_object: bpy.types.Object) -> str | None:
    """By the extension's operator; returns why it could not be done."""
    for item in bpy.context.view_layer.objects:
        item.select_set(item == mesh_object)
    bpy.context.view_layer.objects.active = mesh_object
    try:
        bpy.ops.object.turgor_volume_add()
    except RuntimeError as error:
        return str(error).removeprefix("Error: ").strip()
    return character(mesh_object).problem


def must_turn_on(mesh_object: bpy.types.Object, name: str) -> None:
    """The same; ends the program where it cannot be done."""
    problem = turn_on(mesh_object)
    if problem is not None:
        raise SystemExit(f"{name}: {problem}")


def volume_modifier(mesh_object: bpy.types.Object) -> bpy.types.Modifier | None:
    """The modifier the extension added."""
    return extension_module("scene.stack").volume_modifier(mesh_object)


@dataclass(frozen=True)
class LiveFrame:
    """What the extension's engine says of the current frame."""

    engine: turgor.VolumeSkin
    report: turgor.Report
    skinned: Points  # (N, 3) double precision
    positions: Points  # (N, 3) corrected, double precision

    @property
    def target_volumes(self) -> Points:
        """(K,) per component of the engine's mesh."""
        return self.report.target_volumes

    def worst_joint(self) -> tuple[int, float]:
        """Bone of the joint that lost most, and the joint's length in armature space."""
        worst = int(np.argmax(np.abs(self.report.joint_losses)))
        return int(self.engine.joint_bones[worst]), float(self.engine.joint_lengths[worst])


class WatchedEngine:
    """Stands in for an engine: notes the whole frame and writes nothing."""

    def __init__(self, engine: turgor.VolumeSkin, found: list[LiveFrame]) -> None:
        self.engine, self.found = engine, found

    def deform_into_address(self, _address: int, _count: int, pose_matrices: Any, **options: Any) -> turgor.Report:
        """As the engine's."""
        frame = self.engine.deform(pose_matrices, **options)
        self.found.append(LiveFrame(self.engine, frame.report, frame.skinned, frame.positions))
        return frame.report


class WatchedBody:
    """Stands in for the extension's bound body, whose engine is watched."""

    def __init__(self, body: Any, found: list[LiveFrame]) -> None:
        self.body, self.found = body, found

    def __getattr__(self, name: str) -> Any:
        return getattr(self.body, name)

    def with_settings(self, *settings: Any) -> tuple[WatchedEngine, Any]:
        """As the body's."""
        engine, strengths = self.body.with_settings(*settings)
        return WatchedEngine(engine, self.found), strengths


def live_frame(mesh_object: bpy.types.Object) -> LiveFrame:
    """Runs the extension's own frame once more, without a carrier to write to."""
    found: list[LiveFrame] = []
    target = evaluated(mesh_object)
    state = character(mesh_object)
    bound = state.binding
    state.binding = bound._replace(body=WatchedBody(bound.body, found))
    try:
        extension_module("live.frame").correct(target, 0, len(target.data.vertices))
    finally:
        state.binding = bound
    if not found:
        raise SystemExit(f"{mesh_object.name}: {state.problem}")
    return found[0]


def bone_name(mesh_object: bpy.types.Object, bone: int) -> str:
    """Name of a bone by the engine's index."""
    bones = character(mesh_object).binding.bones
    return bones.names[bones.bone_of(bone)]


def frame_times(mesh_object: bpy.types.Object) -> tuple[float, float, float]:
    """Milliseconds of reading, engine and writing in the frame just evaluated."""
    timing = character(mesh_object).timing
    return timing.read, timing.engine, timing.write
