"""`make demo SCENE=refine` from the zip to the table and the pictures."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
NAME = "arm"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    directory = tmp_path_factory.mktemp("refine")
    (archive,) = (REPOSITORY / "dist").glob("turgor-*.zip")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, "-m", "demo.refine", "--extension", archive, "--output", directory, "--only", NAME]
    result = subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, text=True, stdout=subprocess.PIPE)
    return directory, result.stdout


@pytest.fixture
def ways(run: tuple[Path, str]) -> dict[str, Any]:
    return json.loads((run[0] / "report.json").read_text(encoding="utf-8"))["characters"][NAME]


def test_refined_meshes_are_closed_and_keep_their_volume(ways: dict[str, Any]):
    for way, result in ways.items():
        assert result["is_watertight"], way
        assert result["volume_error"] < 1e-6, way


def test_there_are_more_vertices_and_nothing_jumps(ways: dict[str, Any]):
    for way in ("linear", "smooth"):
        assert ways[way]["vertices"] > 4 * ways["coarse"]["vertices"]
        assert ways[way]["step"] < 1.1


def test_linear_keeps_the_rest_shape(ways: dict[str, Any]):
    assert ways["linear"]["rest_moved"] == 0.0
    assert abs(ways["linear"]["rest_volume_change"]) < 1e-6


def test_smooth_keeps_the_vertices_that_are_there(ways: dict[str, Any]):
    assert ways["smooth"]["rest_moved"] == 0.0
    assert 0.0 < ways["smooth"]["rest_volume_change"] < 0.05


def test_there_is_a_line_and_two_pictures(run: tuple[Path, str], ways: dict[str, Any]):
    directory, printed = run
    assert all(f"{NAME}, {way}" in printed for way in ways)
    assert len(list(directory.glob("*.png"))) == 2
