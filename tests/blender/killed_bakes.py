"""Bakes in processes of their own, killed without warning. One bake: python killed_bakes.py FILE FOLDER METHOD.

It tells on its standard output what it is about to do, so that the killer can choose the moment, and which chunks are
done.
"""

from __future__ import annotations

import hashlib
import importlib
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

METHODS = ("ABSOLUTE", "CORRECTIVE", "REDUCED", "DRIVEN", "POINT_CACHE")
FRAMES = np.arange(1.0, 61.0)
CHUNK_FRAMES = 4
CHUNKS = len(FRAMES) // CHUNK_FRAMES
# Parts of the work at which a kill falls into the sampling, the making of the copy, and the two comparisons; above 1
# into the writing of the report, the move of the cache and the end.
SAMPLING, MAKING, COMPARING, LIVE, ENDING = (0.05, 0.4), (0.4, 0.7), (0.7, 0.8), (0.8, 0.99), (1.0, 1.5)
STAGES = {"sampling": SAMPLING, "making": MAKING, "comparing": COMPARING, "live": LIVE, "ending": ENDING}


NOT_FOUND = object()


class Kill(NamedTuple):
    """What came of one kill."""

    stage: str
    done: int  # chunks that were done before it
    kept: int  # chunks that were there after it
    is_late: bool  # the bake had ended already


def options(method: str, folder: Path | None):
    """Of every bake here."""
    chosen = importlib.import_module("addon.bake.options")
    return chosen.Options(
        method,
        FRAMES,
        tolerance=0.02,
        folder=folder,
        chunk_frames=CHUNK_FRAMES,
        name="Baked",
        live_frames=12,
    )


def result(ob) -> str:
    """A digest of all that the copy shows, but for the name of its file."""
    digest = hashlib.sha256()
    keys = ob.data.shape_keys
    for key in () if keys is None else keys.key_blocks:
        points = np.empty(3 * len(key.points), np.float32)
        key.points.foreach_get("co", points)
        digest.update(key.name.encode() + points.tobytes())
    animation = None if keys is None else keys.animation_data
    if animation is not None:
        for driver in animation.drivers:
            digest.update(f"{driver.data_path} {driver.driver.expression}".encode())
        if animation.action is not None:
            bag = animation.action.layers[0].strips[0].channelbags[0]
            for curve in bag.fcurves:
                digest.update(f"{curve.data_path} {[tuple(point.co) for point in curve.keyframe_points]}".encode())
    for cache in ob.modifiers:
        if cache.type == "MESH_CACHE":
            bpy = importlib.import_module("bpy")
            digest.update(Path(bpy.path.abspath(cache.filepath)).read_bytes())
    return digest.hexdigest()


def bake(path: Path, folder: Path, method: str) -> subprocess.Popen[str]:
    """One under way."""
    command = [sys.executable, __file__, str(path), str(folder), method]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def kill(path: Path, folder: Path, method: str, stage: str, rng: random.Random) -> Kill:
    """Kills a bake somewhere in this stage."""
    at, wait = rng.uniform(*STAGES[stage]), rng.uniform(0.0, 0.005)
    with bake(path, folder, method) as process:
        assert process.stdout is not None
        lines = []
        for line in process.stdout:
            lines.append(line.split())
            if lines[-1][:1] == ["at"] and float(lines[-1][1]) >= at:
                break
        time.sleep(wait)
        process.send_signal(signal.SIGKILL)
        lines += [line.split() for line in process.stdout.read().splitlines()]
    done = {line[1] for line in lines if line[:1] == ["chunk"] and len(line) == 2}
    return Kill(stage, len(done), kept(folder), ["ended"] in lines)


def kept(folder: Path) -> int:
    """Chunks that another try can find."""
    journals = {
        line.split(" ")[0]
        for path in folder.glob(".*.chunks/*.journal")
        for line in path.read_text().split("\n")[1:]
        if line.count(" ") == 2
    }
    return len(journals) + len([path for path in folder.glob(".*.chunks/*.npy") if path.name[0].isdigit()])


def finished(path: Path, folder: Path, method: str) -> tuple[str, int]:
    """A bake to its end: digest of its result, and how many chunks it found."""
    with bake(path, folder, method) as process:
        said, _ = process.communicate(timeout=300)
    assert process.returncode == 0, said
    words = said.split()
    return words[words.index("result") + 1], int(words[words.index("resumed") + 1])


def say(*words: object) -> None:
    """Whole lines, at once: a kill must not cut them."""
    sys.stdout.write(" ".join(map(str, words)) + "\n")
    sys.stdout.flush()


def main(path: Path, folder: Path, method: str) -> None:
    """One bake that tells what it does."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    bpy, addon = importlib.import_module("bpy"), importlib.import_module("addon")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    job = importlib.import_module("addon.bake.job")
    stores = [importlib.import_module(f"addon.logic.{name}") for name in ("chunk_store", "point_cache_store")]

    def told(cls, name: str, say_after):
        inner = getattr(cls, name)

        def wrapped(self, *arguments, **named):
            found = inner(self, *arguments, **named)
            say_after(self, arguments, found)
            return found

        setattr(cls, name, wrapped)

    def say_chunk(_store, given, found) -> None:
        if found is not NOT_FOUND:
            say("chunk", given[0])

    for cls in (stores[0].ChunkStore, stores[1].PointCacheStore):
        told(cls, "put", say_chunk)
        told(cls, "find", lambda store, given, out: say_chunk(store, given, NOT_FOUND if out is None else out))
    told(stores[1].PointCacheStore, "finish", lambda *_: say("at", 1.4))
    inner_written, inner_clear = job.whole_file.written, job.Job.clear

    def written(place: Path, **named):
        if place.name.endswith((".json", ".txt")):
            say("at", 1.1 if place.suffix == ".json" else 1.2)
        return inner_written(place, **named)

    def clear(self) -> None:
        say("result", result(self.baked), "resumed", self.report.resumed_chunks)
        say("ended")
        inner_clear(self)

    job.whole_file.written, job.Job.clear = written, clear
    made = job.Job(bpy.data.objects["Tube"], options(method, folder))
    for progress in made.run():
        say("at", progress.part)
    addon.unregister()
    # Blender's module may wait forever for its own threads while Python ends.
    os._exit(0)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
