"""The skins that are compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import turgor
from numpy.typing import NDArray

JointOf = Callable[[int], turgor.Joint]


def _law(preset: turgor.presets.PresetName = "flesh", **settings) -> JointOf:
    return lambda bone: turgor.presets.joint(preset, bone, flesh=1.0, **settings)


def _preset(name: turgor.presets.PresetName) -> JointOf:
    return lambda bone: turgor.presets.joint(name, bone)


# What Blender adds with the modifier: even fields, and a joint of these settings.
ADDED = "as added"

# How bones are blended, and the setting of each joint; None: the blend alone.
SKINS: Mapping[str, tuple[str, JointOf | None]] = {
    "linear": ("linear", None),
    "dual quaternions": ("dual_quaternion", None),
    **{name: ("linear", _preset(name)) for name in turgor.presets.DEFAULT_SHARES},
    ADDED: ("linear", _law(crease=0.7)),
    "law": ("linear", _law()),
    "law, isotropic": ("linear", _law("isotropic")),
    "law, bony": ("linear", _law(outside=0.0)),
    "law, no crease": ("linear", _law(crease=0.0)),
    "law on dual quaternions": ("dual_quaternion", _law()),
}


def skinned(data: Mapping[str, NDArray], weights: str, name: str) -> NDArray[np.float64]:
    """(N, 3) positions of an elastic case in its pose; weights: "auto", "simple"."""
    mode, joint = SKINS[name]
    matrix = data[f"weights_{weights}"].astype(float)
    rows, bones = np.nonzero(matrix > 1e-7)
    offsets = np.searchsorted(rows, np.arange(len(matrix) + 1)).astype(np.int32)
    skeleton = turgor.Skeleton(data["parents"], data["rest_matrices"])
    skinning = turgor.Skinning(skeleton, offsets, bones.astype(np.int32), matrix[rows, bones], mode)
    rest = data["rest"].astype(float)
    motions = data["pose_matrices"] @ np.linalg.inv(data["rest_matrices"])
    if joint is None:
        return skinning.deform(rest, motions)
    mesh = turgor.Mesh(rest, data["face_offsets"], data["face_corners"])
    joints = [joint(bone) for bone in range(len(data["heads"]))]
    fields = "even" if name == ADDED else "plain"
    return turgor.VolumeSkin(mesh, skinning, joints, fields=fields).deform(motions).positions
