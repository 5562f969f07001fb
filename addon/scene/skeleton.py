"""Bones at rest, those that deform a mesh and all their ancestors, and how an evaluated armature poses them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from . import bendy


class RestBones(NamedTuple):
    """B bones, then the nodes of those that bend: R rows of the engine's skeleton. Armature space."""

    names: tuple[str, ...]  # (B,)
    parents: NDArray[np.int32]  # (R,) -1 without one
    rest_matrices: NDArray[np.float64]  # (R, 4, 4)
    pose_indices: NDArray[np.int32]  # (B,) place among all bones of the pose
    is_deform: NDArray[np.bool_]  # (B,) deforms this mesh
    tails: NDArray[np.float64]  # (R, 3)
    bends: bendy.Bends | None = None

    @property
    def is_segment(self) -> list[bool] | None:
        """Per row, whether it is a segment of the row above; None where no bone bends."""
        return None if self.bends is None else [row >= len(self.names) for row in range(len(self.parents))]

    def bone_of(self, row: int) -> int:
        """The bone whose row or node this is."""
        return row if self.bends is None or row < len(self.names) else int(self.bends.owners[row - len(self.names)])


class PoseError(ValueError):
    """The armature is not the one that was bound; says what to do."""


class Envelopes(NamedTuple):
    """Envelopes of B bones, armature space."""

    heads: NDArray[np.float64]  # (B, 3)
    tails: NDArray[np.float64]  # (B, 3)
    head_radii: NDArray[np.float64]  # (B,)
    tail_radii: NDArray[np.float64]  # (B,)
    distances: NDArray[np.float64]  # (B,) over which the weight falls to 0
    weights: NDArray[np.float64]  # (B,)
    is_multiplied: NDArray[np.bool_]  # (B,) weights of the group are multiplied by the envelope


# Of a mesh that no Armature poses.
NO_BONES = RestBones(
    (),
    np.zeros(0, np.int32),
    np.zeros((0, 4, 4)),
    np.zeros(0, np.int32),
    np.zeros(0, bool),
    np.zeros((0, 3)),
)


def read_bones(rig: bpy.types.Object, group_names: Collection[str] | None) -> RestBones:
    """Bones whose name is a vertex group and that deform, with their ancestors, in the order of the pose.

    group_names: None for all that deform. Other bones are left out: nothing makes the dependency graph evaluate them
    before the correction.
    """
    bones = rig.data.bones
    deform = {bone.name for bone in bones if bone.use_deform and (group_names is None or bone.name in group_names)}
    needed = deform | {parent.name for name in deform for parent in bones[name].parent_recursive}
    places = [place for place, pose_bone in enumerate(rig.pose.bones) if pose_bone.name in needed]
    names = tuple(rig.pose.bones[place].name for place in places)
    index = {name: number for number, name in enumerate(names)}
    parents = [index[bone.parent.name] if (bone := bones[name]).parent else -1 for name in names]
    rest_matrices = np.array([bones[name].matrix_local for name in names], np.float64).reshape(-1, 4, 4)
    return RestBones(
        names,
        np.array(parents, np.int32),
        rest_matrices,
        np.array(places, np.int32),
        np.array([name in deform for name in names], bool),
        np.array([bones[name].tail_local for name in names], np.float64).reshape(-1, 3),
    )


def read_envelopes(rig: bpy.types.Object, bones: RestBones) -> Envelopes:
    """Envelopes of these bones."""
    own = [rig.data.bones[name] for name in bones.names]
    return Envelopes(
        bones.rest_matrices[:, :3, 3],
        bones.tails,
        np.array([bone.head_radius for bone in own], np.float64),
        np.array([bone.tail_radius for bone in own], np.float64),
        np.array([bone.envelope_distance for bone in own], np.float64),
        np.array([bone.envelope_weight for bone in own], np.float64),
        np.array([bone.use_envelope_multiply for bone in own], bool),
    )


