"""Figure 3 of [ZR13]: frames along a trefoil knot and a helix, rotation-minimising and Frenet's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import degrees, pi

import numpy as np
import turgor

from ..enclosed_volume import Points
from .bend import CURVE
from .bodies import Body, extrusion
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model

SAMPLE_COUNT = 1200
STATION_COUNT = 97
STEP = 1e-4
"""Of finite differences, over the length of the curve."""
RIBBON = 0.16
"""Its width over the reach of the curve; it is a sixth as thick."""
LIMIT = 1e-2
"""Degrees."""


@dataclass(frozen=True)
class Ribbon:
    """Frames at even lengths: positions, tangents and normals (M, 3), from the first to the last sample."""

    positions: Points
    tangents: Points
    normals: Points

    def body(self, width: float) -> Body:
        """A band across the normal."""
        half = np.array([(-0.5, -1.0 / 12.0), (0.5, -1.0 / 12.0), (0.5, 1.0 / 12.0), (-0.5, 1.0 / 12.0)]) * width
        flat = extrusion(half, 0.0, len(self.positions) - 1.0, 1.0)
        station = np.rint(flat.points[:, 0]).astype(int)
        binormals = np.cross(self.tangents, self.normals)
        across = flat.points[:, 1:2] * binormals[station] - flat.points[:, 2:] * self.normals[station]
        return flat.moved(self.positions[station] + across)


def trefoil() -> Points:
    """Stations (M, 3) of the knot, cut open."""
    t = np.linspace(0.06, 2.0 * pi - 0.06, STATION_COUNT) + 0.5 * pi
    knot = [np.sin(t) + 2.0 * np.sin(2.0 * t), -np.sin(3.0 * t), np.cos(t) - 2.0 * np.cos(2.0 * t)]
    return np.stack(knot, axis=1)


def helix() -> Points:
    """Stations (M, 3) of three turns."""
    t = np.linspace(-3.0 * pi, 3.0 * pi, STATION_COUNT)
    return np.stack([0.34 * t, 1.3 * np.sin(t), 1.3 * np.cos(t)], axis=1)


def rotation_minimising(spine: turgor.Spine, lengths: Points) -> Ribbon:
    """The engine's frames."""
    frames = spine.evaluate(spine.parameters_at(lengths))
    return Ribbon(frames.positions, frames.tangents, frames.normals)


def frenet(spine: turgor.Spine, lengths: Points) -> Ribbon:
    """Frames whose normal is the direction of the curvature."""
    frames = spine.evaluate(spine.parameters_at(lengths))
    normals = frames.curvatures / np.linalg.norm(frames.curvatures, axis=1, keepdims=True)
    return Ribbon(frames.positions, frames.tangents, normals)


def turning(spine: turgor.Spine, frames_at: Callable[[turgor.Spine, Points], Ribbon], lengths: Points) -> float:
    """Degrees by which frames turn about the tangent from end to end, in all."""
    step = STEP * spine.length
    before, here, after = (frames_at(spine, lengths + shift).normals for shift in (-step, 0.0, step))
    binormals = np.cross(frames_at(spine, lengths).tangents, here)
    rates = np.abs(np.einsum("ij,ij->i", after - before, binormals)) / (2.0 * step)
    return degrees(float(((rates[1:] + rates[:-1]) / 2.0 * np.diff(lengths)).sum()))


def run(gallery: Gallery) -> Experiment:
    """Follows both curves with both frames."""
    curves = {"trefoil knot": trefoil(), "helix": helix()}
    ways = {"Frenet": frenet, "rotation-minimising": rotation_minimising}
    rows, figures, claims, pictures = [], {}, [], []
    for name, stations in curves.items():
        spine = turgor.Spine(stations)
        # Away from its ends, which are straight: there Frenet's normal is not defined.
        lengths = np.linspace(0.03, 0.97, SAMPLE_COUNT) * spine.length
        turns = {way: turning(spine, frames_at, lengths) for way, frames_at in ways.items()}
        figures[name] = turns
        rows.append([name, *(f"{turn:.3g}°" if turn > 0.1 else f"{turn:.1g}°" for turn in turns.values())])
        claims.append(Claim(f"{name}: degrees that the frames turn", turns["rotation-minimising"], most=LIMIT))
        ribbons = {way: frames_at(spine, lengths) for way, frames_at in ways.items()}
        pictures.append(pair(gallery, name, ribbons, turns))
    return Experiment(
        "frames",
        "Frames that do not turn",
        "What rides on a spine must not turn about it by itself. Frenet's frame follows the bend and turns with its "
        "torsion; a rotation-minimising frame turns about the tangent only as far as the artist twists it.",
        [Table(["Turn about the tangent, in all", *ways], rows)],
        claims,
        figures,
        pictures=pictures,
    )


def pair(gallery: Gallery, name: str, ribbons: dict[str, Ribbon], turns: dict[str, float]) -> list[Picture]:
    """A band along the curve in each frame."""
    reach = float(np.ptp(next(iter(ribbons.values())).positions, axis=0).max())
    bodies = {way: ribbon.body(RIBBON * reach) for way, ribbon in ribbons.items()}
    shot = gallery.shot([body.points for body in bodies.values()], (0.3, -1.0, 0.5), (1000, 760))
    return [
        gallery.picture(
            f"frames_{name.split()[0]}_{way.split('-')[0].lower()}",
            [Model(body, CURVE if way == "Frenet" else "radial")],
            shot,
            f"<b>{way}</b>: turns by {turns[way]:,.0f}°",
        )
        for way, body in bodies.items()
    ]
