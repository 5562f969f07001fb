"""A chain of bones as a spine: which bones, where their joints rest, and where the pose has them."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from numpy.typing import NDArray


def chain_names(rig: bpy.types.Object, first: str, last: str) -> tuple[str, ...] | None:
    """Names of the bones from `first` to its descendant `last`; None when they are no chain."""
    bones = rig.data.bones
    if first not in bones or last not in bones:
        return None
    names = [last]
    while names[-1] != first:
        parent = bones[names[-1]].parent
        if parent is None:
            return None
        names.append(parent.name)
    return tuple(reversed(names))


def obstacle(rig: bpy.types.Object | None, first: str, last: str) -> str | None:
    """Why there is no chain and what to do; None when there is one."""
    if rig is None or rig.type != "ARMATURE":
        return "No armature chosen: pick the armature whose bones are the spine"
    for name in (first, last):
        if name not in rig.data.bones:
            return (
                f"{rig.name} has no bone {name}: choose the first and the last bone"
                if name
                else ("No bones chosen: choose the first and the last bone of the chain")
            )
    if chain_names(rig, first, last) is None:
        return f"{last} does not hang on {first}: choose bones of one chain, from root to tip"
    return None


def suggest(rig: bpy.types.Object, chosen: Iterable[str]) -> tuple[str, str]:
    """First and last bone: of the chosen ones, else of the longest chain that does not branch."""
    bones = rig.data.bones
    names = [name for name in chosen if name in bones]
    if len(names) > 1:
        by_depth = sorted(names, key=lambda name: len(bones[name].parent_recursive))
        return by_depth[0], by_depth[-1]
    if names:
        return _run(bones[names[0]])
    runs = [_run(bone) for bone in bones if bone.parent is None or len(bone.parent.children) > 1]
    if not runs:
        return "", ""
    return max(runs, key=lambda run: len(chain_names(rig, *run) or ()))


def _run(bone: bpy.types.Bone) -> tuple[str, str]:
    last = bone
    while len(last.children) == 1:
        last = last.children[0]
    return bone.name, last.name


def read_rest(rig: bpy.types.Object, names: tuple[str, ...]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(n, 4, 4) matrices of bones and B-bone segments, and the last tail (3,); armature space."""
    bones = [rig.data.bones[name] for name in names]
    segments = [_segments(rig, bone.name, is_rest=True) for bone in bones]
    matrices = [
        np.array(bone.matrix_local, np.float64) @ m for bone, ms in zip(bones, segments, strict=True) for m in ms
    ]
    return np.array(matrices), np.array(bones[-1].tail_local, np.float64)


def read_posed(rig: bpy.types.Object, names: tuple[str, ...]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What `read_rest` reads, in the pose of an evaluated armature."""
    bones = [rig.pose.bones[name] for name in names]
    segments = [_segments(rig, bone.name, is_rest=False) for bone in bones]
    matrices = [np.array(bone.matrix, np.float64) @ m for bone, ms in zip(bones, segments, strict=True) for m in ms]
    return np.array(matrices), np.array(bones[-1].tail, np.float64)


def _segments(rig: bpy.types.Object, name: str, *, is_rest: bool) -> list[NDArray[np.float64]]:
    """(4, 4) where each segment of a bone begins, in the bone's space."""
    count = rig.data.bones[name].bbone_segments
    if count < 2:
        return [np.eye(4)]
    posed = rig.pose.bones[name]
    return [np.array(posed.bbone_segment_matrix(index, rest=is_rest), np.float64) for index in range(count)]
