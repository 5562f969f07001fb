"""Binding: the stack before the Armature is read once, and the engine prepared. On the main thread only.

Bound engines are never saved. The same file gives the same binding in every session, so frames are equal bit for bit.
"""

from __future__ import annotations

from time import perf_counter

import bpy
import numpy as np
from numpy.typing import NDArray
from turgor import TurgorError

from .. import runtime
from ..logic import body, fingerprint, weights
from ..logic.finding import Finding
from ..properties.joint_names import bend_of
from ..scene import (
    bone_choice,
    carrier,
    drivers,
    obstacles,
    placement,
    rest,
    settings,
    skeleton,
    spine_chain,
    spine_stack,
    stack,
)
from ..states import VolumeBinding
from . import findings, joint_names, masks, profiles, skin
from .binding_rules import BindError, check_topology, is_editable


def bind(target: bpy.types.Object, *, accept_topology: bool = False) -> None:
    """Bind, or leave a problem for the panel and the log and the mesh as Blender shows it.

    accept_topology: the artist agrees that the mesh has other vertices or faces than when it was bound.
    """
    character = runtime.character(target.session_uid)
    character.name = target.name
    character.signature = stack.signature(target)
    started = perf_counter()
    found: list[Finding] = []
    try:
        with runtime.quiet():
            bound = _bind(target, character.binding, accept_topology)
    except (BindError, rest.ShapeKeyTopologyError, placement.PlacementError, TurgorError) as error:
        bound = None
        found.append(findings.of_error(target, error))
    else:
        found += findings.of_shells(target, bound.body.shells) + findings.of_weights(target, bound.unweighted_count)
    character.binding, character.mask_findings = bound, ()
    if character.active_bone is None and bound is not None:
        character.active_bone = bone_choice.active_bone_name(stack.armature_modifier(target).object)
    difference = obstacles.render_difference(target, stack.armature_modifier(target))
    difference = difference or spine_stack.render_difference(target)
    if difference is not None:
        found.append(findings.of_obstacle(target, "WARNING", difference))
    if is_editable(target) and target.override_library is None:
        _set_in_renders(target, difference is None)
    runtime.set_bind_findings(character, target.name, tuple(found))
    refresh_state(target)
    if bound is not None:
        masks.set_findings(target)
    character.bind_seconds = perf_counter() - started
    holder = carrier.carrier_of(target)
    if holder is not None:
        holder.turgor.carrier.mesh.update_tag()


def rebind(target: bpy.types.Object, frame: int) -> None:
    """Read the mesh anew as it is at `frame`, with the armature where it stands now."""
    target.turgor.bound_frame = frame
    target.turgor.property_unset("bound_placement")
    bind(target, accept_topology=True)


def refresh_state(target: bpy.types.Object) -> None:
    """Look again at what stands around our modifier, if any of it changed."""
    character = runtime.character(target.session_uid)
    stack_state = findings.state(target, stack.volume_modifier(target), stack.armature_modifier(target))
    if character.stack_state != stack_state:
        character.stack_state, character.stack_findings = stack_state, tuple(findings.of_volume_state(target))
        runtime.log_findings(character, target.name, character.stack_findings)


def refresh_curves(target: bpy.types.Object) -> None:
    """Read the Custom curves again; tag the character when they changed."""
    character = runtime.character(target.session_uid)
    if character.binding is None:
        return
    before = character.binding.curves
    found = profiles.read(target, before)
    if found.stamps != before.stamps:
        character.binding = character.binding._replace(curves=found)
        carrier.carrier_of(target).turgor.carrier.mesh.update_tag()


