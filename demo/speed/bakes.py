"""A bake of many frames, beside stepping Blender through them and reading the mesh of each."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import mkdtemp
from time import perf_counter

import bpy
import numpy as np

from ..evaluated import evaluated
from ..live import extension_module
from .runners import Runner, runners, turn_on_as

FRAME_COUNT = 250
ROW = "{:<28}{:>9}{:>10}{:>10}{:>7}{:>12}{:>7}{:>12}{:>7}"
HEADER = ("character", "vertices", "stepping", "frames", "ratio", "shape keys", "ratio", "point cache", "ratio")
# Only those of some thousand vertices: the others take minutes.
MOST_VERTICES = 10_000


def run(turn_count: int, folder: str) -> None:
    """Prints a row per runner: seconds, the least of so many, and how many times faster than stepping.

    frames: the positions of all frames in memory, as stepping gives them.
    """
    print(f"\nSeconds for {FRAME_COUNT} frames, least of {turn_count}")
    print(ROW.format(*HEADER), flush=True)
    for runner in runners():
        bpy.ops.wm.read_homefile(use_empty=True)
        body = runner.build().body
        if len(body.data.vertices) <= MOST_VERTICES:
            print(ROW.format(*_row(runner, body, turn_count, folder)), flush=True)


def _row(runner: Runner, body: bpy.types.Object, turn_count: int, folder: str) -> list[str]:
    turn_on_as(runner, body)
    # Within what is animated: on every frame all bones move.
    scene = bpy.context.scene
    frames = np.linspace(scene.frame_start, scene.frame_end, FRAME_COUNT)
    works = (
        lambda: _step(body, frames),
        lambda: _frames(body, frames),
        lambda: _bake(body, frames, "ABSOLUTE", folder),
        lambda: _bake(body, frames, "POINT_CACHE", folder),
    )
    seconds = [min(times) for times in zip(*([_timed(work) for work in works] for _ in range(turn_count)), strict=True)]
    stepping, *others = seconds
    cells = [cell for time in others for cell in (f"{time:.3f}", f"{stepping / time:.2f}")]
    name = f"{runner.name}, dual" if runner.is_dual else runner.name
    return [name, f"{len(body.data.vertices):,}", f"{stepping:.3f}", *cells]


def _timed(work: Callable[[], object]) -> float:
    start = perf_counter()
    work()
    return perf_counter() - start


def _step(body: bpy.types.Object, frames: np.ndarray) -> np.ndarray:
    positions = np.empty((len(frames), len(body.data.vertices), 3), np.float32)
    for frame, row in zip(frames, positions, strict=True):
        bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
        evaluated(body).data.attributes["position"].data.foreach_get("vector", row.ravel())
    return positions


def _frames(body: bpy.types.Object, frames: np.ndarray) -> list[np.ndarray]:
    source = extension_module("bake.volume_frames").VolumeFrames(body)
    with extension_module("bake.computing").Computing(source, frames) as computing:
        for _ in computing.sample(range(computing.chunk_count)):
            pass
        return list(computing.chunks)


def _bake(body: bpy.types.Object, frames: np.ndarray, method: str, folder: str) -> None:
    # In a folder of its own: nothing has to be replaced.
    own = Path(mkdtemp(dir=folder)) if method == "POINT_CACHE" else None
    options = extension_module("bake.options").Options(method, frames, folder=own, verify=False, name="Baked")
    job = extension_module("bake.job").Job(body, options)
    for _ in job.run():
        pass
    extension_module("scene.baked_copy").discard(job.baked)
