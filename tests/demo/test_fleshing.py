"""`make demo SCENE=fleshing` from the zip to the page, and the bounds that its figures keep."""

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
CURVE = "Curve modifier"
KINDS = ("radial", "normal", "binormal")
EXPERIMENTS = {"dolphin", "snake", "arcs", "cubes", "extrusions", "two_bends", "subdivisions", "frames", "speed"}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    directory = tmp_path_factory.mktemp("fleshing")
    (archive,) = (REPOSITORY / "dist").glob("turgor-*.zip")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, "-m", "demo.fleshing", "--extension", archive, "--output", directory]
    result = subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, text=True, stdout=subprocess.PIPE)
    return directory, result.stdout.replace("\N{NO-BREAK SPACE}", " ")


@pytest.fixture(scope="module")
def report(run: tuple[Path, str]) -> dict[str, Any]:
    return json.loads((run[0] / "report.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def found(report: dict[str, Any]) -> dict[str, Any]:
    return report["experiments"]


def test_every_experiment_ran(found: dict[str, Any]):
    assert found.keys() == EXPERIMENTS


def test_every_claim_about_shape_holds(report: dict[str, Any]):
    shapes = [claim for claim in report["claims"] if not re.match(r"frame, |bind|time ", claim["what"])]
    assert len(shapes) >= 20
    assert not [claim for claim in shapes if not claim["holds"]]


@pytest.mark.parametrize("kind", KINDS)
def test_bounds_of_the_issue(found: dict[str, Any], kind: str):
    cubes = found["cubes"]
    assert cubes["mean"][kind][cubes["sizes"].index(0.1)] <= 1e-3
    assert cubes["order"][kind] == pytest.approx(2.0, abs=0.1)
    assert cubes["determinant"][kind] <= 1e-8
    assert found["extrusions"]["determinant"][kind] <= 1e-8
    assert found["extrusions"]["round_trip"][kind] <= 1e-12
    subdivisions = found["subdivisions"]
    assert subdivisions["vertices"] == [32, 122, 482, 1922]
    assert abs(subdivisions["total"][kind][-1]) <= 2e-4
    assert abs(found["two_bends"]["total"][kind][-1]) <= 1e-4
    assert max(map(abs, found["dolphin"]["total"][kind])) <= 1e-3


def test_dolphin_is_exact_everywhere_and_to_rounding_when_corrected(found: dict[str, Any]):
    assert found["dolphin"]["points_not_exact"] == 0
    assert found["dolphin"]["corrected"] <= 1e-6


def test_curve_modifier_changes_flesh(found: dict[str, Any]):
    cubes = found["cubes"]
    assert cubes["mean"][CURVE][cubes["sizes"].index(0.1)] == pytest.approx(0.17, abs=0.01)
    # Pappus: a tube of radius r beside a spine that turns by a half over its length 14 r.
    assert found["arcs"]["worst"][CURVE] == pytest.approx(3.14159 / 14.0, rel=1e-2)


def test_frames_do_not_turn(found: dict[str, Any]):
    for turns in found["frames"].values():
        assert turns["Frenet"] > 90.0
        assert turns["rotation-minimising"] < 0.01


def test_times_are_told_against_the_curve_modifier(found: dict[str, Any]):
    """Told, not judged: machines are shared. The page says whether they are within their bounds."""
    speed = found["speed"]
    assert speed["frame_ratio"].keys() == set(KINDS)
    assert all(ratio > 0.0 for ratio in [*speed["frame_ratio"].values(), speed["bind_ratio"]])


def test_page_needs_no_other_file(run: tuple[Path, str]):
    page = (run[0] / "index.html").read_text(encoding="utf-8")
    links = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert len(links) >= 15
    assert all(link.startswith("data:image/png;base64,") for link in links)
    assert page.count("<svg") == 4
    assert "FAILS" not in re.sub(r"<tr><td>(frame, |bind|time ).*?</tr>", "", page)


def test_every_number_of_the_page_is_printed(run: tuple[Path, str]):
    directory, printed = run
    page = (directory / "index.html").read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    words = re.findall(r"<(?:p|td|strong|figcaption)[^>]*>(.*?)</(?:p|td|strong|figcaption)>", page, re.DOTALL)
    words = [re.sub(r"<[^>]*>", "", text) for text in words]
    figures = {figure for text in words for figure in re.findall(r"[+−]?\d[\d.,e-]*\d*(?: (?:%|ms)|°)", text)}
    assert len(figures) > 80
    assert not {figure for figure in figures if figure not in printed}
