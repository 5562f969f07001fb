"""Table 1 of [ZR13]: extrusions on a curve in space, the change of volume of small cubes in them and of the whole."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
import turgor

from ..enclosed_volume import Points
from ..outline import draw_outline
from .bend import CURVE, KINDS, UP, WAYS, Bend, Kind, coil
from .bodies import Body, circle, cubes, extrusion
from .determinants import determinant_error, points_in_tube
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model
from .words import percent, signed

RADIUS = 0.4
"""Of the round extrusion, over the radius of the bend."""
CUBE = 0.05
"""Edge of the sample cubes over the radius of the bend."""
CUBE_COUNT = 3000
TWIST, STRETCH = 1.5 * pi, 1.3
DETERMINANT_LIMIT, INVERSE_LIMIT = 1e-8, 1e-12
# At cubes of 0.05 R; they fall as the square, see the cubes.
LOCAL_LIMIT, TOTAL_LIMIT = 5e-4, 5e-4


def star(radius: float, points: int = 5) -> Points:
    """A profile with inner and outer corners, its sides cut into four."""
    angles = pi * np.arange(2 * points + 1) / points + pi / 2.0
    reach = np.where(np.arange(2 * points + 1) % 2 == 0, radius, 0.45 * radius)
    corners = reach[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    parts = np.arange(4)[:, None] / 4.0
    return np.concatenate([(1.0 - parts) * a + parts * b for a, b in pairwise(corners)])


def bar(width: float, height: float) -> Points:
    """A rectangle, its sides cut into eight."""
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]) * (width / 2.0, height / 2.0)
    parts = np.arange(8)[:, None] / 8.0
    return np.concatenate([(1.0 - parts) * a + parts * b for a, b in pairwise(corners)])


def is_inside(profile: Points, places: Points) -> np.ndarray:
    """(K,) whether places (K, 2) lie in a polygon: an odd number of its sides is above them."""
    a, b = profile[:, None], np.roll(profile, -1, axis=0)[:, None]
    spans = (a[..., 0] <= places[:, 0]) != (b[..., 0] <= places[:, 0])
    slope = (b[..., 1] - a[..., 1]) / np.where(b[..., 0] == a[..., 0], 1.0, b[..., 0] - a[..., 0])
    above = a[..., 1] + (places[:, 0] - a[..., 0]) * slope > places[:, 1]
    return (spans & above).sum(axis=0) % 2 == 1


def cubes_inside(profile: Points, start: float, end: float, size: float) -> Body:
    """Sample cubes whose middle lies in the extrusion of a profile; the same every time."""
    low, high = profile.min(axis=0), profile.max(axis=0)
    middles = np.random.default_rng(2).uniform((start + size, *low), (end - size, *high), (6 * CUBE_COUNT, 3))
    middles = middles[is_inside(profile, middles[:, 1:])][:CUBE_COUNT]
    return cubes(middles - size / 2.0, size)


def run(gallery: Gallery) -> Experiment:
    """Bends four extrusions along a coil, by every way."""
    bend = Bend(coil())
    radius = bend.tightest_radius()
    start, end = 0.1 * bend.posed.length, 0.9 * bend.posed.length
    round_profile = circle(RADIUS * radius)
    profiles = {
        "round": round_profile,
        "star": star(RADIUS * radius),
        "bar": bar(0.6 * radius, 0.4 * radius),
        "round, beside the spine": round_profile * 0.6 + (0.0, 0.2 * radius),
    }
    bodies = {name: extrusion(profile, start, end, 0.02 * radius) for name, profile in profiles.items()}
    found = {}
    for name, body in bodies.items():
        samples = cubes_inside(profiles[name], start, end, CUBE * radius)
        for way in WAYS:
            errors = np.abs(samples.local_errors(bend.bent(samples, way)))
            total = body.total_error(bend.bent(body, way))
            found[name, way] = (float(errors.mean()), float(errors.max()), total)
    rows = [
        [f"{name}: {what}", *(write(found[name, way][column]) for way in WAYS)]
        for name in bodies
        for column, (what, write) in enumerate(
            (("local, mean", percent), ("local, largest", percent), ("total", signed)),
        )
    ]
    claims = [
        claim
        for kind in KINDS
        for claim in (
            Claim(
                f"extrusions, {kind}: mean local error", max(found[name, kind][0] for name in bodies), most=LOCAL_LIMIT
            ),
            Claim(f"extrusions, {kind}: total", max(abs(found[name, kind][2]) for name in bodies), most=TOTAL_LIMIT),
        )
    ]
    determinants, inverses = with_twist_and_stretch(bend, RADIUS * radius)
    point_rows = [
        ["|det J − 1|, largest", *(f"{determinants[kind]:.1g}" for kind in KINDS)],
        ["back to where it was, off by, over the length", *(f"{inverses[kind]:.1g}" for kind in KINDS)],
    ]
    point_claims = [
        *(Claim(f"twist, stretch, {kind}: |det J − 1|", determinants[kind], most=DETERMINANT_LIMIT) for kind in KINDS),
        *(Claim(f"twist, stretch, {kind}: round trip", inverses[kind], most=INVERSE_LIMIT) for kind in KINDS),
    ]
    experiment = Experiment(
        "extrusions",
        "Extrusions on a coil",
        f"Four profiles drawn out along a curve in space that bends and turns out of its plane. In each, "
        f"{CUBE_COUNT:,} small cubes, {CUBE} of the bend's radius wide, tell what happens to the flesh inside.",
        [Table(["Extrusion", *WAYS], rows), Table(["Points, with twist and stretch", *KINDS], point_rows)],
        [*claims, *point_claims],
        {f"{name}, {way}": dict(zip(("mean", "max", "total"), row, strict=True)) for (name, way), row in found.items()}
        | {"determinant": determinants, "round_trip": inverses},
    )
    experiment.pictures.append(pictures(gallery, bend, bodies["star"]))
    return experiment


def with_twist_and_stretch(bend: Bend, radius: float) -> tuple[dict[str, float], dict[str, float]]:
    """By kind, of flesh that is twisted by 270° and stretched by 1.3: |det J − 1|, and round trip over length."""
    length = bend.posed.length / STRETCH
    rest = turgor.Spine([(0.0, 0.0, 0.0), (length, 0.0, 0.0)], normal=UP)
    points = points_in_tube(0.1 * length, 0.9 * length, radius, CUBE_COUNT)
    determinants, inverses = {}, {}
    for kind in KINDS:

        def mapped(places: Points, kind: Kind = kind) -> Points:
            return turgor.flesh(places, rest, bend.posed, kind, match="relative_length", twist=TWIST)

        bound = turgor.Fleshing(rest, points, kind, match="relative_length")
        back = bound.inverse(mapped(points), bend.posed, twist=TWIST)
        determinants[kind] = determinant_error(mapped, points)
        inverses[kind] = float(np.abs(back - points).max()) / length
    return determinants, inverses


def pictures(gallery: Gallery, bend: Bend, body: Body) -> list[Picture]:
    """The star by the Curve modifier and by the engine, and by the engine with a twist."""
    bent = bend.bent(body, CURVE)
    fleshed = bend.bent(body, "radial")
    twisted = bend.fleshed(body.points, "radial", twist=TWIST)
    shot = gallery.shot([bent, fleshed, twisted], (0.35, -1.0, 0.5), (800, 700))
    row = [
        gallery.picture(name, [Model(body.moved(positions), way)], shot, text)
        for name, positions, way, text in (
            ("star_curve", bent, CURVE, f"<b>{CURVE}</b>"),
            ("star_radial", fleshed, "radial", "<b>Radial</b>"),
            ("star_twisted", twisted, "radial", f"<b>Radial</b>, twisted: total {signed(body.total_error(twisted))}"),
        )
    ]
    draw_outline(row[0].path, row[1].path)
    return row
