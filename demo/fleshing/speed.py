"""How long a frame takes: the engine and Blender's Curve modifier on the same tube and curve, in turns."""

from __future__ import annotations

import os
from collections.abc import Callable
from math import log10
from time import perf_counter

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from blend_fixtures.character import make_mesh
from blend_fixtures.curve_rider import CurveRider, make_bezier, put_on_curve

from ..enclosed_volume import Points
from ..evaluated import evaluated
from ..page import milliseconds
from .bend import CURVE, KINDS, UP
from .bodies import Body, tube
from .experiment import Claim, Experiment, Table
from .gallery import Gallery

LENGTH, RADIUS = 12.0, 0.5
COUNTS = (10_000, 100_000, 1_000_000)
"""Points, about; the Curve modifier is timed on the second."""
STATION_COUNT = 9
FRAME_COUNT = 60
BIND_COUNT = 5
FRAME_LIMIT, BIND_LIMIT = 0.25, 0.5 * 50.0
"""Over a frame of the Curve modifier."""
LARGEST_ORDER = 1.2
"""Linear, but the memory of a million points is farther away than that of ten thousand."""


def run(_: Gallery) -> Experiment:
    """Times frames in turns, so that other work on the machine meets both; the least of many."""
    body = tube_of(COUNTS[1])
    rest = turgor.Spine(stations(0.0), normal=UP)
    points = body.points.astype(np.float32)
    bound = {kind: turgor.Fleshing(rest, points, kind) for kind in KINDS}
    rider = made(body)
    offsets = np.empty_like(points)
    frames = {way: [] for way in (CURVE, *KINDS)}
    binds = [timed(lambda: turgor.Fleshing(rest, points)) for _ in range(BIND_COUNT)]
    for number in range(FRAME_COUNT):
        angle = 0.6 + 1.2 * number / FRAME_COUNT
        frames[CURVE].append(curve_frame(rider, stations(angle)))
        for kind, flesh in bound.items():
            frames[kind].append(engine_frame(flesh, stations(angle), offsets))
    least = {way: min(times) for way, times in frames.items()}
    ratios = {kind: least[kind] / least[CURVE] for kind in KINDS}
    bind_ratio = min(binds) / least[CURVE]
    per_point = nanoseconds_per_point()
    order = 1.0 + log10(per_point[COUNTS[-1]] / per_point[COUNTS[0]]) / log10(COUNTS[-1] / COUNTS[0])
    bpy.data.objects.remove(rider.body)
    times = Table(
        ["One frame", CURVE, *KINDS],
        [
            ["time", *(milliseconds(least[way]) for way in (CURVE, *KINDS))],
            ["part of the Curve modifier's", "1", *(f"{ratios[kind]:.3f}" for kind in KINDS)],
        ],
    )
    bind_row = [f"{len(points):,} points", milliseconds(min(binds)), f"{bind_ratio:.1f}"]
    counts = [[f"{count:,}", f"{time:.1f}"] for count, time in per_point.items()]
    return Experiment(
        "speed",
        "How long it takes",
        f"A tube of {len(points):,} points on a curve of {STATION_COUNT} points that moves every frame; the least of "
        f"{FRAME_COUNT} frames. The engine's includes making the posed spine, on all {os.cpu_count()} processors.",
        [
            times,
            Table(["Bind, once", "time", "Curve modifier's frames"], [bind_row]),
            Table(["Points", "radial, nanoseconds per point and frame"], counts),
        ],
        [
            *(Claim(f"frame, {kind}: over the Curve modifier's", ratios[kind], most=FRAME_LIMIT) for kind in KINDS),
            Claim("bind: over the Curve modifier's frame", bind_ratio, most=BIND_LIMIT),
            Claim("time grows with points to the power of", order, most=LARGEST_ORDER),
        ],
        {
            "vertices": len(points),
            "frame_ms": least,
            "frame_ratio": ratios,
            "bind_ms": min(binds),
            "bind_ratio": bind_ratio,
            "nanoseconds_per_point": per_point,
        },
    )


def tube_of(count: int) -> Body:
    """A tube of about `count` points."""
    return tube(0.0, LENGTH, RADIUS, LENGTH * 32.0 / count)


def stations(angle: float) -> Points:
    """(n, 3) on an S that swings by `angle` to either side."""
    x = np.linspace(0.0, LENGTH, STATION_COUNT)
    wave = 2.0 * np.pi * x / LENGTH
    return np.stack([x, 0.3 * angle * np.cos(1.5 * wave), angle * np.sin(wave)], axis=1)


def timed(work: Callable[[], object]) -> float:
    """Milliseconds."""
    start = perf_counter()
    work()
    return 1000.0 * (perf_counter() - start)


def handles(points: Points) -> Points:
    """(n, 3) from each point to its right handle."""
    return np.gradient(points, axis=0) / 3.0


def made(body: Body) -> CurveRider:
    """The tube with a Curve modifier, on a Bezier curve of Blender's own resolution."""
    mesh_object = bpy.data.objects.new("timed", make_mesh("timed", body.points, body.faces))
    bpy.context.scene.collection.objects.link(mesh_object)
    points = stations(0.0)
    arms = handles(points)
    knots = [tuple(map(tuple, knot)) for knot in zip(points, points - arms, points + arms, strict=True)]
    rider = CurveRider(mesh_object, make_bezier("timed", knots, resolution=12))
    put_on_curve(rider, "POS_X")
    bpy.context.view_layer.update()
    return rider


def curve_frame(rider: CurveRider, points: Points) -> float:
    """Milliseconds of the Curve modifier alone, as Blender itself measures them."""
    arms = handles(points)
    knots = rider.curve.data.splines[0].bezier_points
    for name, values in (("co", points), ("handle_left", points - arms), ("handle_right", points + arms)):
        knots.foreach_set(name, values.astype(np.float32).ravel())
    rider.curve.data.update_tag()
    bpy.context.view_layer.update()
    return 1000.0 * evaluated(rider.body).modifiers["Curve"].execution_time


def engine_frame(bound: turgor.Fleshing, points: Points, offsets: NDArray[np.float32]) -> float:
    """Milliseconds from the moved points of the spine to the offsets of the body."""
    return timed(lambda: bound.deform_into(offsets, bound.rest_spine.posed(points)))


def nanoseconds_per_point() -> dict[int, float]:
    """Of a frame with each of `COUNTS` points anywhere in the tube, in turns."""
    generator = np.random.default_rng(4)
    low, high = (0.0, -0.6 * RADIUS, -0.6 * RADIUS), (LENGTH, 0.6 * RADIUS, 0.6 * RADIUS)
    rest = turgor.Spine(stations(0.0), normal=UP)
    clouds = [generator.uniform(low, high, (count, 3)).astype(np.float32) for count in COUNTS]
    bound = [(turgor.Fleshing(rest, points), np.empty_like(points)) for points in clouds]
    times = [
        [engine_frame(flesh, stations(0.6 + 0.02 * number), offsets) for flesh, offsets in bound]
        for number in range(FRAME_COUNT)
    ]
    return {count: 1e6 * least / count for count, least in zip(COUNTS, np.min(times, axis=0).tolist(), strict=True)}
