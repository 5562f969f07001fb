"""Blender's Armature modifier in float64 numpy, written from its behaviour: the measure for `Skinning.deform`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rigs import Rig

Array = NDArray[np.float64]

WEIGHT_THRESHOLD = 1e-4


def linear(rig: Rig, positions: Array, pose: Array) -> Array:
    """Blend of the bones' images of each point, divided by the sum of its weights."""
    images = np.einsum("nkij,nj->nki", pose[rig.bones][..., :3, :3], positions) + pose[rig.bones][..., :3, 3]
    total = rig.weights.sum(axis=1)
    is_moved = total > WEIGHT_THRESHOLD
    blended = np.einsum("nk,nki->ni", rig.weights[is_moved], images[is_moved]) / total[is_moved, None]
    return mixed(rig, positions, is_moved, blended)


def dual_quaternion(rig: Rig, positions: Array, pose: Array) -> Array:
    """*Preserve Volume*: rigid parts blended as dual quaternions, scale applied to the point before."""
    parts = [rigid_and_scale(rest, channel) for rest, channel in zip(rig.rest_matrices, pose, strict=True)]
    turns = np.array([quaternion(rigid) for rigid, _ in parts])
    shifts = np.array([rigid[:3, 3] for rigid, _ in parts])
    scales = np.array([scale for _, scale in parts])

    real = np.zeros((len(positions), 4))
    dual = np.zeros((len(positions), 4))
    total = rig.weights.sum(axis=1)
    for bones, weights in zip(rig.bones.T, rig.weights.T, strict=True):
        turn = turns[bones]
        scale = scales[bones]
        moved = np.einsum("nij,nj->ni", scale[:, :3, :3], positions) + scale[:, :3, 3] - positions
        turned_move = rotated(turn, moved)
        half_shift = np.concatenate([np.zeros((len(bones), 1)), 0.5 * (shifts[bones] + turned_move)], axis=1)
        signed = np.where(np.sum(turn * real, axis=1) < 0.0, -weights, weights)[:, None]
        real += signed * turn
        dual += signed * product(half_shift, turn)

    is_moved = total > WEIGHT_THRESHOLD
    length = np.linalg.norm(real[is_moved], axis=1, keepdims=True)
    unit, unit_dual = real[is_moved] / length, dual[is_moved] / length
    shift = 2.0 * product(unit_dual, unit * [1.0, -1.0, -1.0, -1.0])[:, 1:]
    return mixed(rig, positions, is_moved, rotated(unit, positions[is_moved]) + shift)


def mixed(rig: Rig, positions: Array, is_moved: NDArray[np.bool_], deformed: Array) -> Array:
    """Deformed where a point has weights, by the part the modifier's vertex group leaves."""
    mask = np.ones(len(positions)) if rig.vertex_mask is None else rig.vertex_mask
    result = positions.copy()
    result[is_moved] += mask[is_moved, None] * (deformed - positions[is_moved])
    return result


def rigid_and_scale(rest: Array, channel: Array) -> tuple[Array, Array]:
    """channel = rigid @ scale; the scale acts in the bone's rest axes, about its head."""
    linear_part = channel[:3, :3]
    if np.allclose(linear_part.T @ linear_part, np.eye(3), atol=1e-5) and np.linalg.det(linear_part) > 0:
        return channel, np.eye(4)
    posed = channel @ rest
    turned = np.eye(4)
    turned[:3, :3] = orthogonal_about_y(posed[:3, :3])
    turned[:3, 3] = posed[:3, 3]
    scale = rest @ np.linalg.inv(turned) @ posed @ np.linalg.inv(rest)
    return turned @ np.linalg.inv(rest), scale


def orthogonal_about_y(axes: Array) -> Array:
    """Columns made orthonormal keeping Y. Blender compares unit Y with X as it is: only then X and Z are parallel."""
    x, y, z = axes[:, 0], unit(axes[:, 1]), axes[:, 2]
    if y @ x < 1.0:
        z = unit(np.cross(x, y))
        x = np.cross(y, z)
    elif x @ z < 1.0:
        x = unit(np.cross(y, z))
        z = np.cross(x, y)
    else:
        x = unit(np.cross(np.roll(y, -1), y))
        z = np.cross(x, y)
    return np.stack([x, y, z], axis=1)


def unit(vector: Array) -> Array:
    """The vector at length one."""
    return vector / np.linalg.norm(vector)


def quaternion(rigid: Array) -> Array:
    """(4,) w, x, y, z of a rotation: the eigenvector of Bar-Itzhack's symmetric matrix, w >= 0."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rigid[:3, :3]
    symmetric = np.array(
        [
            [xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, xx - yy - zz, xy + yx, xz + zx],
            [xz - zx, xy + yx, yy - xx - zz, yz + zy],
            [yx - xy, xz + zx, yz + zy, zz - xx - yy],
        ]
    )
    turn = np.linalg.eigh(symmetric)[1][:, -1]
    return turn if turn[0] >= 0.0 else -turn


def product(left: Array, right: Array) -> Array:
    """(N, 4) Hamilton products."""
    a, u = left[:, :1], left[:, 1:]
    b, v = right[:, :1], right[:, 1:]
    real = a * b - np.sum(u * v, axis=1, keepdims=True)
    return np.concatenate([real, a * v + b * u + np.cross(u, v)], axis=1)


def rotated(turn: Array, points: Array) -> Array:
    """(N, 3) points turned by unit quaternions (N, 4)."""
    w, axis = turn[:, :1], turn[:, 1:]
    across = 2.0 * np.cross(axis, points)
    return points + w * across + np.cross(axis, across)
