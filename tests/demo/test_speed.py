"""`make speed` from the zip to the table."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
TIMES = re.compile(
    r"^(.{28}) +([0-9,]+) +([0-9]+)  (linear|dual) +" + r" +".join([r"([0-9.]+)"] * 6) + "$", re.MULTILINE
)


STACKS = re.compile(r"^(.{28}) +([0-9,]+) +" + r" +".join([r"([0-9.]+)"] * 6) + "$", re.MULTILINE)


@pytest.fixture(scope="module")
def printed() -> str:
    (archive,) = (REPOSITORY / "dist").glob("turgor-*.zip")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, "-m", "demo.speed", "--extension", archive, "--turns", "1"]
    return subprocess.run(
        command, cwd=REPOSITORY, env=environment, check=True, text=True, stdout=subprocess.PIPE
    ).stdout


def test_times_characters_of_both_sizes_by_both_blends(printed: str):
    rows = TIMES.findall(printed)
    sizes = [(name.strip(), count, bones, blend) for name, count, bones, blend, *_ in rows]
    assert len(sizes) == len(set(sizes)) == 8
    for count in ("6,646", "100,002"):
        assert {blend for _, found, bones, blend in sizes if (found, bones) == (count, "17")} == {"linear", "dual"}
    assert any((count, bones) == ("100,002", "200") for _, count, bones, _ in sizes)


def test_ratios_are_those_of_the_times(printed: str):
    for *_, armature, engine, engine_ratio, frame, live, live_ratio in TIMES.findall(printed):
        assert float(engine_ratio) == pytest.approx(float(engine) / float(armature), rel=0.02)
        assert float(live_ratio) == pytest.approx(float(live) / float(frame), rel=0.02)
        assert 0.0 < float(engine) < float(live)


def test_times_stacks_that_blender_evaluates(printed: str):
    rows = STACKS.findall(printed[printed.index("Stacks that Blender evaluates") :])
    assert len(rows) == len({(name, count) for name, count, *_ in rows}) == 6
    for *_, alone, uncorrected, ratio, frame, frame_ratio, first in rows:
        assert float(ratio) == pytest.approx(float(uncorrected) / float(alone), rel=0.02)
        assert float(frame_ratio) == pytest.approx(float(frame) / float(alone), rel=0.02)
        assert float(first) > 0.0
