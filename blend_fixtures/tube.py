"""Closed tubes of quads about a chain of bones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import bpy
import numpy as np

from .character import Bone, Character, Point, make_character, make_mesh
from .quads import fill_loop, grid_boundary, grid_quads

SIDES = 32
"""Divisible by four: the caps are square grids."""
ROUNDING = 1.8
"""Half the window over radius: less folds the inner side of a sharp corner."""


@dataclass(frozen=True)
class Tube:
    """A round tube about a polyline of joints, its corners rounded.

    radius, spacing (of rings), blend (half the length over which a joint's weights change): metres.
    """

    joints: Sequence[Point]
    radius: float
    spacing: float
    blend: float


def build_tube(name: str, tube: Tube, bone_names: Sequence[str], material: bpy.types.Material) -> Character:
    """A tube bound to one bone per segment; bone X axes are as near to the world's X as they can be."""
    joints = np.asarray(tube.joints, dtype=float)
    bones = []
    for index, bone_name in enumerate(bone_names):
        direction = joints[index + 1] - joints[index]
        bend_axis = np.array([1.0, 0.0, 0.0])
        bend_axis -= direction * (bend_axis @ direction) / (direction @ direction)
        bones.append(
            Bone(
                bone_name,
                tuple(joints[index]),
                tuple(joints[index + 1]),
                bone_names[index - 1] if index else None,
                tuple(bend_axis),
            )
        )
    points, faces, arc_lengths = tube_mesh(tube)
    mesh = make_mesh(name, points, faces)
    mesh.materials.append(material)
    return make_character(name, mesh, bones, chain_weights(tube, arc_lengths))


def tube_mesh(tube: Tube) -> tuple[np.ndarray, list[tuple[int, ...]], np.ndarray]:
    """Points (N, 3), quads wound outward, and each point's arc length along the polyline."""
    joint_lengths = _joint_lengths(tube)
    ring_count = round(joint_lengths[-1] / tube.spacing) + 1
    ring_lengths = np.linspace(0.0, joint_lengths[-1], ring_count)
    centres = _rounded_polyline(tube, ring_lengths)
    frames = _rotation_minimising_frames(centres)
    angles = 2 * np.pi * (np.arange(SIDES) + 0.5) / SIDES
    circle = tube.radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = centres[:, None, :] + np.einsum("sa,rac->rsc", circle, frames)

    points = list(rings.reshape(-1, 3))
    arc_lengths = list(np.repeat(ring_lengths, SIDES))
    faces: list[tuple[int, ...]] = []
    for ring in range(ring_count - 1):
        for side in range(SIDES):
            here, there = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
            faces.append((here, there, there + SIDES, here + SIDES))

    edge = SIDES // 4
    start = SIDES // 8
    around = [(start + side) % SIDES for side in range(SIDES)]
    for loop, arc_length in (
        (around[::-1], ring_lengths[0]),
        ([side + (ring_count - 1) * SIDES for side in around], ring_lengths[-1]),
    ):
        inside = fill_loop(np.array([points[index] for index in loop]), edge, edge)
        grid = [[-1] * (edge + 1) for _ in range(edge + 1)]
        for (row, column), index in zip(grid_boundary(edge, edge), loop, strict=True):
            grid[row][column] = index
        for row in range(1, edge):
            for column in range(1, edge):
                grid[row][column] = len(points)
                points.append(inside[row, column])
                arc_lengths.append(arc_length)
        faces += grid_quads(grid)
    return np.array(points), faces, np.array(arc_lengths)


def chain_weights(tube: Tube, arc_lengths: np.ndarray) -> np.ndarray:
    """Blend weights (N, bone count): a smooth step about every joint, two bones at most."""
    joint_lengths = _joint_lengths(tube)
    reached = [np.ones_like(arc_lengths)]
    for joint_length in joint_lengths[1:-1]:
        t = np.clip((arc_lengths - joint_length) / (2 * tube.blend) + 0.5, 0.0, 1.0)
        reached.append(t * t * (3 - 2 * t))
    reached.append(np.zeros_like(arc_lengths))
    return np.stack([here - there for here, there in pairwise(reached)], axis=1)


def _joint_lengths(tube: Tube) -> np.ndarray:
    steps = np.linalg.norm(np.diff(np.asarray(tube.joints, dtype=float), axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _rounded_polyline(tube: Tube, arc_lengths: np.ndarray) -> np.ndarray:
    """The polyline averaged over a window of ROUNDING diameters; the ends keep their places."""
    joints = np.asarray(tube.joints, dtype=float)
    joint_lengths = _joint_lengths(tube)
    reach = np.minimum(ROUNDING * tube.radius, np.minimum(arc_lengths, joint_lengths[-1] - arc_lengths))
    window = np.linspace(-1.0, 1.0, 41)
    samples = arc_lengths[:, None] + reach[:, None] * window
    return np.stack([np.interp(samples, joint_lengths, joints[:, axis]).mean(axis=1) for axis in range(3)], axis=1)


def _rotation_minimising_frames(centres: np.ndarray) -> np.ndarray:
    """Normal and binormal (R, 2, 3) along a curve, by double reflection (Wang et al. 2008)."""
    tangents = np.gradient(centres, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    normal = np.cross(np.eye(3)[np.argmin(np.abs(tangents[0]))], tangents[0])
    normal /= np.linalg.norm(normal)
    frames = [(normal, np.cross(tangents[0], normal))]
    for ring in range(1, len(centres)):
        step = centres[ring] - centres[ring - 1]
        normal_moved = normal - 2 * (step @ normal) / (step @ step) * step
        tangent_moved = tangents[ring - 1] - 2 * (step @ tangents[ring - 1]) / (step @ step) * step
        turn = tangents[ring] - tangent_moved
        if turn @ turn > 1e-24:
            normal_moved = normal_moved - 2 * (turn @ normal_moved) / (turn @ turn) * turn
        normal = normal_moved - (normal_moved @ tangents[ring]) * tangents[ring]
        normal /= np.linalg.norm(normal)
        frames.append((normal, np.cross(tangents[ring], normal)))
    return np.array(frames)
