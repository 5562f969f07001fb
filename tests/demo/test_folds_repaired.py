"""`make demo SCENE=folds` from the zip to the table and the pictures."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
BODIES = ("elbow", "belly")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    directory = tmp_path_factory.mktemp("folds")
    (archive,) = (REPOSITORY / "dist").glob("turgor-*.zip")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, "-m", "demo.folds", "--extension", archive, "--output", directory]
    result = subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, text=True, stdout=subprocess.PIPE)
    return directory, result.stdout


@pytest.fixture(scope="module")
def report(run: tuple[Path, str]) -> dict[str, Any]:
    return json.loads((run[0] / "report.json").read_text(encoding="utf-8"))


def test_new_folds_fall_to_none_on_every_frame(report: dict[str, Any]):
    assert tuple(report["bodies"]) == BODIES
    for name, ways in report["bodies"].items():
        assert ways["before"]["new_folds"] > 20, name
        assert ways["after"]["new_folds"] == 0, name
        assert ways["after"]["frames_with_folds"] == 0, name


def test_the_volume_is_exact_with_and_without(report: dict[str, Any]):
    for name, ways in report["bodies"].items():
        for way in ways.values():
            assert way["volume_error"] < 1e-6, name


def test_every_body_has_a_line_and_its_pictures(run: tuple[Path, str], report: dict[str, Any]):
    directory, printed = run
    for name in report["bodies"]:
        assert any(line.startswith(name) for line in printed.splitlines())
        assert (directory / f"{name}_before.png").is_file()
        assert (directory / f"{name}_after.png").is_file()
