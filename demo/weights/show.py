"""Weights every case both ways, prints the table, writes pictures and report."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import bpy
import numpy as np
import turgor

from .cases import CASES, Case, chain
from .pictures import Gallery
from .shapes import limb
from .trial import BLENDER, TURGOR, Result, make, parent, weigh

WAYS = (BLENDER, TURGOR)
# Rings and sides of tubes for times, and Turgor's resolution: as it comes and one that is compared.
SIZES = ((132, 50, 128), (132, 50, 0), (1000, 100, 0))
BONES = 17


def show(output: Path) -> None:
    """Writes report.json and the pictures."""
    output.mkdir(parents=True, exist_ok=True)
    # Not the factory settings: they would turn the extension off.
    bpy.ops.wm.read_homefile(use_empty=True)
    gallery = Gallery(output)
    report: dict = {"blender": bpy.app.version_string, "turgor": turgor.__version__, "cases": {}, "times": {}}
    print(f"{'':28}{'vertices':>9}  " + "".join(f"{way:^34}" for way in WAYS))
    print(f"{'':28}{'':>9}  " + f"{'without':>8}{'sum - 1':>9}{'strain':>8}{'':>9}" * len(WAYS))
    for number, case in enumerate(CASES, 1):
        found = {way: weigh(case, way) for way in WAYS}
        gallery.picture(number, case, {way: posed for way, (_, posed) in found.items()})
        results = {way: result for way, (result, _) in found.items()}
        print(_line(case, results), flush=True)
        report["cases"][case.name] = {way: asdict(r) | {"is_good": r.is_good} for way, r in results.items()}
    good = {way: sum(case[way]["is_good"] for case in report["cases"].values()) for way in WAYS}
    print(f"\ngood: {BLENDER} {good[BLENDER]}, {TURGOR} {good[TURGOR]} of {len(CASES)}\n")
    for rings, sides, resolution in SIZES:
        seconds = _times(rings, sides, resolution)
        ratio = seconds[TURGOR] / seconds[BLENDER]
        voxels = f"{resolution} voxels" if resolution else "automatic"
        report["times"][f"{rings * sides}, {voxels}"] = seconds | {"ratio": ratio}
        print(f"{rings * sides:>9,} vertices, {BONES} bones, {voxels}: ", end="")
        print(", ".join(f"{way} {seconds[way]:.2f} s" for way in WAYS) + f", ratio {ratio:.2f}", flush=True)
    (output / "report.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    print(f"\nLook at the pictures in {output}")


def _line(case: Case, results: dict[str, Result]) -> str:
    columns = "".join(
        f"{r.unweighted_count:>8}{r.sum_error:>9.0e}{r.distortion:>8.3f}{'good' if r.is_good else 'fails':>9}"
        for r in (results[way] for way in WAYS)
    )
    return f"{case.name:28}{results[TURGOR].vertex_count:>9}  {columns}"


def _times(rings: int, sides: int, resolution: int) -> dict[str, float]:
    """Seconds each way takes, on a limb of as many vertices."""
    bones = chain(*[(x, 0.0, 0.0) for x in np.linspace(0.0, 8.0, BONES + 1)])
    case = Case("times", [limb((0, 0, 0), (8, 0, 0), rings=rings, sides=sides, caps=0)], bones, lambda *_: True)
    seconds = {}
    for way in WAYS:
        meshes, rig = make(case)
        seconds[way] = parent(meshes, rig, way, resolution)
        for ob in [*meshes, rig]:
            bpy.data.objects.remove(ob)
    return seconds
