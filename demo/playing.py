"""Plays a character and follows the volume of every mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import bpy

from .enclosed_volume import Points, Shells
from .evaluated import positions, undeformed_shells
from .takes import Take, played

Meshes = list[bpy.types.Object]


@dataclass
class Track:
    """One mesh: its shells, their volumes at rest (K,) and over the frames of one playing, (F, K)."""

    mesh_object: bpy.types.Object
    shells: Shells
    rest_volumes: Points
    volumes: list[Points] = field(default_factory=list)


def at_rest(meshes: Meshes, armatures: Meshes) -> list[Track]:
    """The meshes with their armatures in rest position, nothing played yet."""
    shells = [undeformed_shells(mesh_object) for mesh_object in meshes]
    for armature in armatures:
        armature.data.pose_position = "REST"
    bpy.context.view_layer.update()
    volumes = [one.volumes(positions(mesh_object)) for one, mesh_object in zip(shells, meshes, strict=True)]
    for armature in armatures:
        armature.data.pose_position = "POSE"
    bpy.context.view_layer.update()
    return [Track(*parts) for parts in zip(meshes, shells, volumes, strict=True)]


def play(tracks: list[Track], takes: list[Take], after_frame: Callable[[], None] = lambda: None) -> None:
    """Measures every mesh anew on every frame; `after_frame` is called when a frame has been measured."""
    for track in tracks:
        track.volumes.clear()
    for _ in played(takes):
        for track in tracks:
            track.volumes.append(track.shells.volumes(positions(track.mesh_object)))
        after_frame()
