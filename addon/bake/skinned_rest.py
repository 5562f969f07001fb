"""The skinning that corrective keys are made for: that of the character's Armature, or what a target engine keeps."""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from ..logic import inverse_skinning, weights
from ..scene import rest, skeleton
from .options import BakeError


class Posed(NamedTuple):
    """One frame of an armature."""

    matrices: NDArray[np.float32]  # (B, 4, 4) pose @ inverse(rest) of `skeleton.read_bones`
    object_from_armature: NDArray[np.float64]  # (4, 4)
    shape_values: NDArray[np.float32]  # (K,)


class PosedSkin(NamedTuple):
    """A target's skinning, and the bones that it takes."""

    skin: inverse_skinning.TargetSkin
    bones: skeleton.RestBones
    weights: weights.BoneWeights

    def maps(self, posed: Posed) -> inverse_skinning.Maps:
        """The affine maps by which this skinning moves each vertex in one frame."""
        return self.skin.maps(posed.matrices, posed.object_from_armature)


def skin_of(
    target: bpy.types.Object,
    armature: bpy.types.ArmatureModifier,
    read: rest.RestMesh,
    *,
    influences: int = 0,
    use_linear: bool = False,
) -> PosedSkin:
    """influences: the largest of each vertex, 0 for all. use_linear: also where the Armature does not."""
    group_names = [group.name for group in target.vertex_groups]
    bones = skeleton.read_bones(armature.object, group_names)
    deform = {name: index for index, name in enumerate(bones.names) if bones.is_deform[index]}
    if not deform:
        raise BakeError(f"No vertex group of {target.name} is named after a deform bone: assign weights")
    groups = (read.weight_offsets, read.weight_groups, read.weights)
    kept = weights.bone_weights(*groups, group_names, deform)
    if influences:
        kept = inverse_skinning.largest_influences(kept, influences)
    mask = None
    if armature.vertex_group in group_names:
        mask = weights.vertex_mask(*groups, group_names.index(armature.vertex_group), armature.invert_vertex_group)
    is_dual = armature.use_deform_preserve_volume and not use_linear
    mode = "dual_quaternion" if is_dual else "linear"
    skin = inverse_skinning.TargetSkin(bones.parents, bones.rest_matrices, kept, mode=mode, vertex_mask=mask)
    return PosedSkin(skin, bones, kept)
