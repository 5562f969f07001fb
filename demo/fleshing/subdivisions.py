"""Figure 8 of [ZR13]: one body in finer and finer faces, what its sampling leaves of the total volume."""

from __future__ import annotations

from math import log2, radians

import numpy as np

from blend_fixtures.subdivision import subdivide

from .bend import KINDS, Bend, arc
from .bodies import Body, bar_of_cells
from .chart import Chart, Line
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model
from .words import percent, signed

CELLS = 7
LEVELS = 4
"""Of which the first, third and fourth are the paper's: 32, 482 and 1,922 points."""
ANGLE = 120.0
LIMIT = 2e-4
LEAST_ORDER = 1.8
SHOWN = (0, 2, 3)


def run(gallery: Gallery) -> Experiment:
    """Bends the body at every level of subdivision."""
    bend = Bend(arc(float(CELLS), radians(ANGLE)))
    bodies = levels()
    totals = {kind: [body.total_error(bend.fleshed(body.points, kind)) for body in bodies] for kind in KINDS}
    counts = [len(body.points) for body in bodies]
    orders = {kind: log2(abs(errors[-2] / errors[-1])) for kind, errors in totals.items()}
    rows = [[f"{count:,}", *(signed(totals[kind][index]) for kind in KINDS)] for index, count in enumerate(counts)]
    rows.append(["falls with size to the power of", *(f"{orders[kind]:.2f}" for kind in KINDS)])
    lines = [Line(kind, counts, np.abs(totals[kind]).tolist()) for kind in KINDS]
    claims = [Claim(f"1,922 points, {kind}: total volume", abs(totals[kind][-1]), most=LIMIT) for kind in KINDS]
    claims += [Claim(f"subdivision, {kind}: order of the fall", orders[kind], least=LEAST_ORDER) for kind in KINDS]
    experiment = Experiment(
        "subdivisions",
        "Finer and finer",
        f"A bar bent by {ANGLE:g}°. The map is exact for flesh, a mesh only samples it: each subdivision halves the "
        "faces and leaves a quarter of the error. Turgor Volume after it removes that rest.",
        [Table(["Points, change of total volume", *KINDS], rows)],
        claims,
        {"vertices": counts, "total": totals, "order": orders},
        [Chart("Volume against points", "points of the mesh", "Total volume off by.", lines, is_log=True)],
    )
    experiment.pictures.append(pictures(gallery, bend, bodies))
    return experiment


def levels() -> list[Body]:
    """The bar and its subdivisions [CC78], coarse first."""
    coarse = bar_of_cells(CELLS)
    points, quads = coarse.points, np.asarray(coarse.faces)
    bodies = [coarse]
    for _ in range(LEVELS - 1):
        points, quads, _ = subdivide(points, quads)
        bodies.append(Body(points, quads.tolist()))
    return bodies


def pictures(gallery: Gallery, bend: Bend, bodies: list[Body]) -> list[Picture]:
    """Three levels with their faces flat."""
    bent = {level: bend.fleshed(bodies[level].points, "radial") for level in SHOWN}
    shot = gallery.shot(list(bent.values()), (0.3, -1.0, 0.4), (800, 540))
    return [
        gallery.picture(
            f"subdivision_{len(positions)}",
            [Model(bodies[level].moved(positions), "radial", is_smooth=False)],
            shot,
            f"<b>{len(positions):,} points</b>: {percent(abs(bodies[level].total_error(positions)))} off",
        )
        for level, positions in bent.items()
    ]
