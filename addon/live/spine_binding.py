"""Binding a body to its spine: the stack before Turgor Spine is read once. On the main thread only.

As with Turgor Volume, bound engines are never saved, and the same file gives the same binding in every session.
"""

from __future__ import annotations

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray
from turgor import TurgorError

from .. import runtime
from ..logic import fingerprint, flesh, weights
from ..logic.finding import Finding
from ..messages import message
from ..scene import (
    carrier,
    drivers,
    modifier_inputs,
    node_group,
    obstacles,
    placement,
    rest,
    skeleton,
    spine_chain,
    spine_curve,
    spine_stack,
)
from ..states import SpineBinding, SpineState
from . import findings, skin
from .binding_rules import BindError, check_topology, is_editable

# What renders show where they cannot show ours.
BODY_AT_REST = message("the body without its spine")


def bind(target: bpy.types.Object, *, accept_topology: bool = False) -> None:
    """Bind, or leave a problem for the panel and the log and the mesh as Blender shows it.

    accept_topology: the artist agrees that the mesh has other vertices or faces than when it was bound.
    """
    state = runtime.spine(target.session_uid)
    state.signature = spine_stack.signature(target)
    found: list[Finding] = []
    try:
        with runtime.quiet():
            bound = _bind(target, state, accept_topology)
    except (BindError, rest.ShapeKeyTopologyError, placement.PlacementError, TurgorError) as error:
        bound = None
        found.append(findings.of_error(target, error))
    state.binding = bound
    difference = obstacles.render_difference(target, spine_stack.rest_end(target), BODY_AT_REST)
    if difference is not None:
        found.append(findings.of_obstacle(target, "WARNING", difference))
    if is_editable(target) and target.override_library is None:
        _set_switches(target, is_same=difference is None)
    runtime.set_bind_findings(state, target.name, tuple(found))
    refresh_state(target)
    holder = carrier.carrier_of(target, node_group.SPINE)
    if holder is not None:
        holder.turgor.carrier.mesh.update_tag()


def rebind(target: bpy.types.Object, frame: int) -> None:
    """Read the mesh anew as it is at `frame`, and take the spine as it rests now."""
    target.turgor_spine.bound_frame = frame
    with runtime.quiet():
        take_rest(target)
    bind(target, accept_topology=True)


def refresh_state(target: bpy.types.Object) -> None:
    """Look again at what stands around our modifier, if any of it changed."""
    state = runtime.spine(target.session_uid)
    stack_state = findings.state(target, spine_stack.spine_modifier(target), spine_stack.limb_modifier(target))
    if state.stack_state != stack_state:
        state.stack_state, state.stack_findings = stack_state, tuple(findings.of_spine_state(target))
        runtime.log_findings(state, target.name, state.stack_findings)


def take_rest(target: bpy.types.Object) -> None:
    """Let the spine where it stands now, and the curve as it is, be the rest of the body."""
    saved = target.turgor_spine
    saved.property_unset("bound_placement")
    saved.bound_to = saved.rig if saved.source == "BONES" else saved.curve
    before = saved.bound_curve
    if saved.source == "CURVE" and saved.curve is not None:
        copy = saved.bound_curve = saved.curve.data.copy()
        copy.name = f"Turgor Rest {saved.curve.name}"
        _freeze(copy, saved.curve)
    else:
        saved.bound_curve = None
    if before is not None and before.users == 0:
        bpy.data.curves.remove(before)


def _freeze(copy: bpy.types.Curve, source: bpy.types.Object) -> None:
    """What shape keys and hooks make of the curve now becomes the copy's own."""
    evaluated = source.evaluated_get(bpy.context.evaluated_depsgraph_get())
    read = spine_curve.read_posed(evaluated)
    if copy.shape_keys is not None:
        name = copy.shape_keys.name
        user = bpy.data.objects.new(copy.name, copy)
        user.shape_key_clear()
        bpy.data.objects.remove(user)
        # Blender 4.5 leaves them behind, without a curve, and then cannot save the file.
        left = bpy.data.shape_keys.get(name)
        if left is not None:
            bpy.data.batch_remove([left])
    copy.animation_data_clear()
    spine_curve.write_curve(copy, read)