def _bind(target: bpy.types.Object, before: VolumeBinding | None, accept_topology: bool) -> VolumeBinding:
    obstacle = obstacles.obstacle(target)
    if obstacle is not None:
        raise BindError(obstacle)
    holder = carrier.carrier_of(target)
    if runtime.session.route == "PUSH" and holder is not None and holder.data.library is not None:
        text = "The character is linked with its offsets, which push cannot write: choose pull in the preferences"
        raise BindError(obstacles.Obstacle("push_linked", text))
    armature = stack.armature_modifier(target)
    group_names = [group.name for group in target.vertex_groups]
    read = rest.read_rest(target, armature, target.turgor.bound_frame)
    if not len(read.positions):
        text = "The mesh has no vertices before the Armature modifier: give it some"
        raise BindError(obstacles.Obstacle("no_vertices", text))
    check_topology(target.turgor, read, accept=accept_topology)
    place = placement.bound_object_from_armature(target.turgor)
    if place is None:
        place = placement.object_from_armature(target, armature.object)
    skinned = skin.read_skin(read, group_names, armature, place, target.turgor.bound_frame)
    content = _content(read, skinned, armature)
    if before is not None and is_editable(target):
        settings.rename_joints(target, _renamed(before.bones, skinned.bones))
        settings.rename_groups(target, before.group_names, group_names)
    weighed_at = place
    place = _placement(target, armature.object, is_changed=_is_changed(before, armature.object, content))
    if skinned.is_placed and (weighed_at != place).any():
        skinned = skin.read_skin(read, group_names, armature, place, target.turgor.bound_frame)
        content = _content(read, skinned, armature)
    bones = skinned.bones
    skin.check(skinned, armature)
    if before is not None and before.content == content and (before.placement == place).all():
        made = before.body
    else:
        made = body.bind(
            read.positions,
            read.face_offsets,
            read.face_corners,
            bones.parents,
            bones.rest_matrices,
            bones.tails,
            skinned.weights,
            skinned.mask,
            armature.use_deform_preserve_volume,
            read.shape_deltas,
            place,
            bones.is_segment,
        )
    masked_by, mask = masks.chosen(target), masks.read_mask(target)
    if mask is not None or made.mask is not None:
        made = made.masked(mask)
    if is_editable(target):
        target.turgor.settled = 0
        _prepare_scene(target, armature.object, bones, made)
    fleshed = _fleshed(target, bones)
    rig, curves = armature.object.session_uid, profiles.read(target)
    unweighted = weights.unweighted_count(skinned.weights, skinned.mask)
    return VolumeBinding(
        made,
        bones,
        rig,
        content,
        place,
        curves,
        fleshed,
        unweighted,
        tuple(group_names),
        masked_by,
        placement.corners(read.positions) if skinned.is_placed else None,
    )


def _content(read: rest.RestMesh, skinned: skin.Skin, armature: bpy.types.ArmatureModifier) -> str:
    """Fingerprint of all that an engine is made of. Groups that skin nothing, masks above all, do not count."""
    bones, mask = skinned.bones, skinned.mask
    nodes = () if bones.bends is None else (bones.bends.after, bones.bends.owners)
    return fingerprint.fingerprint(
        [
            *(read.positions, read.face_offsets, read.face_corners, read.shape_deltas),
            *skinned.weights,
            *(bones.parents, bones.rest_matrices, bones.pose_indices, bones.is_deform, bones.tails),
            *nodes,
        ],
        bones.names,
        None if mask is None else mask.tobytes(),
        armature.use_deform_preserve_volume,
    )


def _fleshed(target: bpy.types.Object, bones: skeleton.RestBones) -> list[bool] | None:
    if spine_stack.fleshed_limb(target) is None:
        return None
    saved = target.turgor_spine
    chain = spine_chain.chain_names(saved.rig, saved.first_bone, saved.last_bone) or ()
    return [bones.names[bones.bone_of(row)] in chain for row in range(len(bones.parents))]


def _is_changed(before: VolumeBinding | None, rig: bpy.types.Object, content: str) -> bool:
    return before is not None and (before.rig != rig.session_uid or before.content != content)


def _placement(target: bpy.types.Object, rig: bpy.types.Object, *, is_changed: bool) -> NDArray[np.float64]:
    """object_from_armature to bind with: as saved, so that no frame and no session counts, anew after an edit.

    is_changed: mesh, bones or armature are others than at the last bind, perhaps by applying a scale.
    """
    saved = placement.bound_object_from_armature(target.turgor)
    if is_editable(target) and (saved is None or is_changed):
        placement.save(target.turgor, rig)
        saved = placement.bound_object_from_armature(target.turgor)
    return placement.object_from_armature(target, rig) if saved is None else saved


def _renamed(before: skeleton.RestBones, after: skeleton.RestBones) -> dict[str, str]:
    """New names of joints, when nothing but names of bones changed."""
    if len(before.names) != len(after.names) or before.parents.tolist() != after.parents.tolist():
        return {}
    renamed = list(zip(before.names, after.names, strict=True))
    return dict(renamed + [(bend_of(old), bend_of(new)) for old, new in renamed])


def _set_in_renders(target: bpy.types.Object, is_same: bool) -> None:
    ours, armature = stack.volume_modifier(target), stack.armature_modifier(target)
    if ours is not None and armature is not None:
        drivers.set_in_renders(target, ours, armature, is_same)


def _prepare_scene(target: bpy.types.Object, rig: bpy.types.Object, bones: skeleton.RestBones, made: body.Body) -> None:
    settings.add_joints(target, joint_names.of_rows(bones, made.joint_bones))
    holder = carrier.carrier_of(target)
    if holder is not None and is_editable(holder):
        carrier.resize(holder, made.vertex_count)
        drivers.write_tick(holder, drivers.bone_sources(rig, bones.names))
