"""Bends every body, counts folds with and without repair, prints the table, writes pictures and report."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import bpy
import numpy as np
import turgor

from ..enclosed_volume import Indices, Points
from ..evaluated import evaluated, positions, undeformed_shells
from ..live import frame_times, live_frame, turn_on, volume_modifier
from .bodies import BODIES, FRAMES, Body
from .count import new_folds
from .pictures import Gallery

# Frames timed, the fastest of so many.
TIMED_COUNT = 15


@dataclass(frozen=True)
class Result:
    """The deepest frame one way. volume_error: relative, of the shape shown; milliseconds: of the engine."""

    new_folds: int
    volume_error: float
    milliseconds: float
    vertices_held: int
    largest_move: float
    frames_with_folds: int


@dataclass(frozen=True)
class Shape:
    """How the body looks one way: its points, points of new folds, and those that were held."""

    points: Points
    in_fold: Indices
    held: Indices


def show(output: Path) -> None:
    """Writes report.json and the pictures."""
    output.mkdir(parents=True, exist_ok=True)
    report: dict = {"blender": bpy.app.version_string, "turgor": turgor.__version__, "bodies": {}}
    print(f"{'':8}{'vertices':>9}{'skinned':>9}  " + "".join(f"{way:^46}" for way in ("without repair", "with repair")))
    columns = f"{'new folds':>10}{'on frames':>10}{'volume error':>14}{'engine':>12}"
    print(f"{'':8}{'':>9}{'folds':>9}  " + columns * 2)
    for body in BODIES:
        found, shapes, faces, skinned_folds = bend(body)
        for way, shape in shapes.items():
            Gallery(output).picture(body.name, way, shape, faces)
        report["bodies"][body.name] = {way: asdict(result) for way, result in found.items()}
        count = len(shapes["before"].points)
        cells = "".join(
            f"{r.new_folds:>10}{r.frames_with_folds:>10}{r.volume_error:>14.1e}{r.milliseconds:>9.2f} ms"
            for r in found.values()
        )
        print(f"{body.name:8}{count:>9}{skinned_folds:>9}  {cells}", flush=True)
        ratio = found["after"].milliseconds / found["before"].milliseconds
        print(f"{'':8}{found['after'].vertices_held} vertices held, {ratio:.0f} times the time without repair")
    (output / "report.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    print(f"\nLook at the pictures in {output}")


def bend(body: Body) -> tuple[dict[str, Result], dict[str, Shape], list[tuple[int, ...]], int]:
    """Both ways: figures and shapes; the faces, and how many folds skinning alone has."""
    ob = body.build().body
    if (problem := turn_on(ob)) is not None:
        raise SystemExit(f"{body.name}: {problem}")
    scene = bpy.context.scene
    shells = undeformed_shells(ob)
    rest = shells.volumes(positions(ob))
    # What the law of flesh folds is no fold of the correction.
    ob.turgor.flesh = 0.0
    joint = ob.turgor.joints["lower"]
    joint.preset = body.preset
    triangles = triangles_of(ob)
    skinned = {}
    volume_modifier(ob).show_viewport = False
    for frame in range(1, FRAMES + 1):
        scene.frame_set(frame)
        skinned[frame] = positions(ob)
    volume_modifier(ob).show_viewport = True
    at_rest = skinned[1]
    results, shapes = {}, {}
    shown = at_rest
    for way in ("before", "after"):
        ob.turgor.repair_folds = way == "after"
        frames_with_folds = 0
        for frame in range(1, FRAMES + 1):
            scene.frame_set(frame)
            shown = positions(ob)
            frames_with_folds += bool(len(new_folds(skinned[frame], shown, triangles)))
        new = new_folds(skinned[FRAMES], shown, triangles)
        live = live_frame(ob).report
        times = []
        for _ in range(TIMED_COUNT):
            scene.frame_set(FRAMES - 1)
            scene.frame_set(FRAMES)
            times.append(frame_times(ob)[1])
        results[way] = Result(
            new_folds=len(new),
            volume_error=float(abs(shells.volumes(shown).sum() / rest.sum() - 1.0)),
            milliseconds=min(times),
            vertices_held=len(live.blocked_vertices),
            largest_move=float(np.linalg.norm(shown - skinned[FRAMES], axis=1).max()),
            frames_with_folds=frames_with_folds,
        )
        shapes[way] = Shape(shown, np.unique(triangles[new.ravel()]), live.blocked_vertices.astype(np.intp))
    faces = [tuple(polygon.vertices) for polygon in ob.data.polygons]
    skinned_folds = len(new_folds(at_rest, skinned[FRAMES], triangles))
    return results, shapes, faces, skinned_folds


def triangles_of(ob: bpy.types.Object) -> Indices:
    """(T, 3) as Blender cuts the mesh at rest."""
    mesh = evaluated(ob).data
    mesh.calc_loop_triangles()
    found = np.empty((len(mesh.loop_triangles), 3), np.intc)
    mesh.loop_triangles.foreach_get("vertices", found.ravel())
    return found.astype(np.intp)
