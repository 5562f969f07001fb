"""Figures 9 and 10 of [ZR13]: cubes of shrinking size in a bent tube, the mean change of their volume."""

from __future__ import annotations

from functools import partial
from math import log, pi

import numpy as np

from .bend import CURVE, KINDS, WAYS, Bend, arc
from .bodies import Body, cubes, sample_cubes
from .chart import Chart, Line
from .determinants import determinant_error, points_in_tube
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model
from .tones import tones
from .words import percent, signed

RADIUS = 1.0
"""Of the tube, R."""
BEND_RADIUS = 2.5
ANGLE = pi / 2.0
LENGTH = ANGLE * BEND_RADIUS
SIZES = (0.4, 0.2, 0.1, 0.05, 0.025)
COUNT = 2000
LIMIT_SIZE, LIMIT = 0.1, 1e-3
LEAST_ORDER = 1.9
DETERMINANT_LIMIT = 1e-8


def run(gallery: Gallery) -> Experiment:
    """Bends sample cubes of every size about a quarter circle."""
    bend = Bend(arc(LENGTH, ANGLE))
    bodies = {size: sample_cubes(SIZES[0], LENGTH - SIZES[0], RADIUS, size, COUNT) for size in SIZES}
    errors = {way: [np.abs(body.local_errors(bend.bent(body, way))) for body in bodies.values()] for way in WAYS}
    means = {way: [float(error.mean()) for error in each] for way, each in errors.items()}
    orders = {kind: log(means[kind][0] / means[kind][-1]) / log(SIZES[0] / SIZES[-1]) for kind in KINDS}
    points = points_in_tube(0.02 * LENGTH, 0.98 * LENGTH, RADIUS, COUNT)
    determinants = {kind: determinant_error(partial(bend.fleshed, kind=kind), points) for kind in KINDS}
    at = SIZES.index(LIMIT_SIZE)
    rows = [[f"{size:g} R", *(percent(means[way][index]) for way in WAYS)] for index, size in enumerate(SIZES)]
    rows.append(["falls with size to the power of", "–", *(f"{orders[kind]:.2f}" for kind in KINDS)])
    rows.append(["a point: |det J − 1|", "–", *(f"{determinants[kind]:.1g}" for kind in KINDS)])
    lines = [Line(way, SIZES, means[way]) for way in WAYS]
    claims = [Claim(f"cubes of 0.1 R, {kind}: mean local error", means[kind][at], most=LIMIT) for kind in KINDS]
    claims += [Claim(f"cubes, {kind}: order of the fall", orders[kind], least=LEAST_ORDER) for kind in KINDS]
    claims += [Claim(f"points, {kind}: |det J − 1|", determinants[kind], most=DETERMINANT_LIMIT) for kind in KINDS]
    experiment = Experiment(
        "cubes",
        "Cubes in the flesh",
        f"{COUNT:,} cubes anywhere in a tube of radius R whose bend has the radius {BEND_RADIUS:g} R. The Curve "
        f"modifier changes them by {percent(means[CURVE][at])} on average, however small they are. Fleshing "
        "changes them only because a cube's sides are flat and the flesh is not: half the size, a quarter of the "
        "error, down to a point, which keeps its volume. Blue shrank, red grew.",
        [Table(["Size of cube, mean local error", *WAYS], rows)],
        claims,
        {
            "sizes": SIZES,
            "mean": means,
            "max": {way: [float(error.max()) for error in each] for way, each in errors.items()},
            "order": orders,
            "determinant": determinants,
        },
        [Chart("Error against size", "size of the cubes, over R", "Mean change of a cube.", lines, is_log=True)],
    )
    experiment.pictures.append(pictures(gallery, bend))
    return experiment


def lattice() -> Body:
    """Cubes in rows, with gaps, those that lie in the tube."""
    pitch, size = 0.325, 0.25
    steps = np.arange(-4, 4)
    along = np.arange(0.0, LENGTH - size, pitch)
    corners = np.stack(np.meshgrid(along, steps * pitch, steps * pitch, indexing="ij"), axis=-1).reshape(-1, 3)
    corners[:, 1:] += (pitch - size) / 2.0
    middles = corners + size / 2.0
    return cubes(corners[np.hypot(middles[:, 1], middles[:, 2]) + 0.4 * size <= RADIUS], size)


def pictures(gallery: Gallery, bend: Bend) -> list[Picture]:
    """Rows of cubes by the Curve modifier and by the engine, coloured by what became of each."""
    body = lattice()
    bent = {way: bend.bent(body, way) for way in (CURVE, "radial")}
    shot = gallery.shot(list(bent.values()), (0.4, -1.0, 0.5), (1000, 640))
    row = []
    for way, positions in bent.items():
        changes = body.local_errors(positions)
        text = f"<b>{way}</b>: from {signed(changes.min())} to {signed(changes.max())}"
        model = Model(body.moved(positions), way, colours=np.repeat(tones(changes), 8, axis=0), is_smooth=False)
        row.append(gallery.picture(f"cubes_{way.split()[0].lower()}", [model], shot, text))
    return row
