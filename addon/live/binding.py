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
from ..messages import message
from ..properties.joint_names import bend_of
from ..properties.profiles import PRESET_NUMBERS
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
    stack_proof,
)
from ..states import EvaluatedStack, VolumeBinding
from . import findings, joint_names, masks, profiles, skin, twins
from .binding_rules import BindError, check_topology, is_editable


def bind(target: bpy.types.Object, *, accept_topology: bool = False) -> None:
    """Bind, or leave a problem for the panel and the log and the mesh as Blender shows it.

    accept_topology: the artist agrees that the mesh has other vertices or faces than when it was bound.
    """
    character = runtime.character(target.session_uid)
    character.name = target.name
    character.signature = stack_proof.signature(target)
    started = perf_counter()
    found: list[Finding] = []
    lane = stack_proof.lane_of(target)
    try:
        with runtime.quiet():
            bound, lane = _bind(target, lane, character.binding, accept_topology)
    except (BindError, rest.ShapeKeyTopologyError, placement.PlacementError, TurgorError) as error:
        bound = None
        found.append(findings.of_error(target, error))
    else:
        found += findings.of_shells(target, bound.body.shells) + findings.of_weights(target, bound.unweighted_count)
        if lane.is_evaluated:
            found.append(findings.of_lane(target, lane))
    character.binding, character.mask_findings = bound, ()
    twins.renew(target)
    armature = stack.armature_modifier(target)
    if character.active_bone is None and bound is not None and armature is not None:
        character.active_bone = bone_choice.active_bone_name(armature.object)
    if bound is not None and lane.is_evaluated:
        difference = obstacles.evaluated_difference(target, lane)
    else:
        difference = obstacles.render_difference(target, armature) or spine_stack.render_difference(target)
    if difference is not None:
        found.append(findings.of_obstacle(target, "WARNING", difference))
    if is_editable(target) and target.override_library is None:
        _set_switches(target, is_evaluated=bound is not None and lane.is_evaluated, is_same=difference is None)
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


def _bind(
    target: bpy.types.Object, lane: stack_proof.Lane, before: VolumeBinding | None, accept_topology: bool
) -> tuple[VolumeBinding, stack_proof.Lane]:
    """The binding, and how the stack is read: also as Blender evaluates it where weights of bones move."""
    obstacle = obstacles.obstacle(target)
    if obstacle is not None:
        raise BindError(obstacle)
    holder = carrier.carrier_of(target)
    if runtime.session.route == "PUSH" and holder is not None and holder.data.library is not None:
        text = "The character is linked with its offsets, which push cannot write: choose pull in the preferences"
        raise BindError(obstacles.Obstacle("push_linked", text))
    armature = stack.armature_modifier(target)
    group_names = [group.name for group in target.vertex_groups]
    rig = None if armature is None else armature.object
    read = rest.read_rest(target, stack.body_end(target), target.turgor.bound_frame, with_keys=not lane.moves)
    if not len(read.positions):
        text = "The mesh has no vertices before the Armature modifier: give it some"
        raise BindError(obstacles.Obstacle("no_vertices", text))
    check_topology(target.turgor, read, accept=accept_topology)
    place = placement.bound_object_from_armature(target.turgor)
    if place is None:
        place = placement.IDENTITY if rig is None else placement.object_from_armature(target, rig)
    is_dual = _is_dual(target, armature)
    skinned = skin.read_skin(read, group_names, armature, place, target.turgor.bound_frame)
    content = _content(read, skinned, is_dual)
    if before is not None and is_editable(target):
        settings.rename_joints(target, _renamed(before.bones, skinned.bones))
        settings.rename_groups(target, before.group_names, group_names)
    weighed_at = place
    place = placement.IDENTITY
    if rig is not None:
        place = _placement(target, rig, is_changed=_is_changed(before, rig, content))
    if skinned.is_placed and (weighed_at != place).any():
        skinned = skin.read_skin(read, group_names, armature, place, target.turgor.bound_frame)
        content = _content(read, skinned, is_dual)
    bones = skinned.bones
    if skinned.moving and not lane.is_evaluated:
        lane = lane._replace(poses=(skin.moving_weights(skinned),))
    if skinned.turning and is_dual and not lane.is_evaluated:
        text = message(
            "Bone {bone} has an animated curve at rest, by whose axes Preserve Volume splits off scale",
            bone=skinned.turning,
        )
        lane = lane._replace(poses=(text,))
    weighed = placement.corners(read.positions) if skinned.is_placed else None
    if weighed is not None and not lane.is_evaluated and _is_moved_along(target, rig, place, weighed):
        reason = message(
            "{object} may stand elsewhere to its bendy bones or envelopes than when bound", object=target.name
        )
        lane = lane._replace(poses=(reason,))
    if armature is not None:
        skin.check(skinned, armature, is_evaluated=lane.is_evaluated)
    evaluated = _evaluated(target, lane, read)
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
            is_dual,
            read.shape_deltas,
            place,
            bones.is_segment,
        )
    masked_by, mask = masks.chosen(target), masks.read_mask(target)
    if mask is not None or made.mask is not None:
        made = made.masked(mask)
    if is_editable(target):
        target.turgor.settled = target.turgor.in_step = 0
        _prepare_scene(target, rig, bones, made, evaluated)
    return (
        VolumeBinding(
            made,
            bones,
            0 if rig is None else rig.session_uid,
            content,
            place,
            profiles.read(target),
            _fleshed(target, bones),
            # Of an evaluated stack others than these bones may hold them.
            0 if lane.is_evaluated else weights.unweighted_count(skinned.weights, skinned.mask),
            tuple(group_names),
            masked_by,
            None if lane.is_evaluated else weighed,
            evaluated,
        ),
        lane,
    )


