"""Runs all experiments, prints what they found, writes pictures, page and report."""

from __future__ import annotations

import os
from pathlib import Path

import bpy
import turgor

from . import arcs, cube_sizes, dolphin_slide, extrusions, frames, snake_slither, speed, subdivisions, two_bends
from .gallery import Gallery
from .page import page
from .report import Report

EXPERIMENTS = (dolphin_slide, snake_slither, arcs, cube_sizes, extrusions, two_bends, subdivisions, frames, speed)


def show(output: Path) -> None:
    """Writes report.json, index.html and the pictures."""
    output.mkdir(parents=True, exist_ok=True)
    # Not the factory settings: they would turn the extension off.
    bpy.ops.wm.read_homefile(use_empty=True)
    gallery = Gallery(output)
    found = []
    for experiment in EXPERIMENTS:
        found.append(experiment.run(gallery))
        print(found[-1].printed(), flush=True)
    report = Report(bpy.app.version_string, turgor.__version__, os.cpu_count() or 1, found)
    report.write(output / "report.json")
    (output / "index.html").write_text(page(report), encoding="utf-8")
    print()
    for claim in report.broken:
        print(f"Does not hold: {claim}")
    print(f"Look at {output / 'index.html'}")
