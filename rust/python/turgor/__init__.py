"""Exact volume for skinned meshes, on numpy arrays.

Bind once, deform each frame::

    mesh = turgor.Mesh(rest_positions, face_offsets, face_corners)
    rig = turgor.Skeleton(parents, rest_matrices)
    skin = turgor.Skinning(rig, weight_offsets, weight_bones, weights)
    body = turgor.VolumeSkin(mesh, skin, [turgor.presets.muscle(bone=3)])
    frame = body.deform(pose_matrices)

Or bend points along a spine, every chunk of flesh keeping its volume::

    spine = turgor.Spine(rest_points)
    flesh = turgor.Fleshing(spine, positions, "radial")
    fleshed = flesh.deform(spine.posed(posed_points), twist=0.5)

Weights that do not fail, for any meshes about some bones::

    found = turgor.automatic_weights([(positions, face_offsets, face_corners)], bone_heads, bone_tails)
    skin = turgor.Skinning(rig, found.offsets, found.bones, found.weights)
"""

from . import presets
from ._native import (
    CancelledError,
    ClosestPoints,
    Component,
    FaultError,
    Fleshing,
    FleshingReport,
    Frame,
    Joint,
    JointField,
    Measures,
    Mesh,
    RefinementNeed,
    Report,
    Skeleton,
    Skinning,
    Spine,
    SpineFrames,
    TurgorError,
    Validity,
    VolumeSkin,
    Weights,
    __version__,
    automatic_weights,
    correct,
    flesh,
)

__all__ = [
    "CancelledError",
    "ClosestPoints",
    "Component",
    "FaultError",
    "Fleshing",
    "FleshingReport",
    "Frame",
    "Joint",
    "JointField",
    "Measures",
    "Mesh",
    "RefinementNeed",
    "Report",
    "Skeleton",
    "Skinning",
    "Spine",
    "SpineFrames",
    "TurgorError",
    "Validity",
    "VolumeSkin",
    "Weights",
    "__version__",
    "automatic_weights",
    "correct",
    "flesh",
    "presets",
]
