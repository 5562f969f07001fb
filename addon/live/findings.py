"""What is off with a character, as findings for the panel and the log: by what its bind, its stack and a frame say."""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import runtime
from ..logic.character_figures import SpineFigures, VolumeFigures
from ..logic.shells import Shells
from ..messages import message
from ..messages import of_error as message_of
from ..properties.joint_names import bone_of, is_bend
from ..runtime import Finding
from ..scene import modifier_inputs, node_group, spine_stack, stack, stack_proof
from ..scene.gathered import listed
from ..scene.obstacles import Obstacle
from . import refusals
from .binding_rules import BindError

# Ids of errors that no obstacle names.
ERROR_IDS = {
    "ShapeKeyTopologyError": "shape_key_topology",
    "PlacementError": "placement",
    "FrameError": "frame",
    "PoseError": "frame",
}
# A joint that misses less than this many percent of the rest volume is not told.
NOTABLE_PERCENT = 0.005

_WHY_NOT_CORRECTED = {
    "sheet": message("too open to hold a volume"),
    "flat": message("flat, holds no volume"),
    "non_manifold": message("edges with three or more faces"),
    "not_orientable": message("faces that cannot agree which side is out"),
}
_SHELL_FIXES = {"sheet": "SELECT_OPEN_EDGES", "non_manifold": "SELECT_NON_MANIFOLD"}


def finding(target: bpy.types.Object, severity: str, name: str, text: str, fix: str = "", subject: str = "") -> Finding:
    """A finding about `target`, with the reason why its fix cannot be applied there, if any."""
    return Finding(name, severity, text, fix, subject, refusals.refusal(target, fix, subject) if fix else "")


def of_error(target: bpy.types.Object, error: BaseException) -> Finding:
    """The finding for an error of a bind or a frame: why the mesh shows what it would without our modifier."""
    if isinstance(error, BindError):
        return of_obstacle(target, "ERROR", error.obstacle)
    name = ERROR_IDS.get(type(error).__name__, "engine")
    return finding(target, "ERROR", name, message_of(error))


def of_obstacle(target: bpy.types.Object, severity: str, found: Obstacle) -> Finding:
    """The finding for an obstacle in the stack or the scene."""
    return finding(target, severity, found.id, found.text, found.fix, found.subject)


def of_shells(target: bpy.types.Object, shells: Shells) -> list[Finding]:
    """Findings about parts of the mesh that are open, inside out, or stay as skinned."""
    found = []
    for status, count in sorted(shells.unsound.items()):
        severity = "WARNING" if status in {"non_manifold", "not_orientable"} or not shells.sound else "INFO"
        text = message("Parts not corrected: {count}, {reason}", count=count, reason=_WHY_NOT_CORRECTED[status])
        found.append(finding(target, severity, f"{status}_part", text, _SHELL_FIXES.get(status, "")))
    if shells.inverted:
        text = message("Parts that are inside out: {count}; recalculate their normals", count=shells.inverted)
        found.append(finding(target, "WARNING", "inverted_normals", text, "RECALCULATE_OUTSIDE"))
    if shells.mixed:
        text = message("Parts whose faces look both ways: {count}; recalculate their normals", count=shells.mixed)
        found.append(finding(target, "WARNING", "mixed_normals", text, "RECALCULATE_OUTSIDE"))
    if shells.open:
        text = message(
            "Open parts that count as if they were closed: {count}, with {edges:,} edges around their openings",
            count=shells.open,
            edges=shells.open_edges,
        )
        found.append(finding(target, "INFO", "open_part", text, "SELECT_OPEN_EDGES"))
    return found


def of_lane(target: bpy.types.Object, lane: stack_proof.Lane) -> Finding:
    """The finding that the stack is read as Blender evaluates it, and why."""
    first, *others = lane.reasons
    text = message("Read as Blender evaluates it, which takes longer: {reason}", reason=first)
    if others:
        text = message(
            "Read as Blender evaluates it, which takes longer: {reason}; and {count} more reasons",
            reason=first,
            count=len(others),
        )
    return finding(target, "INFO", "evaluated", text)


def of_weights(target: bpy.types.Object, unweighted_count: int) -> list[Finding]:
    """A finding where some vertices among weighted ones follow no bone."""
    if not unweighted_count:
        return []
    text = message(
        "Vertices that no bone holds and that stay behind: {count:,}; give them weights", count=unweighted_count
    )
    return [finding(target, "WARNING", "unweighted", text, "SELECT_UNWEIGHTED")]


def of_masks(target: bpy.types.Object, mask: NDArray[np.float32] | None, pinned_shells: int) -> list[Finding]:
    """Findings about mask groups that are gone or empty, and masks that leave nothing free.

    mask: (N,), None without any.
    """
    saved = target.turgor
    found = []
    for name in dict.fromkeys((saved.vertex_group, saved.pin_group)):
        if name and name not in target.vertex_groups:
            text = message("There is no vertex group {group} any more: choose another, or clear the mask", group=name)
            found.append(finding(target, "WARNING", "mask_group_missing", text, "CLEAR_GROUP", name))
    if mask is not None and not mask.any():
        text = "The masks pin all vertices, and the mesh shows plain skinning: paint weights into the groups"
        found.append(finding(target, "WARNING", "all_pinned", text))
    elif pinned_shells:
        text = message("Parts that masks pin as a whole, which stay as skinned: {count}", count=pinned_shells)
        found.append(finding(target, "INFO", "pinned_part", text))
    return found


