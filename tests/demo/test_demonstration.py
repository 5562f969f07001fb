"""The zip is installed into a Blender without the engine, and a character is shown from start to end."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
FIXTURE = REPOSITORY / ".fixtures/three_segment_cylinder.blend"
FIELDS = {
    "file",
    "object",
    "vertices",
    "bones",
    "frames",
    "max_relative_volume_error_before",
    "max_relative_volume_error_after",
    "median_ms_per_frame",
    "armature_ms",
    "components",
}


@pytest.fixture(scope="module")
def output(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("demonstration")
    (archive,) = (REPOSITORY / "dist").glob("turgor-*.zip")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, "-m", "demo", FIXTURE, "--extension", archive, "--output", directory]
    subprocess.run(command, cwd=REPOSITORY, env=environment, check=True)
    return directory


@pytest.fixture(scope="module")
def character(output: Path) -> dict[str, Any]:
    (found,) = json.loads((output / "report.json").read_text(encoding="utf-8"))["objects"]
    return found


def test_report_holds_every_field(character: dict[str, Any]):
    assert character.keys() >= FIELDS
    assert character["median_ms_per_frame"].keys() == {"read", "engine", "write", "depsgraph"}
    assert character["file"] == FIXTURE.name


def test_volume_is_lost_without_and_kept_with_turgor(character: dict[str, Any]):
    assert character["max_relative_volume_error_before"] > 1e-3
    assert character["max_relative_volume_error_after"] <= 1e-6


def test_what_is_left_of_a_shell_is_the_precision_of_blender(character: dict[str, Any]):
    for shell in character["components"]:
        floor = shell["float32_floor"] + shell["armature_float32_error"]
        assert 0.0 < shell["float32_floor"] < 1e-6
        assert shell["max_relative_volume_error_after"] <= 4.0 * floor
        assert shell["vertices"] > 0


def test_times_were_taken(character: dict[str, Any]):
    assert character["median_ms_per_frame"]["engine"] > 0.0
    assert character["armature_ms"] > 0.0


def test_page_needs_no_other_file(output: Path):
    page = (output / "index.html").read_text(encoding="utf-8")
    links = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert len(links) == 4
    assert all(link.startswith("data:image/png;base64,") for link in links)
    assert "<svg" in page
