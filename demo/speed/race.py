"""Frames without and with Turgor in turns, so that other work on the machine meets both; the least of many counts."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from time import perf_counter
from typing import NamedTuple

import bpy

from blend_fixtures.character import Character

from ..evaluated import evaluated, modifier_after
from ..live import frame_times, quiet, volume_modifier
from .runners import LARGE_TUBE, Runner, runners, turn_on_as

FRAME_COUNT = 12
# From frame to frame all bones move well.
STEP = 7
ROW = "{:<28}{:>9}{:>7}  {:<7}{:>9}{:>9}{:>7}{:>9}{:>9}{:>7}"
HEADER = ("character", "vertices", "bones", "blend", "Armature", "engine", "ratio", "frame", "live", "ratio")


class Times(NamedTuple):
    """Milliseconds: the Armature modifier, the engine, the whole frame without and with Turgor."""

    armature: float
    engine: float
    frame: float
    live_frame: float

    def cells(self) -> list[str]:
        """Each pair and its ratio."""
        pairs = (self.armature, self.engine), (self.frame, self.live_frame)
        return [cell for peer, own in pairs for cell in (f"{peer:.3f}", f"{own:.3f}", f"{own / peer:.2f}")]


def run(turn_count: int) -> None:
    """Prints a row per runner."""
    print(f"Milliseconds, least of {turn_count * FRAME_COUNT} frames, {os.cpu_count()} processors")
    print(ROW.format(*HEADER), flush=True)
    engine_by_bones: dict[int, float] = {}
    for runner in runners():
        bpy.ops.wm.read_homefile(use_empty=True)
        character = runner.build()
        vertex_count, bone_count = len(character.body.data.vertices), len(character.armature.data.bones)
        times = timed(runner, character, turn_count)
        blend = "dual" if runner.is_dual else "linear"
        print(ROW.format(runner.name, f"{vertex_count:,}", bone_count, blend, *times.cells()), flush=True)
        if runner.name == LARGE_TUBE and not runner.is_dual:
            engine_by_bones[bone_count] = times.engine
    few, many = sorted(engine_by_bones)
    print(f"Engine, {many} bones over {few}: {engine_by_bones[many] / engine_by_bones[few]:.2f}")


def timed(runner: Runner, character: Character, turn_count: int) -> Times:
    """The least of each, with Turgor right after the Armature as the last modifier."""
    body = character.body
    armature = body.modifiers["Armature"]
    while (later := modifier_after(body, armature)) is not None:
        body.modifiers.remove(later)
    turn_on_as(runner, body)
    ours = volume_modifier(body)
    armature_times, engine_times, frames, live_frames = [], [], [], []
    for _ in range(turn_count):
        ours.show_viewport = False
        with quiet():
            for time in frame_durations():
                frames.append(time)
                armature_times.append(1000.0 * evaluated(body).modifiers[armature.name].execution_time)
        ours.show_viewport = True
        for time in frame_durations():
            live_frames.append(time)
            engine_times.append(frame_times(body)[1])
    return Times(min(armature_times), min(engine_times), min(frames), min(live_frames))


def frame_durations(seconds: Callable[[], float] = perf_counter) -> Iterator[float]:
    """Milliseconds of frames all over the animation; the first, after a change of modifiers, is not counted."""
    scene = bpy.context.scene
    frame_count = scene.frame_end - scene.frame_start
    for index in range(FRAME_COUNT + 1):
        start = seconds()
        scene.frame_set(scene.frame_start + index * STEP % frame_count)
        if index > 0:
            yield 1000.0 * (seconds() - start)
