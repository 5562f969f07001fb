"""Exact volume for skinned meshes, on numpy arrays.

Bind once, deform each frame::

    mesh = turgor.Mesh(rest_positions, face_offsets, face_corners)
    rig = turgor.Skeleton(parents, rest_matrices)
    skin = turgor.Skinning(rig, weight_offsets, weight_bones, weights)
    body = turgor.VolumeSkin(mesh, skin, [turgor.presets.muscle(bone=3)])
    frame = body.deform(pose_matrices)
"""

from . import presets
from ._native import (
    Component,
    Frame,
    Joint,
    Mesh,
    Report,
    Skeleton,
    Skinning,
    TurgorError,
    VolumeSkin,
    __version__,
    correct,
)

__all__ = [
    "Component",
    "Frame",
    "Joint",
    "Mesh",
    "Report",
    "Skeleton",
    "Skinning",
    "TurgorError",
    "VolumeSkin",
    "__version__",
    "correct",
    "presets",
]
