"""Bendy bones: their segments at rest and posed, and which places of the skin belong to which.

Blender blends S + 1 *nodes* of a bone of S segments, one at each end and between two segments. Node 0 stands for the
bone among the engine's bones, the others are further rows of the skeleton.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import chain
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Matrix, Vector
from numpy.typing import NDArray

# What of a bone shapes its segments at rest. Ease does so only where they are curved.
EASE = frozenset({"bbone_easein", "bbone_easeout"})
REST_SETTINGS = (
    "bbone_curveinx bbone_curveinz bbone_curveoutx bbone_curveoutz bbone_rollin bbone_rollout bbone_scalein"
    " bbone_scaleout bbone_easein bbone_easeout"
).split()
# Entries of rest segments that differ by less from those of a straight bone, in its lengths, are straight.
STRAIGHT = 1e-6


def _have_buffers() -> bool:
    try:
        memoryview(Matrix())  # pyright: ignore[reportArgumentType]
    except TypeError:
        return False
    return True


# Matrices are bytes from some Blender 5 on; read so, they take a sixth of the time.
_HAVE_BUFFERS = _have_buffers()


class MovingRest(NamedTuple):
    """A bone whose curve at rest is keyed or driven."""

    read: int  # place in `Bends.reads`
    settings: tuple[str, ...]
    values: tuple[object, ...]  # when it was bound


class Bends(NamedTuple):
    """Rows of a skeleton that segments move: M rows of nodes, E rows of ends."""

    rows: NDArray[np.intp]  # (M,) of the skeleton
    bones: NDArray[np.intp]  # (M,) whose nodes they are
    reads: tuple[tuple[int, tuple[int, ...]], ...]  # by bone, its place in the pose and its nodes: M in all, as rows
    before: NDArray[np.float64]  # (M, 4, 4) rest matrix of the bone
    after: NDArray[np.float64]  # (M, 4, 4) inverse of the node's rest matrix, both armature space
    # Below a bone that bends its children hang on no node: Blender moves them with the bone as a whole.
    end_rows: NDArray[np.intp]  # (E,)
    end_bones: NDArray[np.intp]  # (E,)
    owners: NDArray[np.intp]  # bone of each row that is not a bone
    moving: tuple[MovingRest, ...]
    # By a place in `moving` and settings: the part of `after` that these make. Filled by frames.
    moved: dict[tuple[int, tuple[object, ...]], NDArray[np.float64]]


class RestBend(NamedTuple):
    """A bendy bone at rest."""

    segments: int
    matrices: NDArray[np.float64]  # (S + 1, 4, 4) of the nodes, bone's space
    is_straight: bool
    is_curved_mapping: bool
    animated: tuple[str, ...]  # settings of its curve at rest that are keyed or driven
    values: tuple[object, ...]  # theirs


class RestPose:
    """An armature at rest, evaluated apart from the artist's scene, while the context lasts."""

    def __init__(self, rig: bpy.types.Object) -> None:
        self._rig = rig
        self._animated = animated_settings(rig.data)

    def read(self, name: str) -> RestBend:
        """Read a bendy bone."""
        bone = self._rig.data.bones[name]
        matrices = read_nodes([(self._rig.pose.bones[name], range(bone.bbone_segments + 1))], is_rest=True)
        heights = np.linspace(0.0, bone.length, len(matrices))
        straight = np.tile(np.eye(4), (len(matrices), 1, 1))
        straight[:, 1, 3] = heights
        is_straight = bool(np.abs(matrices - straight).max() <= STRAIGHT * max(bone.length, 1.0))
        animated = tuple(sorted(self._animated.get(name, set()) - (EASE if is_straight else set())))
        is_curved = bone.bbone_mapping_mode == "CURVED"
        return RestBend(bone.bbone_segments, matrices, is_straight, is_curved, animated, _values(bone, animated))

    def node_coordinates(self, name: str, bend: RestBend, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n,) where each of points (n, 3), armature space, lies along the bone: i at node i, from 0 to S."""
        bone = self._rig.data.bones[name]
        if bend.is_curved_mapping:
            index_of = self._rig.pose.bones[name].bbone_segment_index
            return np.array([sum(index_of(Vector(point))) for point in points.tolist()], np.float64)
        local = np.linalg.inv(np.array(bone.matrix_local, np.float64))
        heights = points @ local[1, :3] + local[1, 3]
        return np.clip(heights / bone.length, 0.0, 1.0) * bend.segments


@contextmanager
def rest_pose(rig: bpy.types.Object, frame: int) -> Iterator[RestPose]:
    """The bones of `rig` without its pose, as they are at `frame`; nothing in the artist's scene is tagged."""
    scene = bpy.data.scenes.new("Turgor Bind")
    scene.frame_current = frame
    ob = bpy.data.objects.new("Turgor Bind", rig.data)
    try:
        scene.collection.objects.link(ob)
        view_layer = scene.view_layers[0]
        view_layer.update()
        yield RestPose(ob.evaluated_get(view_layer.depsgraph))
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.objects.remove(ob)


