"""How long a frame takes, with and without Turgor, one mesh at a time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
from time import perf_counter

import bpy

from .evaluated import armature_modifier, evaluated, modifier_after, only_modifiers_before
from .live import frame_times, quiet, volume_modifier
from .report import Timings
from .takes import Take

# Frames timed; the first few warm caches and are not counted.
FRAME_COUNT = 60
WARM_UP_COUNT = 5


@dataclass(frozen=True)
class ArmatureTimes:
    """Blender alone, medians in milliseconds: the Armature modifier, and the whole frame."""

    modifier: float
    frame: float


@contextmanager
def alone(mesh_object: bpy.types.Object, meshes: list[bpy.types.Object]) -> Iterator[None]:
    """Within it, the other meshes are out of the dependency graph."""
    others = [item for item in meshes if item != mesh_object]
    for item in others:
        item.hide_viewport = True
    try:
        yield
    finally:
        for item in others:
            item.hide_viewport = False


def timed_frames(takes: list[Take]) -> Iterator[float]:
    """Goes through frames of the takes, each different from the one before; milliseconds of each."""
    scene = bpy.context.scene
    frames = [(take, frame) for take in takes for frame in take.frames]
    playing: Take | None = None
    for index in range(FRAME_COUNT + WARM_UP_COUNT):
        take, frame = frames[index % len(frames)]
        if take is not playing:
            take.begin()
            playing = take
            scene.frame_set(frame - 1)
        start = perf_counter()
        scene.frame_set(frame)
        milliseconds = 1000.0 * (perf_counter() - start)
        if index >= WARM_UP_COUNT:
            yield milliseconds


def armature_times(mesh_object: bpy.types.Object, takes: list[Take]) -> ArmatureTimes:
    """With Turgor and all modifiers after it off, so that the Armature is the last."""
    name = armature_modifier(mesh_object).name
    modifier, frame = [], []
    with only_modifiers_before(mesh_object, volume_modifier(mesh_object)), quiet():
        for milliseconds in timed_frames(takes):
            frame.append(milliseconds)
            modifier.append(1000.0 * evaluated(mesh_object).modifiers[name].execution_time)
    return ArmatureTimes(median(modifier), median(frame))


def live_times(mesh_object: bpy.types.Object, takes: list[Take]) -> Timings:
    """With Turgor on and all modifiers after it off; what it does not do itself is the dependency graph's."""
    rows = []
    with only_modifiers_before(mesh_object, modifier_after(mesh_object, volume_modifier(mesh_object))):
        for milliseconds in timed_frames(takes):
            own = frame_times(mesh_object)
            rows.append((*own, milliseconds - sum(own)))
    return Timings(*(median(column) for column in zip(*rows, strict=True)))