def _bind(target: bpy.types.Object, state: SpineState, accept_topology: bool) -> SpineBinding:
    obstacle = spine_stack.obstacle(target)
    if obstacle is not None:
        raise BindError(obstacle)
    holder = carrier.carrier_of(target, node_group.SPINE)
    if runtime.session.route == "PUSH" and holder is not None and holder.data.library is not None:
        text = "The body is linked with its offsets, which push cannot write: choose pull in the preferences"
        raise BindError(obstacles.Obstacle("push_linked", text))
    saved = target.turgor_spine
    read = rest.read_rest(target, spine_stack.rest_end(target), saved.bound_frame)
    if not len(read.positions):
        raise BindError(obstacles.Obstacle("no_vertices", "The mesh has no vertices before Turgor Spine: give it some"))
    check_topology(saved, read, accept=accept_topology)
    spine = saved.rig if saved.source == "BONES" else saved.curve
    if saved.bound_to != spine:
        if not is_editable(target):
            text = "The body is linked and its spine was never bound: open its file and press Rebind there"
            raise BindError(obstacles.Obstacle("never_bound", text))
        take_rest(target)
    limb = spine_stack.limb_modifier(target)
    group_names = [group.name for group in target.vertex_groups]
    groups = (read.weight_offsets, read.weight_groups, read.weights)
    influence = np.ones(len(read.positions))
    if saved.vertex_group in group_names:
        group = group_names.index(saved.vertex_group)
        influence = weights.vertex_mask(*groups, group, saved.invert_vertex_group).astype(np.float64)
    chain = rest_bones = None
    if saved.source == "BONES":
        chain = spine_chain.chain_names(saved.rig, saved.first_bone, saved.last_bone)
        rest_bones = spine_chain.read_rest(saved.rig, chain)
    place = placement.bound_object_from_armature(saved)
    if place is None:
        if is_editable(target):
            placement.save(saved, spine)
        place = placement.object_from_armature(target, spine)
    held, limb_bones = _limb(target, limb, chain, read, group_names, place)
    content = fingerprint.fingerprint([*read, influence])
    before = state.binding
    if held is None and before is not None and before.limb_bones is None and before.content == content:
        body = before.flesh
    else:
        body = flesh.Flesh(read.positions, read.face_offsets, read.face_corners, read.shape_deltas, influence, held)
    _prepare_scene(target, spine, chain or (), limb_bones, body)
    rest_curve = None if saved.bound_curve is None else spine_curve.read_curve(saved.bound_curve)
    return SpineBinding(
        body, content, place, chain or (), rest_bones, rest_curve, limb_bones, spine_stack.chosen(saved)
    )


def _limb(
    target: bpy.types.Object,
    armature: bpy.types.ArmatureModifier | None,
    chain: tuple[str, ...] | None,
    read: rest.RestMesh,
    group_names: list[str],
    place: NDArray[np.float64],
) -> tuple[flesh.Limb | None, skeleton.RestBones | None]:
    """What the chain's own weights hold; None where no Armature skins the body first."""
    if armature is None or chain is None:
        return None, None
    skinned = skin.read_skin(read, group_names, armature, place, target.turgor_spine.bound_frame)
    skin.check(skinned, armature, is_evaluated=False)
    skin.check_still(skinned)
    bones = skinned.bones
    in_chain = [bones.names[bones.bone_of(row)] in chain for row in range(len(bones.parents))]
    mine = weights.of_bones(skinned.weights, np.array(in_chain, bool))
    if not len(mine.weights):
        text = "No vertex group is named after a bone of the chain: assign weights, or turn the Armature off"
        raise BindError(obstacles.Obstacle("no_deform_groups", text))
    held = weights.sums(mine) / np.maximum(weights.sums(skinned.weights), 1e-30)
    if skinned.mask is not None:
        held = held * skinned.mask
    skinning = turgor.Skinning(
        turgor.Skeleton(bones.parents, bones.rest_matrices, bones.is_segment),
        *mine,
        mode="dual_quaternion" if armature.use_deform_preserve_volume else "linear",
    )
    return flesh.Limb(skinning, held), bones


def _set_switches(target: bpy.types.Object, *, is_same: bool) -> None:
    """The spine of a limb is on where its Armature is; in renders only where they show the bound mesh."""
    ours, limb = spine_stack.spine_modifier(target), spine_stack.limb_modifier(target)
    if ours is None:
        return
    if limb is not None:
        if not drivers.follows(target, ours, limb):
            drivers.follow_armature(target, ours, limb)
        drivers.set_in_renders(target, ours, limb, is_same)
        return
    drivers.unfollow(target, ours)
    if modifier_inputs.read_input(ours, node_group.IN_RENDER) != is_same:
        modifier_inputs.write_input(ours, node_group.IN_RENDER, is_same)
        target.update_tag()


def _prepare_scene(
    target: bpy.types.Object,
    spine: bpy.types.Object,
    chain: tuple[str, ...],
    limb_bones: skeleton.RestBones | None,
    body: flesh.Flesh,
) -> None:
    holder = carrier.carrier_of(target, node_group.SPINE)
    if holder is None:
        return
    if is_editable(target) and is_editable(holder):
        carrier.resize(holder, body.vertex_count)
    elif spine.library is None:
        # Linked data must not point at the file that links it.
        return
    # For this session also where all is linked: libraries keep the drivers of the release that saved them.
    if spine.type == "ARMATURE":
        names = dict.fromkeys([*chain, *(limb_bones.names if limb_bones is not None else ())])
        drivers.write_tick(holder, drivers.bone_sources(spine, names))
    else:
        drivers.write_tick(holder, drivers.curve_sources(spine))
