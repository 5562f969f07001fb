"""The Open Job Description bundle, run by openjd-cli: two sessions at a time, a killed worker, a resumed job."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import pytest

pytest.importorskip("openjd.cli", reason="openjd-cli is in the environment of Python 3.11")

REPOSITORY = Path(__file__).resolve().parents[2]
TEMPLATE = REPOSITORY / "farm/openjd/turgor_bake/template.yaml"
FRAMES, PARTS = 40, 2
SECONDS = 240.0


class Farm:
    """Sessions of one job."""

    def __init__(self, output: Path, **parameters: object) -> None:
        self.output = output
        self._parameters = {"Output": output, "Parts": PARTS, "Frames": "1-20.5x0.5", "ChunkFrames": 1} | parameters

    def begin(self, step: str, *parts: int) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "openjd", "run", str(TEMPLATE), "--step", step]
        for name, value in self._parameters.items():
            command += ["-p", f"{name}={value}"]
        if parts:
            command += ["--tasks", json.dumps([{"Part": part} for part in parts])]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def run(self, step: str, *parts: int) -> str:
        return ended(self.begin(step, *parts))

    def chunks(self) -> dict[str, int]:
        """When each finished chunk was written."""
        return {path.name: path.stat().st_mtime_ns for path in (self.output / ".Tube.chunks").glob("*.npy")}


def ended(session: subprocess.Popen[str], *, is_fine: bool = True) -> str:
    said, _ = session.communicate(timeout=SECONDS)
    assert (session.returncode == 0) == is_fine, said
    return said


def descendants(pid: int) -> list[int]:
    """All that this process started, the latest last."""
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            found += [int(child), *descendants(int(child))]
    return found


@pytest.fixture
def farm(file, archive, blender, tmp_path):
    return lambda name, **more: Farm(tmp_path / name, File=file, Extension=archive, Blender=blender, **more)


@pytest.mark.skipif(sys.platform != "linux", reason="looks for the worker in /proc")
def test_a_killed_worker_loses_one_chunk_at_most_and_the_job_has_the_same_bytes(farm):
    whole = farm("whole", Method="point-cache")
    sessions = [whole.begin("Bake", part) for part in range(1, PARTS + 1)]
    assert all("openjd_progress" in ended(session) for session in sessions)
    assert len(whole.chunks()) == FRAMES

    broken = farm("broken", Method="point-cache")
    session = broken.begin("Bake", 1)
    until = time.monotonic() + SECONDS
    while not broken.chunks() and time.monotonic() < until:
        time.sleep(0.002)
    os.kill(descendants(session.pid)[-1], signal.SIGKILL)
    ended(session, is_fine=False)
    kept = broken.chunks()
    assert 0 < len(kept) < FRAMES // PARTS

    broken.run("Bake", 1, 2)
    done = broken.chunks()
    assert done.keys() == whole.chunks().keys()
    assert {name: done[name] for name in kept} == kept

    for each in (whole, broken):
        each.run("Merge")
        assert json.loads((each.output / "Tube_point_cache.json").read_text())["resumed_chunks"] == FRAMES
    assert (whole.output / "Tube.pc2").read_bytes() == (broken.output / "Tube.pc2").read_bytes()
    assert (whole.output / "bake.json").read_bytes() == (broken.output / "bake.json").read_bytes()

    broken.run("Verify")
    verified = [json.loads((broken.output / f"verified-{part}.json").read_text()) for part in (1, 2)]
    assert [each["objects"][0]["frames"] for each in verified] == ["1-10.5x0.5", "11-20.5x0.5"]
    assert all(each["is_fine"] for each in verified)


def test_switches_reach_the_bake(farm):
    chosen = farm("chosen", Method="reduced", LocalKeys="on", RepairFolds="on", Frames="1-9x4", ChunkFrames=2)
    chosen.run("Merge")
    assert json.loads((chosen.output / "Tube_reduced.json").read_text())["fold_frame_count"] is not None
    bpy.ops.wm.open_mainfile(filepath=str(chosen.output / "baked.blend"))
    keys = bpy.data.objects["Tube Baked"].data.shape_keys.key_blocks.keys()[1:]
    assert keys
    assert all(name.rpartition(" ")[0] in bpy.data.armatures[0].bones for name in keys)