def of_volume_state(target: bpy.types.Object) -> list[Finding]:
    """Findings about the stack and the object around Turgor Volume, which may change without any bind."""
    ours, armature = stack.volume_modifier(target), stack.armature_modifier(target)
    return _of_state(target, ours, armature)


def of_spine_state(target: bpy.types.Object) -> list[Finding]:
    """Findings about the stack and the object around Turgor Spine, which may change without any bind."""
    return _of_state(target, spine_stack.spine_modifier(target), spine_stack.limb_modifier(target))


def state(target: bpy.types.Object, ours: bpy.types.Modifier | None, armature: bpy.types.Modifier | None) -> tuple:
    """A key, cheap to make: while it is equal, `of_volume_state` or `of_spine_state` finds the same."""
    switches = [None if each is None else (each.show_viewport, each.show_render) for each in (ours, armature)]
    session = runtime.session
    return (*switches, target.matrix_world.is_negative, target.library is None, session.route, session.route_reason)


def _of_state(
    target: bpy.types.Object, ours: bpy.types.Modifier | None, armature: bpy.types.Modifier | None
) -> list[Finding]:
    found = []
    if ours is not None:
        if not ours.show_render and (armature is None or armature.show_render):
            text = message("{modifier} is off in renders", modifier=ours.name)
            found.append(finding(target, "WARNING", "off_in_renders", text, "SHOW_IN_RENDERS", ours.name))
        if not ours.show_viewport and (armature is None or armature.show_viewport):
            text = message("{modifier} is off in the viewport", modifier=ours.name)
            found.append(finding(target, "INFO", "off_in_viewport", text, "SHOW_IN_VIEWPORT", ours.name))
    if target.matrix_world.is_negative:
        text = "The object is mirrored by a negative scale; exporters may turn it inside out: apply its scale"
        found.append(finding(target, "INFO", "negative_scale", text))
    if target.library is not None:
        text = "The object is linked, its settings are read only: make a library override to change them"
        found.append(finding(target, "INFO", "linked", text))
    if runtime.session.route == "PUSH":
        text = message("Evaluates each frame twice: {reason}", reason=runtime.session.route_reason)
        found.append(finding(target, "INFO", "push_route", text))
    return found


def of_figures(target: bpy.types.Object, figures: VolumeFigures, strengths: dict[str, float]) -> tuple[Finding, ...]:
    """Findings about one frame of Turgor Volume: joints out of room, volume that settings leave out, folds.

    strengths: by joint.
    """
    found = _of_capped_joints(target, figures)
    weak = [
        name
        for name, joint in figures.joints.items()
        if abs(joint.lost * (1.0 - strengths.get(name, 1.0))) >= NOTABLE_PERCENT
    ]
    if weak:
        text = message(
            "The strength of joints leaves {percent:+.2f} % of the volume: {joints}",
            percent=figures.corrected_deviation,
            joints=listed([_label(name) for name in weak]),
        )
        found.append(finding(target, "INFO", "joint_strength", text))
    if figures.folds is not None and figures.folds.left_count:
        text = message(
            "Folds that could not be repaired with the exact volume: {count:,}; lower the strength of the joint there,"
            " or pin less",
            count=figures.folds.left_count,
        )
        found.append(finding(target, "WARNING", "folds_left", text))
    ours = stack.volume_modifier(target)
    part = 1.0 if ours is None else float(modifier_inputs.read_input(ours, node_group.STRENGTH))
    if ours is not None and part != 1.0:
        text = message(
            "Strength of {modifier} is {part:.2f}: the mesh lies between plain skinning and the exact volume",
            modifier=ours.name,
            part=part,
        )
        found.append(finding(target, "INFO", "strength", text))
    return tuple(found)


def _of_capped_joints(target: bpy.types.Object, figures: VolumeFigures) -> list[Finding]:
    capped = [name for name, joint in figures.joints.items() if joint.is_capped and abs(joint.lost) >= NOTABLE_PERCENT]
    capped.sort(key=lambda name: -abs(figures.joints[name].lost))
    if not capped:
        return []
    text = message(
        "{joint} has no room for all of its volume; the rest went to the skin around: give it a larger Size",
        joint=_label(capped[0]),
    )
    if len(capped) > 1:
        text = message(
            "{count} joints have no room for all of their volume: {joints}; the rest went to the skin around: give them"
            " a larger Size",
            count=len(capped),
            joints=listed([_label(name) for name in capped]),
        )
    return [finding(target, "INFO", "capped", text, "LARGER_SIZE", "\n".join(capped))]


def _label(joint: str) -> str:
    return message("bend of {bone}", bone=bone_of(joint)) if is_bend(joint) else joint


def of_spine_figures(figures: SpineFigures) -> tuple[Finding, ...]:
    """Findings about one frame of Turgor Spine: vertices that are held back."""
    if not figures.clamped_count:
        return ()
    text = message(
        "{count:,} of {all:,} vertices lie too far inside a bend and are held back there",
        count=figures.clamped_count,
        all=figures.point_count,
    )
    return (Finding("clamped", "WARNING", text),)