def _content(read: rest.RestMesh, skinned: skin.Skin, is_dual: bool) -> str:
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
        is_dual,
    )


def _evaluated(target: bpy.types.Object, lane: stack_proof.Lane, read: rest.RestMesh) -> EvaluatedStack | None:
    """How Blender evaluates the stack for us. Raises BindError where it makes other vertices than the body has."""
    if not lane.is_evaluated:
        return None
    if target.library is not None and not (twins.are_there(target, has_body=bool(lane.moves))):
        text = (
            "The character is linked and its stack is read as Blender evaluates it: open its file with this version and"
            " save it, or make a library override"
        )
        raise BindError(obstacles.Obstacle("linked_twin", text))
    before = [modifier for modifier in stack.modifiers_to_own(target) if stack.is_on(modifier)]
    posing = stack.posing_modifiers(target)
    frame = target.turgor.bound_frame
    if not _is_alike(read, rest.read_topology(target, stack.volume_modifier(target), frame)):
        raise BindError(_other_vertices(target, posing, read))
    fixed = stack.DEFORMING_TYPES | stack.STILL_TYPES
    looked_at = before if lane.moves else posing
    suspect = next((modifier.name for modifier in looked_at if modifier.type not in fixed), "")
    return EvaluatedStack(bool(lane.moves), read.face_corners if suspect else None, suspect)


def _is_alike(read: rest.RestMesh, found: tuple[int, NDArray[np.int32], NDArray[np.int32]]) -> bool:
    count, offsets, corners = found
    is_same = count == len(read.positions) and np.array_equal(offsets, read.face_offsets)
    return is_same and np.array_equal(corners, read.face_corners)


def _other_vertices(
    target: bpy.types.Object, posing: list[bpy.types.Modifier], read: rest.RestMesh
) -> obstacles.Obstacle:
    modifiers = list(target.modifiers)
    culprit = posing[-1]
    for modifier in posing[:-1]:
        following = modifiers[modifiers.index(modifier) + 1]
        if not _is_alike(read, rest.read_topology(target, following, target.turgor.bound_frame)):
            culprit = modifier
            break
    text = message(
        "{modifier} makes other vertices or faces after what the body is: move Turgor Volume above it",
        modifier=culprit.name,
    )
    return obstacles.Obstacle("posed_topology", text, "MOVE_ABOVE", culprit.name)


def _is_dual(target: bpy.types.Object, armature: bpy.types.ArmatureModifier | None) -> bool:
    """Whether the engine skins by dual quaternions: not where the frame decides, so that no session does."""
    if armature is None or "use_deform_preserve_volume" in stack.animated_settings(target).get(armature.name, ()):
        return False
    return armature.use_deform_preserve_volume


def _fleshed(target: bpy.types.Object, bones: skeleton.RestBones) -> list[bool] | None:
    if spine_stack.fleshed_limb(target) is None:
        return None
    saved = target.turgor_spine
    chain = spine_chain.chain_names(saved.rig, saved.first_bone, saved.last_bone) or ()
    return [bones.names[bones.bone_of(row)] in chain for row in range(len(bones.parents))]


def _is_moved_along(
    target: bpy.types.Object, rig: bpy.types.Object, place: NDArray[np.float64], weighed: NDArray[np.float64]
) -> bool:
    """Whether the mesh stands elsewhere than where its weights were made, or may on some frame."""
    if not stack_proof.stands_still_to(target, rig):
        return True
    return placement.is_elsewhere(target, placement.object_from_armature(target, rig), place, weighed)


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


def _set_switches(target: bpy.types.Object, *, is_evaluated: bool, is_same: bool) -> None:
    """Ours is off where the Armature is off that the engine corrects, and in renders that show another mesh."""
    ours, armature = stack.volume_modifier(target), stack.armature_modifier(target)
    if ours is None:
        return
    if is_evaluated:
        drivers.stand_alone(target, ours, in_renders=is_same)
    elif armature is not None:
        if not drivers.follows(target, ours, armature):
            drivers.follow_armature(target, ours, armature)
        drivers.set_in_renders(target, ours, armature, is_same)


def _prepare_scene(
    target: bpy.types.Object,
    rig: bpy.types.Object | None,
    bones: skeleton.RestBones,
    made: body.Body,
    evaluated: EvaluatedStack | None,
) -> None:
    preset = PRESET_NUMBERS[target.turgor.preset_of_new]
    settings.add_joints(target, joint_names.of_rows(bones, made.joint_bones), preset)
    holder = carrier.carrier_of(target)
    if holder is not None and is_editable(holder):
        carrier.resize(holder, made.vertex_count)
        twins.keep(target, evaluated)
        twins.write_tick(holder, rig, bones, evaluated)
