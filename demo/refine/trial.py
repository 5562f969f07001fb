"""One character, played on its coarse mesh and on refined ones, and measured without the engine."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ..enclosed_volume import Indices, Points, shells
from ..evaluated import faces, positions
from ..live import must_turn_on
from .subjects import Subject

COARSE, LINEAR, SMOOTH = "coarse", "linear", "smooth"
WAYS = (COARSE, LINEAR, SMOOTH)


@dataclass(frozen=True)
class Posed:
    """The pictured frame, world space: the mesh as it is shown, and the joint it is about."""

    points: Points
    sizes: Indices
    corners: Indices
    centre: Points | None


@dataclass(frozen=True)
class Result:
    """Relative to the size of the coarse mesh at rest, the diagonal of its box, and to its volume."""

    vertices: int
    faces: int
    most_corners: int
    is_watertight: bool
    # How far vertices of the coarse mesh moved at rest, and by how much its volume changed.
    rest_moved: float
    rest_volume_change: float
    # Over all frames, against the mesh's own rest.
    volume_error: float
    # The farthest that any vertex goes from a frame to the next, over that of the coarse mesh.
    step: float


def play(subject: Subject, way: str) -> tuple[Result, Posed]:
    """In a file of its own. The step is in object space; who compares divides."""
    # Not the factory settings: they would turn the extension off.
    bpy.ops.wm.read_homefile(use_empty=True)
    character = subject.make()
    body = character.body
    coarse, coarse_faces = positions_of(body.data), faces(body)
    size = float(np.linalg.norm(np.ptp(coarse, axis=0)))
    coarse_volume = np.abs(shells(coarse, *coarse_faces).volumes(coarse)).sum()
    must_turn_on(body, subject.name)
    # Narrow fields, which need more faces than there are.
    body.turgor.fields = "PLAIN"
    for joint in body.turgor.joints:
        joint.preset = subject.presets.get(joint.name, joint.preset)
    if way != COARSE:
        bpy.ops.object.turgor_refine(threshold=subject.threshold, levels=3, use_automatic=True, method=way.upper())
    rest, topology = positions_of(body.data), faces(body)
    parts = shells(rest, *topology)
    rest_volumes = parts.volumes(rest)
    scene = bpy.context.scene
    error, step, last = 0.0, 0.0, None
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        shown = positions(body)
        error = max(error, float(np.abs(parts.volumes(shown) / rest_volumes - 1.0).max()))
        if last is not None:
            step = max(step, float(np.linalg.norm(shown - last, axis=1).max()))
        last = shown
    result = Result(
        vertices=len(rest),
        faces=len(topology[0]),
        most_corners=int(topology[0].max()),
        is_watertight=not parts.is_open.any(),
        rest_moved=float(np.linalg.norm(rest[: len(coarse)] - coarse, axis=1).max()) / size,
        rest_volume_change=float(np.abs(rest_volumes).sum() / coarse_volume - 1.0),
        volume_error=error,
        step=step,
    )
    scene.frame_set(subject.frame)
    world = np.array(body.matrix_world)
    placed = positions(body) @ world[:3, :3].T + world[:3, 3]
    centre = None
    if subject.about is not None:
        centre = np.array(character.armature.matrix_world @ character.armature.pose.bones[subject.about].head)
    return result, Posed(placed, *topology, centre)


def positions_of(mesh: bpy.types.Mesh) -> Points:
    """(N, 3) as stored."""
    values = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", values.ravel())
    return values.astype(np.float64)
