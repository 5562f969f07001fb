"""The skinning that corrective keys are made for: that of the character's Armature, or what a target engine keeps."""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from ..live import skin
from ..logic import inverse_skinning, weights
from ..scene import frame as scene_frame
from ..scene import rest, skeleton
from .options import BakeError


class Posed(NamedTuple):
    """One frame of an armature."""

    matrices: NDArray[np.float32]  # (R, 4, 4) `skeleton.read_pose` of the bound bones
    plain: NDArray[np.float32]  # (B, 4, 4) the same where no bone bends
    object_from_armature: NDArray[np.float64]  # (4, 4)
    shape_values: NDArray[np.float32]  # (K,)


class PosedSkin(NamedTuple):
    """A target's skinning, and the bones that it takes."""

    skin: inverse_skinning.TargetSkin
    bones: skeleton.RestBones
    weights: weights.BoneWeights
    is_other: bool  # not what Blender plays with the character's armature: bones are plain

    def maps(self, posed: Posed) -> inverse_skinning.Maps:
        """The affine maps by which this skinning moves each vertex in one frame."""
        matrices = posed.matrices if self.bones.bends is not None else posed.plain
        return self.skin.maps(matrices, posed.object_from_armature)


def posed_of(rig: bpy.types.Object, bones: skeleton.RestBones, inputs: scene_frame.FrameInputs) -> Posed:
    """`rig`: evaluated; bones as bound, inputs as read by them."""
    plain = inputs.pose_matrices
    if bones.bends is not None:
        plain = skeleton.read_pose(rig, bones._replace(bends=None))
    return Posed(inputs.pose_matrices, plain, inputs.object_from_armature, inputs.shape_values)


def skin_of(
    target: bpy.types.Object,
    armature: bpy.types.ArmatureModifier,
    read: rest.RestMesh,
    object_from_armature: NDArray[np.float64],
    frame: int,
    *,
    influences: int = 0,
    use_linear: bool = False,
) -> PosedSkin:
    """object_from_armature: where it was bound, at `frame`. influences: the largest of each vertex, 0 for all.

    use_linear: also where the Armature does not; such engines know no bendy bones either.
    """
    group_names = [group.name for group in target.vertex_groups]
    is_plain = use_linear or influences > 0
    found = skin.read_skin(read, group_names, armature, object_from_armature, frame, is_plain=is_plain)
    bones, kept = found.bones, found.weights
    if not len(bones.names):
        raise BakeError(f"No vertex group of {target.name} is named after a deform bone: assign weights")
    if influences:
        kept = inverse_skinning.largest_influences(kept, influences)
    is_dual = armature.use_deform_preserve_volume and not use_linear
    made = inverse_skinning.TargetSkin(
        bones.parents,
        bones.rest_matrices,
        kept,
        mode="dual_quaternion" if is_dual else "linear",
        vertex_mask=found.mask,
    )
    return PosedSkin(made, bones, kept, is_plain and found.is_placed)
