"""What holds for every binding: who may be written to, and when another mesh is accepted."""

from __future__ import annotations

import bpy

from ..logic import fingerprint
from ..scene import rest
from ..scene.obstacles import Obstacle


class BindError(ValueError):
    """Why the object cannot be bound, and what to do."""

    def __init__(self, obstacle: Obstacle) -> None:
        super().__init__(obstacle.text)
        self.obstacle = obstacle


def is_editable(ob: bpy.types.Object) -> bool:
    """Local, or a library override: what is written will be saved."""
    return ob.library is None


def check_topology(settings: bpy.types.PropertyGroup, read: rest.RestMesh, *, accept: bool) -> None:
    """Refuses another mesh than was bound, unless the artist accepts it; remembers the first in `settings`."""
    found = fingerprint.fingerprint([read.face_offsets, read.face_corners], len(read.positions))
    saved = settings.bound_topology
    if found == saved:
        return
    if saved and not accept:
        text = "Mesh changed: its vertices or faces are others than when it was bound; press Rebind"
        raise BindError(Obstacle("stale_binding", text, "REBIND"))
    if is_editable(settings.id_data):
        settings.bound_topology = found
