"""What weights are worth under a test range of motion: Blender's Armature modifier alone, linear, nothing corrected."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import radians

import bpy
import numpy as np
from mathutils import Matrix

from ..enclosed_volume import Indices, Points, Shells, following, shells
from ..evaluated import faces, positions

# Of each joint alone, and of all at once, each way about each axis of its bone.
ALONE, TOGETHER = radians(60.0), radians(30.0)
AXES = "XYZ"
# Edges shorter than this part of the longest have no length to speak of; others shrink no further than to that part.
LEAST_LENGTH, LEAST_RATIO = 1e-9, 1e-6

Turns = dict[str, Matrix]


@dataclass(frozen=True)
class Strain:
    """Means and largest values of all poses; nan where nothing can turn.

    volume: relative change of the whole. edges: root mean square of the logarithm of edge lengths over rest, each edge
    by the area about it.
    """

    pose_count: int
    volume_mean: float
    volume_worst: float
    edges_mean: float
    edges_worst: float


def strain(meshes: list[bpy.types.Object], rig: bpy.types.Object) -> Strain:
    """Leaves the rig as it rests."""
    set_pose(rig, {})
    skins = [Skin(ob) for ob in meshes]
    volumes, edges = [], []
    for turns in poses(rig):
        set_pose(rig, turns)
        posed = [skin.measured() for skin in skins]
        volumes.append(abs(sum(change for change, _, _ in posed)) / sum(skin.volume for skin in skins))
        edges.append(np.sqrt(sum(squares for _, squares, _ in posed) / sum(area for _, _, area in posed)))
    set_pose(rig, {})
    if not volumes:
        return Strain(0, *[float("nan")] * 4)
    return Strain(len(volumes), *(float(of(values)) for values in (volumes, edges) for of in (np.mean, np.max)))


def poses(rig: bpy.types.Object) -> Iterator[Turns]:
    """Every joint alone, then all at once. The only root would move all alike."""
    bones = [bone for bone in rig.data.bones if bone.use_deform]
    is_only_root = sum(bone.parent is None for bone in bones) == 1
    joints = [bone.name for bone in bones if bone.parent is not None or not is_only_root]
    for angle, groups in ((ALONE, [[name] for name in joints]), (TOGETHER, [joints] if len(joints) > 1 else [])):
        for group in groups:
            for axis in AXES:
                for signed in (angle, -angle):
                    turn = Matrix.Rotation(signed, 4, axis)
                    yield dict.fromkeys(group, turn)


def set_pose(rig: bpy.types.Object, turns: Turns) -> None:
    """Turns of bones against their rest, in their own axes; others rest."""
    for pose_bone in rig.pose.bones:
        pose_bone.matrix_basis = turns.get(pose_bone.name, Matrix())
    bpy.context.view_layer.update()


class Skin:
    """One mesh at rest, and what is measured of its poses. Places are object space times the object's scale."""

    def __init__(self, ob: bpy.types.Object) -> None:
        self._ob = ob
        rest = self._places()
        sizes, corners = faces(ob)
        self._shells: Shells = shells(rest, sizes, corners)
        volumes = self._shells.volumes(rest)
        self._signs = np.sign(volumes)
        self.volume = float(np.abs(volumes).sum())
        self._ends, self._areas = _edges(rest, sizes, corners)
        lengths = self._lengths(rest)
        is_long = lengths > LEAST_LENGTH * lengths.max(initial=0.0)
        self._ends, self._areas, self._rest_lengths = self._ends[is_long], self._areas[is_long], lengths[is_long]

    def measured(self) -> tuple[float, float, float]:
        """Change of volume, square sum of the logarithms of edge ratios times areas, sum of areas."""
        places = self._places()
        volume = float(self._shells.volumes(places) @ self._signs)
        ratios = np.maximum(self._lengths(places) / self._rest_lengths, LEAST_RATIO)
        return volume - self.volume, float(self._areas @ np.log(ratios) ** 2), float(self._areas.sum())

    def _places(self) -> Points:
        return positions(self._ob) @ np.array(self._ob.matrix_world.to_3x3()).T

    def _lengths(self, places: Points) -> Points:
        return np.linalg.norm(places[self._ends[:, 0]] - places[self._ends[:, 1]], axis=1)


def _edges(rest: Points, sizes: Indices, corners: Indices) -> tuple[Indices, Points]:
    """(E, 2) ends of all edges, (E,) area about each: a face is shared out evenly among its sides."""
    starts = np.cumsum(sizes) - sizes
    face = np.repeat(np.arange(len(sizes)), sizes)
    after = following(corners, sizes)
    first = rest[corners[starts]][face]
    area_vectors = np.add.reduceat(np.cross(rest[corners] - first, rest[after] - first), starts, axis=0)
    shares = (0.5 * np.linalg.norm(area_vectors, axis=1) / sizes)[face]
    ends, edge = np.unique(np.sort(np.stack([corners, after], axis=1), axis=1), axis=0, return_inverse=True)
    return ends, np.bincount(edge.ravel(), shares)