def animated_settings(armature: bpy.types.Armature) -> dict[str, set[str]]:
    """By bone, the settings of its curve at rest that keyframes or drivers move."""
    animation = armature.animation_data
    found: dict[str, set[str]] = {}
    if animation is None:
        return found
    paths = [curve.data_path for curve in animation.drivers]
    if animation.action is not None or len(animation.nla_tracks):
        # Whichever they are: actions are shared, and their curves lie deep.
        return {bone.name: set(REST_SETTINGS) for bone in armature.bones}
    for path in paths:
        if path.startswith('bones["') and (setting := path.rpartition(".")[2]) in REST_SETTINGS:
            owner = armature.path_resolve(path.rpartition(".")[0])
            found.setdefault(owner.name, set()).add(setting)
    return found


def signature(armature: bpy.types.Armature) -> list[object]:
    """What of bendy bones at rest a binding depends on; what is animated is read on each frame."""
    animated = animated_settings(armature)
    return [
        (
            bone.bbone_mapping_mode,
            bone.bbone_handle_type_start,
            bone.bbone_handle_type_end,
            getattr(bone.bbone_custom_handle_start, "name", ""),
            getattr(bone.bbone_custom_handle_end, "name", ""),
            _values(bone, (name for name in REST_SETTINGS if name not in animated.get(bone.name, ()))),
        )
        for bone in armature.bones
        if bone.bbone_segments > 1
    ]


def read_nodes(
    reads: Iterable[tuple[bpy.types.PoseBone, Iterable[int]]], *, is_rest: bool = False
) -> NDArray[np.float64]:
    """(M, 4, 4) of nodes of evaluated bones, bone's space. Raises RuntimeError where segments are others."""
    matrices: list[Matrix] = []
    for bone, nodes in reads:
        read = bone.bbone_segment_matrix
        matrices += [read(node, rest=is_rest) for node in nodes]
    if _HAVE_BUFFERS:
        flat = np.frombuffer(b"".join(map(bytes, matrices)), np.float32).astype(np.float64)
    else:
        flat = np.fromiter(chain.from_iterable(chain.from_iterable(matrices)), np.float64, 16 * len(matrices))
    return flat.reshape(-1, 4, 4)


def pose_rows(rig: bpy.types.Object, bends: Bends, matrices: NDArray[np.float32]) -> None:
    """Fill the rows of `bends` in `matrices`, (R, 4, 4), whose bones have pose @ inverse(rest). `rig`: evaluated."""
    bones = matrices[bends.bones].astype(np.float64)
    matrices[bends.end_rows] = matrices[bends.end_bones]
    posed = [rig.pose.bones[place] for place, _ in bends.reads]
    nodes = read_nodes(zip(posed, (nodes for _, nodes in bends.reads), strict=True))
    matrices[bends.rows] = bones @ bends.before @ nodes @ _after(posed, bends)


# Settings of animated curves at rest that are remembered, of each bone.
_MOST_MOVED = 16


def _after(posed: list[bpy.types.PoseBone], bends: Bends) -> NDArray[np.float64]:
    """(M, 4, 4) as in `Bends`, with the curves at rest as they are now."""
    after = bends.after
    for place, rest in enumerate(bends.moving):
        bone, nodes = posed[rest.read], bends.reads[rest.read][1]
        now = place, _values(bone.bone, rest.settings)
        if now[1] == rest.values:
            continue
        first = sum(len(each) for _, each in bends.reads[: rest.read])
        rows = slice(first, first + len(nodes))
        moved = bends.moved.get(now)
        if moved is None:
            moved = np.linalg.inv(bends.before[rows] @ read_nodes([(bone, nodes)], is_rest=True))
            if len(bends.moved) >= _MOST_MOVED * len(bends.moving):
                bends.moved.clear()
            bends.moved[now] = moved
        if after is bends.after:
            after = after.copy()
        after[rows] = moved
    return after


def _values(bone: bpy.types.Bone, names: Iterable[str]) -> tuple[object, ...]:
    values = (getattr(bone, name) for name in names)
    return tuple(value if isinstance(value, float) else tuple(value) for value in values)
