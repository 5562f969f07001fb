"""How far each bone is turned against its parent, as Blender's drivers read it, and poses in which one bone turns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def local_turns(
    pose_matrices: NDArray[np.floating], rest_matrices: NDArray[np.float64], parents: NDArray[np.int32]
) -> NDArray[np.float64]:
    """(F, B, 3) x, y, z of the unit quaternion of each bone's turn from rest, its w not below 0.

    What a driver variable of the bone reads in local space as *Quaternion*: half the sine's angle about each axis.
    pose_matrices: (F, B, 4, 4) as `turgor.VolumeSkin.deform` takes them.
    """
    turns = np.zeros((*pose_matrices.shape[:2], 3))
    for bone, parent in enumerate(parents):
        moved = pose_matrices[:, bone].astype(np.float64)
        if parent >= 0:
            moved = np.linalg.solve(pose_matrices[:, parent].astype(np.float64), moved)
        turns[:, bone] = _quaternions(np.linalg.solve(rest_matrices[bone], moved @ rest_matrices[bone]))[:, 1:]
    return turns


def turned(
    bone: int, rotations: NDArray[np.float64], rest_matrices: NDArray[np.float64], parents: NDArray[np.int32]
) -> NDArray[np.float64]:
    """(M, B, 4, 4) poses in which only this bone is turned, about its own axes, and all its children follow.

    rotations: (M, 3) rotation vectors, radians.
    """
    whole = np.tile(np.eye(4), (len(rotations), 1, 1))
    whole[:, :3, :3] = _rotation_matrices(rotations)
    moved = rest_matrices[bone] @ whole @ np.linalg.inv(rest_matrices[bone])
    poses = np.tile(np.eye(4), (len(rotations), len(parents), 1, 1))
    for member in range(len(parents)):
        ancestor = member
        while ancestor not in {bone, -1}:
            ancestor = int(parents[ancestor])
        if ancestor == bone:
            poses[:, member] = moved
    return poses


def within_ball(count: int, most: float, seed: int) -> NDArray[np.float64]:
    """(count, 3) rotation vectors of every direction up to `most` radians; the same for the same seed."""
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * (most * random.uniform(size=(count, 1)) ** 0.5)


def _rotation_matrices(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    angles = np.linalg.norm(vectors, axis=1)[:, None, None]
    axes = vectors / np.maximum(angles[..., 0], np.finfo(float).tiny)
    cross = np.zeros((len(vectors), 3, 3))
    cross[:, 2, 1], cross[:, 0, 2], cross[:, 1, 0] = axes.T
    cross -= cross.transpose(0, 2, 1)
    return np.eye(3) + np.sin(angles) * cross + (1.0 - np.cos(angles)) * (cross @ cross)


def _quaternions(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, 4) of the rotations, scales and mirrors taken off as Blender does."""
    rotations = matrices[:, :3, :3] / np.linalg.norm(matrices[:, :3, :3], axis=1, keepdims=True)
    rotations = rotations * np.sign(np.linalg.det(rotations))[:, None, None]
    # q qᵀ, four times: its longest row is the quaternion to all digits.
    squares = np.empty((len(rotations), 4, 4))
    diagonal = np.einsum("nii->ni", rotations)
    signs = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    np.einsum("nii->ni", squares)[...] = 1.0 + diagonal @ signs.T
    for one, (row, column) in enumerate(((2, 1), (0, 2), (1, 0))):
        turn = rotations[:, row, column] - rotations[:, column, row]
        squares[:, 0, one + 1] = squares[:, one + 1, 0] = turn
        shear = rotations[:, row, column] + rotations[:, column, row]
        squares[:, row + 1, column + 1] = squares[:, column + 1, row + 1] = shear
    longest = np.einsum("nii->ni", squares).argmax(axis=1)
    found = np.take_along_axis(squares, longest[:, None, None], axis=1)[:, 0]
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return found * np.where(found[:, :1] < 0.0, -1.0, 1.0)
