"""Poses of a character over many frames, evaluated apart from the artist's scene.

A copy of the scene holds nothing but a stand-in that needs the rig, the character's place and its shape keys. Blender
evaluates those for it, and no mesh. Its dependency graph is never the active one, so nothing is written back: current
frame, poses without keys and values that an artist changed by hand stay as they are, and nothing is tagged.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from math import floor
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from . import carrier, drivers, frame, scene_drivers, skeleton, stack_proof, twin

# Handlers of any extension would be told of a scene that is not the artist's.
EVENTS = ("frame_change_pre", "frame_change_post", "depsgraph_update_pre", "depsgraph_update_post")


class PoseSamples(NamedTuple):
    """F frames, R rows of bones and nodes, K shape keys; as in `frame.FrameInputs`."""

    frames: NDArray[np.float64]  # (F,)
    pose_matrices: NDArray[np.float32]  # (F, R, 4, 4)
    object_from_armature: NDArray[np.float64]  # (F, 4, 4)
    shape_values: NDArray[np.float32]  # (F, K)


def sample_poses(target: bpy.types.Object, frames: Sequence[float], bones: skeleton.RestBones) -> PoseSamples:
    """The character's poses at these frames of its scene, sub-frames too; its bones as they were bound."""
    read = [frame.read_frame(evaluated, bones) for evaluated in evaluated_apart(target, frames)]
    return PoseSamples(np.asarray(frames, np.float64), *(np.stack(rows) for rows in zip(*read, strict=True)))


def evaluated_apart(target: bpy.types.Object, frames: Iterable[float]) -> Iterator[bpy.types.Object]:
    """The character evaluated at each frame: its place, settings, pose and values of shape keys, but not its mesh.

    Each is to be read before the next is asked for. Raises frame.FrameError without an armature, and
    scene_drivers.SceneDriverError.
    """
    rig = frame.rig_of(target)
    holder = carrier.carrier_of(target)
    twins = [] if holder is None else [each for part in twin.PARTS if (each := twin.of_carrier(holder, part))]
    sources = [*drivers.character_sources(target, rig), *map(drivers.geometry_source, twins)]
    return evaluated_after(target, frames, rig, sources)


def evaluated_after(
    target: bpy.types.Object, frames: Iterable[float], rig: bpy.types.Object | None, sources: Iterable[drivers.Source]
) -> Iterator[bpy.types.Object]:
    """The object evaluated at each frame like by `evaluated_apart`, with all bones of `rig` and what `sources` name."""
    needed = list(sources)
    roots = [target, *(source.owner for source in needed)]
    scene_drivers.check(bpy.context.scene, roots if rig is None else [rig, *roots])
    with _stand_in(rig, needed) as (scene, depsgraph):
        for number in frames:
            whole = floor(number)
            scene.frame_set(whole, subframe=number - whole)
            yield target.evaluated_get(depsgraph)


@contextmanager
def scene_apart() -> Iterator[bpy.types.Scene]:
    """A copy of the scene without its objects: frames may be set in it, and nobody is told."""
    with stack_proof.handlers_put_aside(), _without_handlers():
        scene = bpy.context.scene.copy()
        try:
            _empty(scene)
            yield scene
        finally:
            bpy.data.scenes.remove(scene)


@contextmanager
def _stand_in(
    rig: bpy.types.Object | None, sources: Iterable[drivers.Source]
) -> Iterator[tuple[bpy.types.Scene, bpy.types.Depsgraph]]:
    with scene_apart() as scene:
        mesh = bpy.data.meshes.new("Turgor Sample")
        stand_in = bpy.data.objects.new(mesh.name, mesh)
        try:
            scene.collection.objects.link(stand_in)
            _need(stand_in, rig, sources)
            scene.frame_set(scene.frame_current)
            yield scene, scene.view_layers[0].depsgraph
        finally:
            bpy.data.objects.remove(stand_in)
            bpy.data.meshes.remove(mesh)


def _empty(scene: bpy.types.Scene) -> None:
    for collection in list(scene.collection.children):
        scene.collection.children.unlink(collection)
    for ob in list(scene.collection.objects):
        scene.collection.objects.unlink(ob)
    for view_layer in list(scene.view_layers)[1:]:
        scene.view_layers.remove(view_layer)


def _need(stand_in: bpy.types.Object, rig: bpy.types.Object | None, sources: Iterable[drivers.Source]) -> None:
    modifier = stand_in.modifiers.new("Pose", "ARMATURE")
    modifier.object = rig
    # By vertex groups only their bones would be evaluated.
    modifier.use_bone_envelopes = True
    drivers.write_reader(stand_in, f'modifiers["{modifier.name}"].show_on_cage', sources)


@contextmanager
def _without_handlers() -> Iterator[None]:
    lists = [getattr(bpy.app.handlers, event) for event in EVENTS]
    kept = [list(handlers) for handlers in lists]
    for handlers in lists:
        handlers.clear()
    try:
        yield
    finally:
        for handlers, before in zip(lists, kept, strict=True):
            handlers[:] = before
