"""Weights every case both ways, prints the tables, writes pictures, page and report."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import turgor

from . import memory
from .cases import CASES, Case, chain
from .page import page
from .pictures import Gallery
from .report import Report, Trial
from .shapes import limb
from .trial import BLENDER, WAYS, make, parent, weigh, weigh_again

CHARACTERS = (
    "elephant",
    "giraffe",
    "snake",
    "bent_cylinder",
    "three_segment_cylinder",
    "four_bone_chain",
    "twist_chain",
)
# Rings and sides of tubes for times, bones, Turgor's resolution (0: as it comes), and how often each way.
SIZES = ((132, 50, 17, 128, 5), (132, 50, 17, 0, 5), (132, 50, 60, 0, 5), (1000, 100, 17, 0, 2))
LARGE = (1000, 100)


def show(output: Path) -> None:
    """Writes report.json, index.html and the pictures."""
    output.mkdir(parents=True, exist_ok=True)
    report = Report(bpy.app.version_string, turgor.__version__)
    for name in CHARACTERS:
        found = {way: weigh_again(name, way) for way in WAYS}
        strains = {way: strain for way, (strain, _) in found.items()}
        report.characters.append(Trial(name.replace("_", " "), found[WAYS[0]][1], strains))
    # Not the factory settings: they would turn the extension off.
    bpy.ops.wm.read_homefile(use_empty=True)
    gallery = Gallery(output)
    for number, case in enumerate(CASES, 1):
        found = {way: weigh(case, way) for way in WAYS}
        picture = gallery.picture(number, case, {way: posed for way, (_, posed) in found.items()})
        results = {way: result for way, (result, _) in found.items()}
        strains = {way: result.strain for way, result in results.items()}
        if case.at_size_one is not None:
            strains[BLENDER] = weigh(case.at_size_one, BLENDER)[0].strain
        report.cases.append(Trial(case.name, next(iter(results.values())).vertex_count, strains, results, picture))
    for rings, sides, bones, resolution, turns in SIZES:
        voxels = f"{resolution} voxels" if resolution else "automatic"
        report.times[f"{rings * sides:,} vertices, {bones} bones, {voxels}"] = _times(
            rings, sides, bones, resolution, turns
        )
    for bones in (17, 60):
        report.memory[f"{LARGE[0] * LARGE[1]:,} vertices, {bones} bones"] = memory.measured(*LARGE, bones)
    print(report.text())
    report.write(output / "report.json")
    (output / "index.html").write_text(page(report), encoding="utf-8")
    print(f"\nLook at {output / 'index.html'}")


def _times(rings: int, sides: int, bones: int, resolution: int, turns: int) -> dict[str, float]:
    """Seconds each way takes on a limb of as many vertices, the least of some turns."""
    joints = chain(*[(x, 0.0, 0.0) for x in np.linspace(0.0, 8.0, bones + 1)])
    case = Case("times", [limb((0, 0, 0), (8, 0, 0), rings=rings, sides=sides, caps=0)], joints, lambda *_: True)
    seconds = dict.fromkeys(WAYS, float("inf"))
    for _ in range(turns):
        for way in WAYS:
            meshes, rig = make(case)
            seconds[way] = min(seconds[way], parent(meshes, rig, way, resolution))
            for ob in [*meshes, rig]:
                bpy.data.objects.remove(ob)
    return seconds
