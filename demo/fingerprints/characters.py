"""Plays the characters of a file under several settings and digests each frame's mesh."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import blake2b
from pathlib import Path

import bpy
import numpy as np

from ..characters import open_file, skinned_meshes
from ..evaluated import positions
from ..live import turn_on

DIGEST_BYTES = 12


def _as_added(_: bpy.types.Object) -> None:
    pass


def _muscles(mesh_object: bpy.types.Object) -> None:
    for joint in mesh_object.turgor.joints:
        joint.preset = "MUSCLE"


def _folds_in_order(mesh_object: bpy.types.Object) -> None:
    mesh_object.turgor.solver = "SEQUENTIAL"
    for joint in mesh_object.turgor.joints:
        joint.preset = "FOLDS"


SETTINGS: dict[str, Callable[[bpy.types.Object], None]] = {
    "as added": _as_added,
    "muscle": _muscles,
    "folds, sequential": _folds_in_order,
}


def print_fingerprints(file: Path, frame_count: int) -> None:
    """A line for each mesh and each of `SETTINGS`; a mesh that cannot be corrected says why."""
    open_file(file)
    for name in [mesh_object.name for mesh_object in skinned_meshes()]:
        problem = turn_on(bpy.data.objects[name])
        if problem is not None:
            print(f"{'-':24}  {file.name}  {name}  {problem}", flush=True)
            continue
        for settings, choose in SETTINGS.items():
            choose(bpy.data.objects[name])
            print(f"{_fingerprint(name, frame_count)}  {file.name}  {name}  {settings}", flush=True)


def _fingerprint(name: str, frame_count: int) -> str:
    scene = bpy.context.scene
    digest = blake2b(digest_size=DIGEST_BYTES)
    for frame in np.unique(np.linspace(scene.frame_start, scene.frame_end, frame_count).round().astype(int)):
        scene.frame_set(int(frame))
        digest.update(positions(bpy.data.objects[name]).astype(np.float32).tobytes())
    return digest.hexdigest()
