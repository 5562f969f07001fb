"""python -m demo.weights.memory RINGS SIDES BONES: what weights of a limb take, the engine alone in its process."""

from __future__ import annotations

import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import turgor
from numpy.typing import NDArray

from .shapes import Points

REPOSITORY = Path(__file__).resolve().parents[2]
LENGTH, RADIUS = 8.0, 0.5


def measured(rings: int, sides: int, bones: int) -> dict[str, int]:
    """Peaks of a process of its own, in bytes: with the mesh, before there are weights, and after."""
    engine = Path(str(turgor.__file__)).parents[1]
    environment = os.environ | {"PYTHONPATH": str(engine)}
    command = [sys.executable, "-m", "demo.weights.memory", str(rings), str(sides), str(bones)]
    run = subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, text=True, stdout=subprocess.PIPE)
    return json.loads(run.stdout)


def tube(rings: int, sides: int) -> tuple[Points, NDArray[np.int32], NDArray[np.int32]]:
    """Open at both ends, as the engine takes it. Made of arrays: lists would take more than the engine."""
    x, angle = np.meshgrid(
        np.linspace(0.0, LENGTH, rings), np.arange(sides) * 2 * np.pi / sides, indexing="ij", copy=False
    )
    points = np.stack([x, RADIUS * np.cos(angle), RADIUS * np.sin(angle)], axis=-1).reshape(-1, 3)
    here = np.arange((rings - 1) * sides, dtype=np.int32)
    after = here // sides * sides + (here + 1) % sides
    corners = np.stack([here, after, after + sides, here + sides], axis=1).ravel().astype(np.int32)
    return points, np.arange(0, len(corners) + 1, 4, dtype=np.int32), corners


def peak() -> int:
    """The most that this process ever had in memory, bytes."""
    status = Path("/proc/self/status")
    if status.exists():
        # What the process had from its parent is no part of it, as it is of `ru_maxrss`.
        (kilobytes,) = re.findall(r"VmHWM:\s*(\d+) kB", status.read_text())
        return 1024 * int(kilobytes)
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else 1024 * most


def main() -> None:
    """Prints both peaks as JSON."""
    rings, sides, bones = (int(argument) for argument in sys.argv[1:])
    mesh = tube(rings, sides)
    joints = np.linspace([0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0], bones + 1)
    before = peak()
    turgor.automatic_weights([mesh], joints[:-1], joints[1:])
    print(json.dumps({"before": before, "after": peak()}))


if __name__ == "__main__":
    main()
