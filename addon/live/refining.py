"""More faces where joints give volume back: what the motion asks for, the preview, and the mesh itself.

A mesh is refined once, for its whole motion and at rest: frames only ever see the denser mesh. On the main thread only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import bpy
import numpy as np
import turgor

from .. import runtime
from ..logic import fingerprint
from ..logic.polygons import Faces
from ..logic.refined_faces import Split
from ..logic.refined_region import MotionNeed, Need, Options, Region, surface
from ..logic.refinement import Refinement
from ..messages import message
from ..scene import face_origins, refined_mesh, settings, spine_stack, stack
from ..states import VolumeBinding
from . import binding, engines, sampling, spine_binding, strokes
from .sampling import Sample

# After a setting was changed.
SECONDS_TO_REST = 0.3
# Of looking at a mesh again that has more vertices to see folds with; two or three are usual.
MOST_ROUNDS = 8


class RefineError(ValueError):
    """Why the mesh is not refined, and what to do."""


class Made(NamedTuple):
    """What became of a mesh."""

    face_count: int  # of those before, split into quads all over
    all_face_count: int  # before
    vertex_count: int  # afterwards
    short_count: int  # faces afterwards that ask for more levels than they may have


def find(target: bpy.types.Object, tell: Callable[[int], None] = lambda done: None) -> MotionNeed:
    """Look at the motion, and keep what it asks for. tell: is told how many frames are done.

    Raises ValueError where the character is not bound or a frame cannot be read.
    """
    bound = sampling.bound(target)
    watched = sampling.Watched(sampling.samples(target, bound, frames(target), tell))
    samples = list(watched)
    if not watched.has_moved:
        samples = list(sampling.turned(target, bound))
    character = runtime.character(target.session_uid)
    state, motion = _state(target, bound), _fingerprint(samples)
    before = character.refinement
    if before is not None and (before.state, before.motion) == (state, motion):
        return before
    character.refinement = found = MotionNeed(state, motion, _need(target, bound, samples), {})
    return found


def frames(target: bpy.types.Object) -> list[int]:
    """Frames of the scene at which the motion is looked at."""
    return sampling.quick_frames(target, sampling.scene_frames(bpy.context.scene))


def look(ob: bpy.types.Object) -> Region | None:
    """What the preview shows of the object; None while it is off, or nothing was found yet. For draw callbacks."""
    if not strokes.CAN_WAIT and _is_due(ob):
        # Nothing is drawn without a window: a farm does not look at motions for the preview's sake.
        refresh(ob)
    character = runtime.session.characters.get(ob.session_uid)
    saved = ob.turgor.refine
    if character is None or character.refinement is None or character.binding is None or not saved.show_preview:
        return None
    found = character.refinement
    if len(found.need.bound_positions) != character.binding.body.vertex_count:
        return None
    return found.region(options_of(saved))


def options_of(saved: bpy.types.PropertyGroup) -> Options:
    """saved: the character's settings, or an operator with the same ones."""
    return Options(saved.threshold, saved.levels, saved.use_automatic, saved.method == "SMOOTH")


def follow(target: bpy.types.Object) -> None:
    """Find again, a little later, what an edit may have changed; only while it is previewed."""
    if strokes.CAN_WAIT and _is_due(target):
        strokes.when_quiet(target.session_uid, "refine", refresh, SECONDS_TO_REST)


def _is_due(target: bpy.types.Object) -> bool:
    character = runtime.session.characters.get(target.session_uid)
    if character is None or character.binding is None or not target.turgor.refine.show_preview:
        return False
    return character.refinement is None or character.refinement.state != _state(target, character.binding)


def refresh(target: bpy.types.Object) -> None:
    """Find again for the preview; without a motion that can be read there is none."""
    character = runtime.character(target.session_uid)
    try:
        find(target)
    except ValueError as error:
        character.refinement = None
        runtime.log.warning("%s: no preview: %s", target.name, error)
    # It may come long after the edit that asked for it.
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"VIEW_3D", "PROPERTIES"}:
                area.tag_redraw()


def refine(target: bpy.types.Object, options: Options, tell: Callable[[int], None] = lambda done: None) -> Made:
    """Split faces of the mesh itself, and bind anew all that show it. With nothing to split nothing is touched.

    Automatic levels look at the motion of the denser mesh again, until none of its faces asks for more.

    Raises RefineError, or ValueError as `find`.
    """
    mesh = target.data
    _check(target)
    # An edit that nothing was evaluated after is followed now.
    bpy.context.view_layer.update()
    region = find(target, tell).region(options)
    origins = np.arange(region.all_face_count)
    used, is_refined = np.zeros(len(origins), np.int32), np.zeros(len(origins), bool)
    for _ in range(MOST_ROUNDS if options.is_automatic else 1):
        made = region.refinement
        if not made.splits:
            break
        _write(mesh, made, options)
        is_refined[origins[made.levels > 0]] = True
        used, origins = (used + made.levels)[made.parents], origins[made.parents]
        if options.is_automatic:
            bpy.context.view_layer.update()
            try:
                region = Region(find(target, tell).need, options, used)
            except ValueError as error:
                # The mesh is refined all the same; an error would leave it without a step of undo.
                runtime.log.warning("%s: not looked at again: %s", target.name, error)
                break
    short_count = region.short_count if options.is_automatic else 0
    return Made(int(is_refined.sum()), len(is_refined), len(mesh.vertices), short_count)