def bent(bones: RestBones, bends: Mapping[int, bendy.RestBend], nodes: Mapping[int, list[int]]) -> RestBones:
    """The same bones with rows for nodes.

    bends: bones that bend, by row; nodes: those of their nodes that hold skin, rising. Node 0 has the bone's own row.
    Raises np.linalg.LinAlgError where a node is scaled to nothing.
    """
    parents, rests, tails = bones.parents.tolist(), list(bones.rest_matrices), list(bones.tails)
    rows, owners, reads, before, ends, moving = [], [], [], [], {}, []
    for bone, bend in bends.items():
        own = bones.rest_matrices[bone]
        at_rest = own @ bend.matrices
        above = bone
        for node in nodes[bone]:
            tail = at_rest[node + 1, :3, 3] if node < bend.segments else bones.tails[bone]
            if node == 0:
                rests[bone], tails[bone] = at_rest[0], tail
                rows.append(bone)
                continue
            rows.append(len(parents))
            above = _add(parents, rests, tails, above, at_rest[node], tail)
            owners.append(bone)
        reads.append((int(bones.pose_indices[bone]), tuple(nodes[bone])))
        before.append(np.broadcast_to(own, (len(nodes[bone]), 4, 4)))
        if bend.animated:
            moving.append(bendy.MovingRest(len(reads) - 1, bend.animated, bend.values))
        below = np.flatnonzero(bones.parents == bone)
        if len(below):
            ends[bone] = _add(parents, rests, tails, above, own, bones.tails[bone])
            owners.append(bone)
            for child in below:
                parents[child] = ends[bone]
    places = np.array(rows, np.intp)
    counts = [len(read[1]) for read in reads]
    at_rest = np.array([bends[bone].matrices[node] for bone in bends for node in nodes[bone]]).reshape(-1, 4, 4)
    whole = np.concatenate(before) if before else np.zeros((0, 4, 4))
    after = np.linalg.inv(whole @ at_rest)
    rest_matrices = np.array(rests)
    # Dual quaternions take the turns of rest matrices; nodes may be scaled.
    rest_matrices[places, :3, :3] /= np.linalg.norm(rest_matrices[places, :3, :3], axis=1, keepdims=True)
    return bones._replace(
        parents=np.array(parents, np.int32),
        rest_matrices=rest_matrices,
        tails=np.array(tails),
        bends=bendy.Bends(
            places,
            np.repeat(np.array(list(bends), np.intp), counts),
            tuple(reads),
            whole,
            after,
            np.array(list(ends.values()), np.intp),
            np.array(list(ends), np.intp),
            np.array(owners, np.intp),
            tuple(moving),
            {},
        ),
    )


def _add(
    parents: list[int],
    rests: list[NDArray[np.float64]],
    tails: list[NDArray[np.float64]],
    parent: int,
    rest: NDArray[np.float64],
    tail: NDArray[np.float64],
) -> int:
    parents.append(parent)
    rests.append(rest)
    tails.append(tail)
    return len(parents) - 1


def read_pose(rig: bpy.types.Object, bones: RestBones) -> NDArray[np.float32]:
    """(R, 4, 4) pose @ inverse(rest) of all rows, armature space; `rig`: evaluated.

    Raises PoseError where the armature has lost bones or has other segments than were bound.
    """
    columns = np.empty((len(rig.pose.bones), 4, 4), np.float32)
    rig.pose.bones.foreach_get("matrix_channel", columns.ravel())
    try:
        own = columns[bones.pose_indices].transpose(0, 2, 1)
        if bones.bends is None:
            return np.ascontiguousarray(own)
        matrices = np.empty((len(bones.parents), 4, 4), np.float32)
        matrices[: len(own)] = own
        bendy.pose_rows(rig, bones.bends, matrices)
    except IndexError:
        raise PoseError("Bones were removed from the armature: leave its edit mode, or press Rebind") from None
    except RuntimeError:
        raise PoseError("Segments of bendy bones are others than were bound: press Rebind") from None
    return matrices


# Of the bones, what a binding depends on: places, segments and envelopes.
_SIGNS = (
    ("matrix_local", np.float32, 16),
    ("bbone_segments", np.int32, 1),
    ("use_deform", bool, 1),
    ("use_envelope_multiply", bool, 1),
    ("head_radius", np.float32, 1),
    ("tail_radius", np.float32, 1),
    ("envelope_distance", np.float32, 1),
    ("envelope_weight", np.float32, 1),
)


def signature(armature: bpy.types.Armature) -> list[object]:
    """What of the bones a binding depends on; cheap, for posing updates the armature too."""
    bones = armature.bones
    found: dict[str, NDArray] = {}
    for name, kind, size in _SIGNS:
        found[name] = np.empty(len(bones) * size, kind)
        if len(bones):
            bones.foreach_get(name, found[name])
    parents = [bone.parent.name if bone.parent else None for bone in bones]
    bends = bendy.signature(armature) if (found["bbone_segments"] > 1).any() else []
    return [bones.keys(), parents, *(array.tobytes() for array in found.values()), *bends]
