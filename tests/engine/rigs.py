"""Chains of bones inside a tube along x: weights, poses and the bound engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import turgor
from numpy.typing import NDArray
from surfaces import Surface, tube

Mode = Literal["linear", "dual_quaternion"]
Fields = Literal["plain", "even"]


def rotation(axis: Sequence[float] | NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """(4, 4) turn by `angle` about `axis` through the origin."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return matrix


def translation(offset: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    """(4, 4) shift."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix


def random_rotation(rng: np.random.Generator, largest: float) -> NDArray[np.float64]:
    """(4, 4) turn about a random axis by at most `largest` radians."""
    return rotation(rng.normal(size=3), rng.uniform(-largest, largest))


def random_rigid_motion(rng: np.random.Generator) -> NDArray[np.float64]:
    """(4, 4) any turn and a shift of a few units."""
    return translation(rng.uniform(-3.0, 3.0, 3)) @ random_rotation(rng, np.pi)


def applied(matrix: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) points moved by an affine (4, 4)."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


@dataclass(frozen=True)
class Rig:
    """parents: (B,); rest_matrices: (B, 4, 4); influences of vertex v in row v of `bones`, `weights`: (N, K)."""

    surface: Surface
    parents: NDArray[np.int32]
    rest_matrices: NDArray[np.float64]
    bones: NDArray[np.int32]
    weights: NDArray[np.float64]
    vertex_mask: NDArray[np.float64] | None = None

    @property
    def bone_count(self) -> int:
        return len(self.parents)

    def skeleton(self) -> turgor.Skeleton:
        return turgor.Skeleton(self.parents, self.rest_matrices)

    def skinning(self, mode: Mode = "linear") -> turgor.Skinning:
        count, width = self.bones.shape
        offsets = np.arange(0, count * width + 1, width, dtype=np.int32)
        bones, weights = self.bones.ravel(), self.weights.ravel()
        return turgor.Skinning(self.skeleton(), offsets, bones, weights, mode, self.vertex_mask)

    def body(
        self,
        mode: Mode = "linear",
        joints: Sequence[turgor.Joint] | None = None,
        *,
        solver: Literal["simultaneous", "sequential"] = "simultaneous",
        keep_bone_scale: bool = True,
        fields: Fields = "plain",
        object_from_armature: NDArray[np.float64] | None = None,
    ) -> turgor.VolumeSkin:
        return turgor.VolumeSkin(
            self.surface.mesh(),
            self.skinning(mode),
            joints,
            solver=solver,
            keep_bone_scale=keep_bone_scale,
            fields=fields,
            object_from_armature=object_from_armature,
        )

    def pose(self, local: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """(B, 4, 4) pose @ inverse(rest), from one (4, 4) per bone in its own rest space; parents come first."""
        posed = np.empty_like(self.rest_matrices)
        for bone, parent in enumerate(self.parents):
            rest = self.rest_matrices[bone]
            if parent >= 0:
                rest = posed[parent] @ np.linalg.inv(self.rest_matrices[parent]) @ rest
            posed[bone] = rest @ local[bone]
        return posed @ np.linalg.inv(self.rest_matrices)

    def rest_pose(self) -> NDArray[np.float64]:
        return self.pose([np.eye(4)] * self.bone_count)

    def random_pose(
        self, rng: np.random.Generator, largest: float = 0.8, *, scale: float = 0.0, shift: float = 0.0
    ) -> NDArray[np.float64]:
        """Each bone turned by at most `largest` radians, scaled per axis by 1 ± scale, moved by at most `shift`."""
        return self.pose(
            [
                translation(rng.uniform(-shift, shift, 3))
                @ random_rotation(rng, largest)
                @ np.diag([*rng.uniform(1.0 - scale, 1.0 + scale, 3), 1.0])
                for _ in range(self.bone_count)
            ]
        )

    def bent(self, angle: float, twist: float = 0.0) -> NDArray[np.float64]:
        """Every bone but the first bent about z and twisted about its own direction."""
        turned = rotation([0.0, 0.0, 1.0], angle) @ rotation([0.0, 1.0, 0.0], twist)
        return self.pose([np.eye(4), *[turned] * (self.bone_count - 1)])

    def with_mask(self, mask: NDArray[np.float64]) -> Rig:
        return replace(self, vertex_mask=mask)

    def with_surface(self, surface: Surface) -> Rig:
        return replace(self, surface=surface)


def chain(surface: Surface, bone_count: int, length: float = 4.0, *, softness: float = 0.35) -> Rig:
    """A straight chain along x; each vertex weighted to its three nearest bones, smoothly, summing to one.

    softness: width of the blend in bone lengths. Bones point along x, their Y axis, as Blender's do.
    """
    bone_length = length / bone_count
    along_x = rotation([0.0, 0.0, 1.0], -np.pi / 2)
    heads = np.arange(bone_count) * bone_length
    rest = np.array([translation([head, 0.0, 0.0]) @ along_x for head in heads])

    distances = (surface.positions[:, :1] - (heads + bone_length / 2)) / bone_length
    bells = np.exp(-0.5 * (distances / softness) ** 2) + 1e-12
    width = min(3, bone_count)
    bones = np.argsort(-bells, axis=1)[:, :width].astype(np.int32)
    weights = np.take_along_axis(bells, bones, axis=1)
    weights /= weights.sum(axis=1, keepdims=True)
    return Rig(surface, np.arange(-1, bone_count - 1, dtype=np.int32), rest, bones, weights)


def limb(bone_count: int = 3, rings: int = 33, sides: int = 12) -> Rig:
    """A closed tube of four units with a chain of bones: an arm."""
    return chain(tube(rings, sides), bone_count)


def careless(rig: Rig, rng: np.random.Generator) -> Rig:
    """Weights as artists leave them: sums other than one, stored in any order, some vertices with none at all."""
    order = rng.permuted(np.tile(np.arange(rig.bones.shape[1]), (len(rig.bones), 1)), axis=1)
    weights = np.take_along_axis(rig.weights, order, axis=1) * rng.uniform(0.3, 2.0, (len(rig.bones), 1))
    weights[rng.random(len(weights)) < 0.02] = 0.0
    return replace(rig, bones=np.take_along_axis(rig.bones, order, axis=1), weights=weights)
