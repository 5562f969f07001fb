"""Figure 6 of [ZR13]: two bends of a body with two holes, one after the other, across one another."""

from __future__ import annotations

from math import radians

import numpy as np

from blend_fixtures import genus_two

from ..enclosed_volume import Points
from .bend import CURVE, KINDS, WAYS, Bend, arc
from .bodies import Body
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model
from .words import signed

LEVELS = 4
ANGLES = (110.0, 70.0)
MARGIN = 0.2
"""Length of spine beyond the body on either side."""
LIMIT = 1e-4
SECOND_TO_X = np.array([(0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
"""Rows: the axes of the second bend, whose spine lies along Y."""


def run(gallery: Gallery) -> Experiment:
    """Bends the body along its length, then across it, by every way."""
    surface = genus_two.surface(LEVELS)
    body = Body(surface.points, surface.quads.tolist())
    stages = {way: bent_twice(body, way) for way in WAYS}
    totals = {way: [body.total_error(positions) for positions in both] for way, both in stages.items()}
    rows = [
        [name, *(signed(totals[way][index]) for way in WAYS)]
        for index, name in enumerate(("after the first bend", "after both"))
    ]
    experiment = Experiment(
        "two_bends",
        "Two bends, one after the other",
        f"A body with two holes, {len(body.points):,} points, is bent by {ANGLES[0]:g}° along its length and the "
        f"result by {ANGLES[1]:g}° across it: the second spine finds flesh of any shape around it.",
        [Table(["Total volume", *WAYS], rows)],
        [Claim(f"two bends, {kind}: total volume", abs(totals[kind][1]), most=LIMIT) for kind in KINDS],
        {"vertices": len(body.points), "total": totals},
    )
    experiment.pictures.append(pictures(gallery, body, stages, totals))
    return experiment


def bent_twice(body: Body, way: str) -> tuple[Points, Points]:
    """(N, 3) after the first bend and after both, the second in the first's place."""
    first = bent_once(body, way, ANGLES[0])
    turned = body.moved(first @ SECOND_TO_X.T)
    return first, bent_once(turned, way, ANGLES[1]) @ SECOND_TO_X


def bent_once(body: Body, way: str, angle: float) -> Points:
    """(N, 3) bent about an arch whose straight spine runs through the middle of the body along X."""
    low, high = body.points.min(axis=0), body.points.max(axis=0)
    length = high[0] - low[0] + 2.0 * MARGIN
    origin = np.array([low[0] - MARGIN, (low[1] + high[1]) / 2.0, body.points[:, 2].mean()])
    spine = arc(length, radians(angle))
    middle = spine.evaluate([length / 2.0]).positions[0]
    return Bend(spine).bent(body.moved(body.points - origin), way) - middle


def pictures(
    gallery: Gallery, body: Body, stages: dict[str, tuple[Points, Points]], totals: dict[str, list[float]]
) -> list[Picture]:
    """At rest, after each bend by the engine, and after both by the Curve modifier."""
    first, second = stages["radial"]
    _, by_curve = stages[CURVE]
    parts = [
        ("two_bends_rest", body.points, "", "At rest"),
        ("two_bends_first", first, "radial", f"<b>radial</b>, once: {signed(totals['radial'][0])}"),
        ("two_bends_second", second, "radial", f"<b>radial</b>, twice: {signed(totals['radial'][1])}"),
        ("two_bends_curve", by_curve, CURVE, f"<b>{CURVE}</b>, twice: {signed(totals[CURVE][1])}"),
    ]
    shot = gallery.shot([positions for _, positions, *_ in parts], (0.5, -1.0, 0.75), (640, 520))
    return [
        gallery.picture(name, [Model(body.moved(positions), way)], shot, text) for name, positions, way, text in parts
    ]
