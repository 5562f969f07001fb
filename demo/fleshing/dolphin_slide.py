"""Figure 7 of [ZR13]: a dolphin of few faces slides along a curve in space."""

from __future__ import annotations

import numpy as np
import turgor

from blend_fixtures import dolphin

from ..enclosed_volume import Points
from .bend import CURVE, KINDS, UP, WAYS
from .bodies import Body, cubes
from .chart import Chart, Line
from .curve_modifier import CurveModifier
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model
from .tones import tones
from .words import percent, signed

POSITION_COUNT = 49
SHOWN = (0.0, 0.34, 0.68, 1.0)
"""Parts of the way, in the picture of the whole curve."""
CUBE = 0.01
"""Edge in metres of the sample cubes, one about each point of its skin."""
LIMIT, CORRECTED_LIMIT = 1e-3, 1e-6


class Swim:
    """The dolphin along X, its tail at the origin, bound to a straight spine; the curve it swims along."""

    def __init__(self) -> None:
        surface = dolphin.body_surface()
        (_, tail, _), (_, nose, _) = dolphin.SPINE_ENDS
        x, y, z = surface.points.T
        self.body = Body(np.stack([tail - y, x, z], axis=1), surface.quads.tolist())
        self.length = tail - nose
        self.path = turgor.Spine.from_bezier(*np.moveaxis(np.array(dolphin.LEAP), 1, 0), normal=UP)
        rest = turgor.Spine([(0.0, 0.0, 0.0), (self.length, 0.0, 0.0)], normal=UP)
        self.bound = turgor.Fleshing(rest, self.body.points, "radial", match="length")
        self.cubes = cubes(self.body.points - CUBE / 2.0, CUBE)
        self.bound_cubes = turgor.Fleshing(rest, self.cubes.points, "radial", match="length")
        self.curve_modifier = CurveModifier(self.path)

    @property
    def way(self) -> float:
        """How far it can slide along the curve."""
        return self.path.length - self.length

    def bent(self, slide: float, way: str) -> Points:
        """(N, 3) the dolphin, by one of `WAYS`."""
        return self._bent(self.body, self.bound, slide, way)

    def bent_cubes(self, slide: float, way: str) -> Points:
        """(M, 3) sample cubes, by one of `WAYS`."""
        return self._bent(self.cubes, self.bound_cubes, slide, way)

    def _bent(self, body: Body, bound: turgor.Fleshing, slide: float, way: str) -> Points:
        if way == CURVE:
            return self.curve_modifier.bent(body.moved(body.points + np.array((slide, 0.0, 0.0))))
        return bound.with_kind(KINDS[WAYS.index(way) - 1]).deform(self.path, slide=slide)


def corrected(body: Body, positions: Points) -> Points:
    """(N, 3) with the exact volume of the rest: the engine's formula, an even swelling."""
    offsets = np.arange(0, 4 * len(body.faces) + 1, 4, dtype=np.int32)
    mesh = turgor.Mesh(body.points, offsets, np.asarray(body.faces, dtype=np.int32).ravel())
    return turgor.correct(mesh, positions, mesh.volume(body.points), np.ones(len(positions)))


def run(gallery: Gallery) -> Experiment:
    """Slides it from end to end."""
    swim = Swim()
    slides = np.linspace(0.0, swim.way, POSITION_COUNT)
    totals = {way: [swim.body.total_error(swim.bent(slide, way)) for slide in slides] for way in WAYS}
    local = {
        way: float(max(np.abs(swim.cubes.local_errors(swim.bent_cubes(slide, way))).max() for slide in slides))
        for way in WAYS
    }
    exact = [swim.body.total_error(corrected(swim.body, swim.bent(slide, "radial"))) for slide in slides]
    worst = {way: float(np.abs(errors).max()) for way, errors in totals.items()}
    outside = swim.bound.point_count - min(swim.bound.validity(swim.path, slide=slide).valid_count for slide in slides)
    worst_exact = float(np.abs(exact).max())
    lines = [Line(way, slides.tolist(), totals[way]) for way in WAYS]
    rows = [
        ["total volume", *(percent(worst[way]) for way in WAYS), f"{100.0 * worst_exact:.0e} %"],
        [f"cubes of {100.0 * CUBE:g} cm at its skin", *(percent(local[way]) for way in WAYS), "–"],
    ]
    experiment = Experiment(
        "dolphin",
        "A dolphin slides along a curve",
        f"{swim.bound.point_count:,} points, no bones, no weights: a straight spine at rest and a curve in space. At "
        f"{POSITION_COUNT} positions from end to end its volume is off by at most {percent(worst['radial'])}, which "
        "its few faces leave; the exact correction takes away that rest. Flesh at the skin: blue shrank, red grew.",
        [Table(["Off at most, at any position", *WAYS, "radial, corrected"], rows)],
        [
            *(Claim(f"dolphin, {kind}: total volume at every position", worst[kind], most=LIMIT) for kind in KINDS),
            Claim("dolphin, radial and corrected: total volume", worst_exact, most=CORRECTED_LIMIT),
        ],
        {
            "vertices": swim.bound.point_count,
            "points_not_exact": outside,
            "slides": slides.tolist(),
            "total": totals,
            "worst": worst,
            "local": local,
            "corrected": worst_exact,
        },
        [Chart("Total volume over the way", "how far it slid, metres", "Change of total volume.", lines)],
    )
    experiment.pictures.extend(pictures(gallery, swim))
    return experiment


def pictures(gallery: Gallery, swim: Swim) -> list[list[Picture]]:
    """The whole way, and the place where the Curve modifier does worst, coloured by what became of the flesh."""
    places = [swim.bent(part * swim.way, "radial") for part in SHOWN]
    shot = gallery.shot(places, (0.25, -1.0, 0.22), (1600, 560))
    models = [Model(swim.body.moved(positions), "radial") for positions in places]
    whole = gallery.picture(
        "dolphin_way", [*models, gallery.thread(swim.path, 0.018)], shot, "The same dolphin at four places of its way."
    )
    slide = worst_place(swim)
    bent = {way: swim.bent(slide, way) for way in (CURVE, "radial")}
    changes = {way: swim.cubes.local_errors(swim.bent_cubes(slide, way)) for way in bent}
    near = gallery.shot(list(bent.values()), (0.3, -1.0, -0.3), (1000, 520))
    pair = [
        gallery.picture(
            f"dolphin_{way.split()[0].lower()}",
            [Model(swim.body.moved(positions), way, colours=tones(changes[way]))],
            near,
            f"<b>{way}</b>: from {signed(changes[way].min())} to {signed(changes[way].max())}",
        )
        for way, positions in bent.items()
    ]
    return [[whole], pair]


def worst_place(swim: Swim) -> float:
    """The slide at which the Curve modifier changes flesh most, on average over the skin."""
    slides = np.linspace(0.0, swim.way, POSITION_COUNT)
    return float(max(slides, key=lambda slide: np.abs(swim.cubes.local_errors(swim.bent_cubes(slide, CURVE))).mean()))