def _write(mesh: bpy.types.Mesh, made: Refinement, options: Options) -> None:
    positions = refined_mesh.read_surface(mesh).positions
    keys = refined_mesh.read_key_positions(mesh)
    place = made.vertices
    if options.is_smooth:
        place = partial(made.smoothed, keeps_vertices=not _is_subdivided(mesh))
    key_positions = np.array([place(row) for row in keys]).reshape(len(keys), made.vertex_count, 3)
    offsets, corners = made.faces
    with runtime.quiet():
        try:
            refined_mesh.write(
                mesh,
                [_level(split) for split in made.splits],
                refined_mesh.NewFaces(offsets, corners, made.parents, made.is_new, made.corner_origins),
                place(positions),
                key_positions,
                made.corners,
            )
        except refined_mesh.DoubledFaceError as error:
            raise RefineError("Two faces have the same vertices: merge vertices by distance, or delete one") from error
    for user in _users(mesh):
        _bind(user)


def loose_modifiers(mesh: bpy.types.Mesh) -> list[str]:
    """Modifiers that were bound to the vertices as they were."""
    return sorted({item.name for user in _users(mesh) for item in user.modifiers if getattr(item, "is_bound", False)})


def _check(target: bpy.types.Object) -> None:
    mesh = target.data
    if mesh.library is not None:
        raise RefineError("The mesh is linked: refine it in its own file")
    if mesh.is_editmode:
        raise RefineError("The mesh is in Edit Mode: leave it first")
    for user in _users(mesh):
        if any(modifier.type == "MULTIRES" for modifier in user.modifiers):
            raise RefineError(
                message(
                    "{object} has a Multiresolution modifier: apply it, or refine before sculpting", object=user.name
                )
            )


def _is_subdivided(mesh: bpy.types.Mesh) -> bool:
    """Whether a smooth surface is seen that vertices only control: then that is what has to stay."""
    return any(
        modifier.type == "SUBSURF" and modifier.subdivision_type == "CATMULL_CLARK"
        for user in _users(mesh)
        for modifier in user.modifiers
    )


def _users(mesh: bpy.types.Mesh) -> list[bpy.types.Object]:
    return [ob for ob in bpy.data.objects if ob.data == mesh]


def _bind(target: bpy.types.Object) -> None:
    """Bind a refined mesh again, with the placement that was bound before."""
    if spine_stack.spine_modifier(target) is not None:
        spine_binding.bind(target, accept_topology=True)
    if stack.volume_modifier(target) is not None:
        runtime.character(target.session_uid).binding = None
        binding.bind(target, accept_topology=True)


def _state(target: bpy.types.Object, bound: VolumeBinding) -> object:
    mask = bound.body.mask
    saved = settings.read_settings(target)
    return (
        bound.content,
        None if mask is None else mask.tobytes(),
        engines.settings_key(saved, bound),
        saved.target_volume,
        tuple(sampling.scene_frames(bpy.context.scene)),
    )


def _fingerprint(samples: Sequence[Sample]) -> str:
    arrays = [
        array
        for sample in samples
        for array in (
            sample.pose_matrices,
            sample.strengths,
            sample.object_from_armature,
            sample.shape_values,
            np.zeros(0, np.float32) if sample.moved is None else sample.moved,
            np.zeros(0, np.float32) if sample.rest_positions is None else sample.rest_positions,
        )
    ]
    return fingerprint.fingerprint(arrays, [sample.target_scale for sample in samples])


def _need(target: bpy.types.Object, bound: VolumeBinding, samples: Sequence[Sample]) -> Need:
    count = bound.body.vertex_count
    gamma, edge_lengths = np.zeros(count, np.float32), np.full(count, np.inf, np.float32)
    for batch in sampling.batches(samples):
        need = _of_batch(batch, bound)
        gamma, edge_lengths = np.maximum(gamma, need.gamma), np.minimum(edge_lengths, need.edge_lengths)
    geometry = bound.body.rest
    faces = Faces(geometry.face_offsets, geometry.face_corners)
    read = refined_mesh.read_surface(target.data)
    origins = face_origins.face_origins(target, stack.body_end(target), target.turgor.bound_frame)
    return Need(surface(*read[1:]), faces, geometry.positions, origins, gamma, edge_lengths)


def _of_batch(batch: Sequence[Sample], bound: VolumeBinding) -> turgor.RefinementNeed:
    poses = np.stack([sample.pose_matrices for sample in batch])
    return batch[0].engine.refinement_need(poses, **sampling.arguments(batch, bound))


def _level(split: Split) -> refined_mesh.Level:
    counts = split.before.counts[split.centred]
    offsets = np.concatenate([[0], np.cumsum(counts)])
    starts = split.before.offsets[:-1][split.centred]
    places = np.repeat(starts - offsets[:-1], counts) + np.arange(int(counts.sum()))
    return refined_mesh.Level(split.edge_ends, offsets, split.before.corners[places])
