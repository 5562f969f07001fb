"""How a spine runs along a chain of bones: which points steer it, and how far bones roll about it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

Course = Literal["joints", "bones"]


class Chain(NamedTuple):
    """A chain of bones, n joints from the first head to the last tail; object space."""

    joints: NDArray[np.float64]  # (n, 3)
    axes: NDArray[np.float64]  # (n, 3) unit X axis of the bone that starts at each joint; the last bone's twice


class Stations(NamedTuple):
    """The m points that steer a spine, each a mix of two neighbouring joints."""

    first_joint: NDArray[np.int32]  # (m,)
    part: NDArray[np.float64]  # (m,) of the way to the next joint


def stations(joint_count: int, course: Course, bend_width: float) -> Stations:
    """The joints themselves; or points along each bone, close to its ends as far as its bends are wide."""
    if course == "joints":
        return Stations(np.arange(joint_count, dtype=np.int32), np.zeros(joint_count))
    # Three points on a line from each end: a quintic spline is straight where six are.
    parts = np.array([0.0, bend_width / 4, bend_width / 2, 1 - bend_width / 2, 1 - bend_width / 4])
    bones = np.repeat(np.arange(joint_count - 1, dtype=np.int32), len(parts))
    return Stations(np.append(bones, joint_count - 1).astype(np.int32), np.append(np.tile(parts, joint_count - 1), 0.0))


def steering_points(chain: Chain, at: Stations) -> NDArray[np.float64]:
    """(m, 3)"""
    following = np.minimum(at.first_joint + 1, len(chain.joints) - 1)
    return chain.joints[at.first_joint] * (1 - at.part)[:, None] + chain.joints[following] * at.part[:, None]


def rest_spine(chain: Chain, at: Stations, course: Course) -> turgor.Spine:
    """The spine of a chain at rest; its frames start at the first bone's X axis."""
    method = "spline" if course == "joints" else "b_spline"
    return turgor.Spine(steering_points(chain, at), method, normal=chain.axes[0])


def posed_spine(rest: turgor.Spine, chain: Chain, at: Stations) -> turgor.Spine:
    """The spine of a posed chain, on the course of the spine at rest."""
    return rest.posed(steering_points(chain, at), normal=chain.axes[0])


def rolls(
    rest: turgor.Spine, posed: turgor.Spine, rest_chain: Chain, posed_chain: Chain, at: Stations
) -> NDArray[np.float64]:
    """(m,) radians by which bones roll about the spine from rest to pose; neighbours differ by half a turn at most."""
    return np.unwrap(_angles(posed, posed_chain, at) - _angles(rest, rest_chain, at))


def _angles(spine: turgor.Spine, chain: Chain, at: Stations) -> NDArray[np.float64]:
    frames = spine.evaluate(spine.station_parameters)
    axes = chain.axes[at.first_joint]
    return np.arctan2((axes * frames.binormals).sum(1), (axes * frames.normals).sum(1))


def grown(start: float, end: float, fractions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(m,) angle at parts of a spine's length: `start` at 0, `end` at 1, smooth in between."""
    smooth = fractions**3 * (10 - 15 * fractions + 6 * fractions**2)
    return start + (end - start) * smooth


def chain_of(matrices: Sequence[NDArray[np.float64]], tail: NDArray[np.float64]) -> Chain:
    """Bones' (4, 4) matrices, X Y Z axes and head in columns, and the last bone's tail."""
    bones = np.asarray(matrices, np.float64)
    axes = bones[:, :3, 0] / np.linalg.norm(bones[:, :3, 0], axis=1, keepdims=True)
    return Chain(np.vstack([bones[:, :3, 3], tail]), np.vstack([axes, axes[-1:]]))
