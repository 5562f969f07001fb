"""What an Armature modifier skins a mesh by: bones, the nodes of bendy ones, and the weights of all vertices.

Weights of envelopes and of nodes follow from where vertices lie at rest. They are made once, when a character is bound;
what would change them from frame to frame is looked for here too.
"""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from ..logic import envelopes, node_weights, weights
from ..logic.weights import BoneWeights
from ..messages import Message, message
from ..scene import bendy, obstacles, placement, rest, skeleton
from .binding_rules import BindError

# Weights of nodes and envelopes that change by less stay what they are.
STILL_WEIGHT = 1e-6
# Bones and nodes that the engine takes.
MOST_ROWS = 32_000


class Skin(NamedTuple):
    """What the Armature modifier goes by."""

    bones: skeleton.RestBones
    weights: BoneWeights  # of its rows
    mask: NDArray[np.float32] | None  # (N,) its own vertex group
    is_placed: bool  # weights depend on where the mesh stands to the armature: by bendy bones or envelopes
    moving: str  # what moves weights from frame to frame; empty where nothing does
    turning: str = ""  # bone of this skin whose curve at rest is animated; empty without one


def read_skin(
    read: rest.RestMesh,
    group_names: list[str],
    armature: bpy.types.ArmatureModifier | None,
    object_from_armature: NDArray[np.float64],
    frame: int,
    *,
    is_plain: bool = False,
) -> Skin:
    """object_from_armature: where the mesh was bound, at `frame`. is_plain: as engines that know no bendy bones.

    armature: None where no bones pose the mesh.
    """
    if armature is None or armature.object is None:
        none = BoneWeights(np.zeros(len(read.positions) + 1, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32))
        return Skin(skeleton.NO_BONES, none, None, False, "")
    rig = armature.object
    use_envelopes, use_groups = armature.use_bone_envelopes, armature.use_vertex_groups
    bones = skeleton.read_bones(rig, None if use_envelopes else group_names if use_groups else ())
    groups = (read.weight_offsets, read.weight_groups, read.weights)
    mask = None
    if armature.vertex_group in group_names:
        mask = weights.vertex_mask(*groups, group_names.index(armature.vertex_group), armature.invert_vertex_group)
    deform = {name: index for index, name in enumerate(bones.names) if bones.is_deform[index]}
    of_groups = weights.bone_weights(*groups, group_names if use_groups else [], deform)
    if not len(bones.names):
        return Skin(bones, of_groups, mask, False, "")
    made = _Placed(rig, bones, of_groups, use_envelopes)
    if not made.is_any:
        return Skin(bones, of_groups, mask, False, "")
    if np.linalg.det(object_from_armature) == 0.0:
        raise placement.PlacementError(placement.NO_INVERSE)
    armature_from_object = np.linalg.inv(object_from_armature)
    points = _moved(read.positions, armature_from_object)
    if is_plain:
        return Skin(bones, made.enveloped(points), mask, True, "")
    with bendy.rest_pose(rig, frame) as posed:
        held = made.enveloped(points)
        bends = {
            bone: posed.read(bones.names[bone])
            for bone in np.unique(held.bones[held.weights != 0.0]).tolist()
            if made.segments[bone] > 1
        }
        animated = [bone for bone, bend in bends.items() if bend.animated]
        moving = _moving_rest(bones, bends) or _moving_key(
            read, armature, made, posed, bends, points, armature_from_object
        )
        if not bends:
            return Skin(bones, held, mask, True, moving)
        split = made.split(held, points, posed, bends)
    nodes = {bone: split.used_nodes(bone) for bone in bends}
    try:
        bent = skeleton.bent(bones, bends, nodes)
    except np.linalg.LinAlgError:
        text = message(
            "Segments of {rig} are scaled to nothing at rest: give its bendy bones another scale", rig=rig.name
        )
        raise BindError(obstacles.Obstacle("flat_segments", text)) from None
    rows = np.tile(np.arange(len(bones.names))[:, None], (1, 1 + max(bend.segments for bend in bends.values())))
    assert bent.bends is not None
    of_nodes = [node for _, bone_nodes in bent.bends.reads for node in bone_nodes]
    rows[bent.bends.bones, of_nodes] = bent.bends.rows
    return Skin(bent, split.on_rows(rows), mask, True, moving, bones.names[animated[0]] if animated else "")


def check(skinned: Skin, armature: bpy.types.ArmatureModifier, *, is_evaluated: bool) -> None:
    """Raises BindError where the armature has too many bones for this mesh, or none.

    is_evaluated: Blender evaluates the stack for us, and something else may pose the mesh.
    """
    rig, rows = armature.object.name, len(skinned.bones.parents)
    if not rows and not is_evaluated:
        text = message("No vertex group is named after a deform bone of {rig}: assign weights", rig=rig)
        if not armature.use_vertex_groups:
            text = message(
                "{modifier} deforms neither by vertex groups nor by bones with envelopes: turn on Vertex Groups",
                modifier=armature.name,
            )
        raise BindError(obstacles.Obstacle("no_deform_groups", text))
    if rows > MOST_ROWS:
        text = message(
            "{rig} moves this mesh by {count:,} bones and segments, {most:,} are possible: lower segments of bones",
            rig=rig,
            count=rows,
            most=MOST_ROWS,
        )
        raise BindError(obstacles.Obstacle("too_many_bones", text))


