"""Figure 4 of [ZR13]: tubes on an arc, their total volume against the angle of the bend."""

from __future__ import annotations

from math import radians

import numpy as np

from ..outline import draw_outline
from .bend import CURVE, KINDS, WAYS, Bend, arc
from .bodies import Body, tube
from .chart import Chart, Line
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model
from .words import signed

LENGTH, RADIUS, SPACING = 14.0, 1.0, 0.1
ANGLES = tuple(range(0, 181, 15))
SHOWN = (60, 120, 180)
# Where the tube's axis lies from the spine, along the outward normal.
PLACES = {"outside of the spine": RADIUS, "about the spine": 0.0, "inside of the spine": -RADIUS}
# What sampling a round tube by flat faces leaves; the Curve modifier's change is up to 22 %.
LIMIT = 5e-4


def run(gallery: Gallery) -> Experiment:
    """Bends three tubes by up to half a turn."""
    bodies = {place: tube(0.0, LENGTH, RADIUS, SPACING, beside) for place, beside in PLACES.items()}
    bends = {angle: Bend(arc(LENGTH, radians(angle))) for angle in ANGLES}
    totals = {
        (place, way): [body.total_error(bend.bent(body, way)) for bend in bends.values()]
        for place, body in bodies.items()
        for way in WAYS
    }
    rows = [
        [f"{place}, {angle}°", *(signed(totals[place, way][ANGLES.index(angle)]) for way in WAYS)]
        for place in PLACES
        for angle in SHOWN
    ]
    lines = [
        Line(way, ANGLES, values, place if way == CURVE else "")
        for (place, way), values in sorted(totals.items(), key=lambda item: item[0][1] != CURVE)
    ]
    worst = {way: float(max(np.abs(totals[place, way]).max() for place in PLACES)) for way in WAYS}
    experiment = Experiment(
        "arcs",
        "Tubes on an arc",
        "A tube is bent by up to half a turn about a spine that runs along its wall or through its middle. Only where "
        "the spine is the middle line does the Curve modifier keep the total; elsewhere the tube grows or shrinks. "
        "The line over the later pictures is the outline of the first.",
        [Table(["Tube", *WAYS], rows)],
        [Claim(f"tubes on an arc, {kind}: total volume off at worst", worst[kind], most=LIMIT) for kind in KINDS],
        {"angles": ANGLES, "worst": worst} | {f"{place}, {way}": values for (place, way), values in totals.items()},
        [Chart("Volume against angle", "angle of the bend", "Change of total volume.", lines, x_unit="°", x_step=30.0)],
    )
    experiment.pictures.append(pictures(gallery, bends[180], bodies["outside of the spine"]))
    return experiment


def pictures(gallery: Gallery, bend: Bend, body: Body) -> list[Picture]:
    """The outer tube at half a turn by every way, with the outline of the first over the others."""
    bent = {way: bend.bent(body, way) for way in WAYS}
    shot = gallery.shot(list(bent.values()), (0.18, -1.0, 0.36), (640, 440))
    row = []
    for way, positions in bent.items():
        text = f"<b>{way}</b>: {signed(body.total_error(positions))}"
        row.append(gallery.picture(f"arc_{way.split()[0].lower()}", [Model(body.moved(positions), way)], shot, text))
    for picture in row[1:]:
        draw_outline(row[0].path, picture.path)
    return row
