"""Plays every character three ways, prints the table, writes pictures and report."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import bpy
import turgor

from . import pictures
from .subjects import SUBJECTS
from .trial import COARSE, WAYS, Result, play


def show(output: Path, only: Sequence[str] | None = None) -> None:
    """Writes report.json and the pictures. only: names of characters; None: all."""
    output.mkdir(parents=True, exist_ok=True)
    report: dict = {"blender": bpy.app.version_string, "turgor": turgor.__version__, "characters": {}}
    print(
        f"{'':18}{'vertices':>9}{'faces':>8}{'corners':>9}{'watertight':>12}{'rest moved':>12}{'rest volume':>13}"
        f"{'volume error':>14}{'step':>7}"
    )
    for subject in SUBJECTS:
        if only is not None and subject.name not in only:
            continue
        found = {way: play(subject, way) for way in WAYS}
        coarse = found[COARSE][0].step
        results = {way: replace(result, step=result.step / coarse) for way, (result, _) in found.items()}
        for way, result in results.items():
            print(_line(f"{subject.name}, {way}", result), flush=True)
        pictures.take(subject, [posed for _, posed in found.values()], output)
        report["characters"][subject.name] = {way: asdict(result) for way, result in results.items()}
    (output / "report.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    print(
        "\ncorners: most of any face; rest moved: of the coarse mesh's vertices, over its size; rest volume: change;"
        "\nvolume error: over all frames, against the mesh's own rest; step: the farthest that a vertex goes in a"
        f"\nframe, over that of the coarse mesh. Look at the pictures in {output}"
    )


def _line(name: str, result: Result) -> str:
    return (
        f"{name:18}{result.vertices:>9,}{result.faces:>8,}{result.most_corners:>9}"
        f"{'yes' if result.is_watertight else 'NO':>12}{result.rest_moved:>12.1e}{result.rest_volume_change:>13.1e}"
        f"{result.volume_error:>14.1e}{result.step:>7.3f}"
    )