def check_still(skinned: Skin) -> None:
    """Raises BindError where weights change from frame to frame, for what skins by those of the bound mesh."""
    if skinned.moving:
        text = message(
            "{what} moves skin along bendy bones or through envelopes, whose weights then change from frame to frame:"
            " let it move other skin only, or set the bones' segments to 1",
            what=skinned.moving,
        )
        raise BindError(obstacles.Obstacle("moving_weights", text))


def moving_weights(skinned: Skin) -> Message:
    """Why weights change from frame to frame: the engine's own are those of the bound mesh."""
    return message("{what} moves skin along bendy bones or through envelopes", what=skinned.moving)


class _Placed:
    """Weights by the places of vertices in armature space."""

    def __init__(
        self, rig: bpy.types.Object, bones: skeleton.RestBones, of_groups: BoneWeights, use_envelopes: bool
    ) -> None:
        self._bones, self._of_groups = bones, of_groups
        self._envelopes = skeleton.read_envelopes(rig, bones)
        self._is_free = (np.diff(of_groups.offsets) == 0) & use_envelopes
        multiplied = self._envelopes.is_multiplied & bones.is_deform
        self.has_envelopes = bool(self._is_free.any() or multiplied[of_groups.bones].any())
        segments = [rig.data.bones[name].bbone_segments for name in bones.names]
        self.segments = np.array(segments, np.int32)
        self.is_any = self.has_envelopes or bool((self.segments[bones.is_deform] > 1).any())

    def enveloped(self, points: NDArray[np.float64]) -> BoneWeights:
        """Weights of bones with the mesh at points, (N, 3)."""
        if not self.has_envelopes:
            return self._of_groups
        own = self._envelopes
        factors = np.zeros((len(points), len(self._bones.names)))
        for bone in np.flatnonzero(self._bones.is_deform):
            factors[:, bone] = envelopes.factors(points, *(part[bone] for part in own[:5]))
        return envelopes.weigh(self._of_groups, self._is_free, factors, own.is_multiplied, own.weights)

    def coordinates(
        self,
        held: BoneWeights,
        points: NDArray[np.float64],
        posed: bendy.RestPose,
        bends: dict[int, bendy.RestBend],
    ) -> NDArray[np.float64]:
        """(W,) along the bones that bend, 0 elsewhere."""
        vertices = np.repeat(np.arange(len(points)), np.diff(held.offsets))
        found = np.zeros(len(vertices))
        for bone, bend in bends.items():
            is_own = held.bones == bone
            found[is_own] = posed.node_coordinates(self._bones.names[bone], bend, points[vertices[is_own]])
        return found

    def split(
        self,
        held: BoneWeights,
        points: NDArray[np.float64],
        posed: bendy.RestPose,
        bends: dict[int, bendy.RestBend],
    ) -> node_weights.NodeWeights:
        """Weights of nodes."""
        segments = np.ones_like(self.segments)
        for bone, bend in bends.items():
            segments[bone] = bend.segments
        return node_weights.split(held, self.coordinates(held, points, posed, bends), segments)


def _moving_rest(bones: skeleton.RestBones, bends: dict[int, bendy.RestBend]) -> str:
    for bone, bend in bends.items():
        if bend.animated and bend.is_curved_mapping:
            return message("Bone {bone}, whose curve at rest is animated,", bone=bones.names[bone])
    return ""


def _moving_key(
    read: rest.RestMesh,
    armature: bpy.types.ArmatureModifier,
    made: _Placed,
    posed: bendy.RestPose,
    bends: dict[int, bendy.RestBend],
    points: NDArray[np.float64],
    armature_from_object: NDArray[np.float64],
) -> str:
    """The shape key that slides skin along bendy bones, or through envelopes."""
    if not len(read.shape_deltas):
        return ""
    keys = armature.id_data.data.shape_keys.key_blocks[1:]
    for key, deltas in zip(keys, read.shape_deltas, strict=True):
        most = max(abs(key.slider_min), abs(key.slider_max))
        moved = np.flatnonzero(np.any(deltas != 0.0, axis=1))
        if not len(moved) or most == 0.0:
            continue
        places = points.copy()
        places[moved] += most * deltas[moved] @ armature_from_object[:3, :3].T
        before, after = made.enveloped(points), made.enveloped(places)
        if before.bones.tolist() != after.bones.tolist() or before.offsets.tolist() != after.offsets.tolist():
            return message("Shape key {key}", key=key.name)
        change = np.abs(after.weights.astype(np.float64) - before.weights)
        along = made.coordinates(before, places, posed, bends) - made.coordinates(before, points, posed, bends)
        change += np.abs(along) * before.weights
        if change.max(initial=0.0) > STILL_WEIGHT:
            return message("Shape key {key}", key=key.name)
    return ""


def _moved(points: NDArray[np.floating], matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    return points.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
