"""One frame of one fleshed body: evaluated data -> engine -> offsets. Safe on a worker thread; never raises."""

from __future__ import annotations

import ctypes
from time import perf_counter
from typing import NamedTuple

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..logic import flesh, spine_courses, spine_sketch, splines
from ..logic.character_figures import SpineFigures, Timing
from ..logic.finding import Finding
from ..logic.lazy import Lazy
from ..messages import message
from ..scene import (
    frame,
    modifier_inputs,
    node_group,
    placement,
    shape_keys,
    skeleton,
    spine_chain,
    spine_curve,
    spine_stack,
)
from ..states import SpineBinding, SpineState
from . import findings, measured
from .guard import guarded


def flesh_frame(target: bpy.types.Object, address: int, vertex_count: int) -> bool:
    """Flesh the evaluated `target`; offsets, (N, 3) float32, go to `address`. False: offsets must be zero."""
    return guarded(runtime.session.spines, target, lambda state: _flesh_bound(target, state, address, vertex_count))


def _flesh_bound(target: bpy.types.Object, state: SpineState, address: int, vertex_count: int) -> bool:
    bound = state.binding
    if bound is None:
        return False
    if bound.flesh.vertex_count != vertex_count:
        # The engine would refuse it, but it is not the engine that writes.
        text = message(
            "There is room for {found:,} vertices, {bound:,} were bound: press Rebind",
            found=vertex_count,
            bound=bound.flesh.vertex_count,
        )
        raise frame.FrameError(text)
    if not _fits(target, bound):
        runtime.session.waiting.add(target.original.session_uid)
        return False
    _flesh(target, state, bound, address)
    return True


def _fits(target: bpy.types.Object, bound: SpineBinding) -> bool:
    """Whether the binding is of what is chosen now; scripts choose without telling anybody."""
    keys = shape_keys.count(target.data.shape_keys)
    return bound.chosen == spine_stack.chosen(target.turgor_spine) and bound.flesh.shape_count == keys


def added_offsets(target: bpy.types.Object, vertex_count: int) -> NDArray[np.float32] | None:
    """(N, 3) what Turgor Spine adds to the skin that Turgor Volume, right after it, corrects; None where nothing.

    Computed anew: nothing makes one modifier's offsets wait for another's.
    """
    ours = spine_stack.fleshed_limb(target)
    state = runtime.session.spines.get(target.original.session_uid)
    bound = None if state is None else state.binding
    if ours is None or bound is None or bound.flesh.vertex_count != vertex_count:
        return None
    strength = float(modifier_inputs.read_input(ours, node_group.STRENGTH))
    if strength == 0.0 or not _fits(target, bound):
        return None
    return _Frame(target, bound).outcome().offsets * np.float32(strength)


class Shape(NamedTuple):
    """A body in one frame, before Turgor Spine and what that adds."""

    positions: NDArray[np.float64]  # (N, 3) at rest, with its shape keys
    offsets: NDArray[np.float32]  # (N, 3) at full strength
    strength: float


def read_shape(target: bpy.types.Object, bound: SpineBinding) -> Shape:
    """`target`: evaluated, with its spine; its mesh need not be. Raises ValueError where the binding does not fit."""
    ours = spine_stack.spine_modifier(target)
    if ours is None or not _fits(target, bound):
        raise ValueError("The body is bound to another spine: press Rebind")
    found = _Frame(target, bound)
    strength = float(modifier_inputs.read_input(ours, node_group.STRENGTH))
    return Shape(found.body.positions, found.outcome().offsets, strength)


def _flesh(target: bpy.types.Object, state: SpineState, bound: SpineBinding, address: int) -> None:
    started = perf_counter()
    found = _Frame(target, bound)
    ready = perf_counter()
    outcome = found.outcome()
    done = perf_counter()
    ctypes.memmove(address, outcome.offsets.ctypes.data, outcome.offsets.nbytes)
    if not runtime.session.is_rendering:
        state.name = target.name
        world = np.array(target.matrix_world, np.float64)
        body, pose = found.body, found.pose
        uid = target.original.session_uid
        state.measure = measure = Lazy(lambda: _figures(uid, state, bound, outcome))
        state.inspect = Lazy(lambda: _inspect(uid, state, bound, measure()))
        state.sketch = Lazy(lambda: spine_sketch.draw(body, pose, outcome.offsets, world))
        state.local_error = Lazy(lambda: spine_sketch.local_error(body, pose))
        state.timing = Timing(1e3 * (ready - started), 1e3 * (done - ready), 1e3 * (perf_counter() - done))


class _Frame:
    """All that one frame reads."""

    def __init__(self, target: bpy.types.Object, bound: SpineBinding) -> None:
        saved = target.turgor_spine
        self._flesh = bound.flesh
        self._keep_volume = saved.keep_volume
        self._pose_matrices = self._object_from_armature = None
        if bound.rest_bones is not None:
            self._object_from_armature = placement.object_from_armature(target, saved.rig)
            read = _Bones(target, bound, self._object_from_armature)
            if bound.limb_bones is not None:
                self._pose_matrices = skeleton.read_pose(saved.rig, bound.limb_bones)
        else:
            read = _Curve(target, bound)
        kind: flesh.Kind = tuple(saved.blend) if saved.kind == "BLEND" else saved.kind.lower()
        shape_values = shape_keys.read_values(target)
        reach = (saved.start, saved.end)
        self.body = bound.flesh.bind(read.key, read.rest, reach, kind, read.match, shape_values)
        self.pose = _pose(read, self.body, saved)

    def outcome(self) -> flesh.Outcome:
        return self._flesh.deform(
            self.body, self.pose, self._keep_volume, self._pose_matrices, self._object_from_armature
        )


class _Bones:
    """A chain of bones, posed."""

    match: flesh.Match = "stations"

    def __init__(
        self, target: bpy.types.Object, bound: SpineBinding, object_from_armature: NDArray[np.float64]
    ) -> None:
        saved = target.turgor_spine
        self._course: spine_courses.Course = "joints" if saved.course == "JOINTS" else "bones"
        self._use_roll = saved.use_roll
        matrices, tail = bound.rest_bones
        # Skin of a limb follows its armature wherever that stands; a body without one was bound where it stood.
        place = bound.placement if bound.limb_bones is None else object_from_armature
        self._rest = _chain(place, matrices, tail)
        self._posed = _chain(object_from_armature, *spine_chain.read_posed(saved.rig, bound.chain))
        self._at = spine_courses.stations(len(self._rest.joints), self._course, saved.bend_width)
        self.key = (*(part.tobytes() for part in self._rest), self._course, saved.bend_width)

    def rest(self) -> turgor.Spine:
        return spine_courses.rest_spine(self._rest, self._at, self._course)

    def posed(self, rest: turgor.Spine) -> tuple[turgor.Spine, NDArray[np.float64]]:
        """The spine, and the angle at each of its stations."""
        posed = spine_courses.posed_spine(rest, self._posed, self._at)
        if not self._use_roll:
            return posed, np.zeros(posed.station_count)
        return posed, spine_courses.rolls(rest, posed, self._rest, self._posed, self._at)


class _Curve:
    """A curve object, as it is now."""

    def __init__(self, target: bpy.types.Object, bound: SpineBinding) -> None:
        saved = target.turgor_spine
        if saved.curve is None:
            raise ValueError("The curve is gone: choose another")
        self._saved = saved
        self._box = bound.flesh.box
        self._rest_points = bound.rest_curve.moved(bound.placement)
        self._posed_points = spine_curve.read_posed(saved.curve).moved(
            placement.object_from_armature(target, saved.curve)
        )
        self.key = (saved.rest, self._rest_points.plain())
        is_alike = len(self._rest_points.points) == len(self._posed_points.points)
        self.match: flesh.Match = "length" if saved.rest != "CURVE" else "stations" if is_alike else "relative_length"

    def rest(self) -> turgor.Spine:
        if self._saved.rest != "CURVE":
            return splines.axis_spine(self._box, "XYZ".index(self._saved.rest))
        return splines.spline(*self._rest_points[:5], *self._rest_points[6:])

    def posed(self, rest: turgor.Spine) -> tuple[turgor.Spine, NDArray[np.float64]]:
        """The spine, and the tilt at each of its stations."""
        resolution = rest.resolution if self._saved.rest == "CURVE" else None
        posed = splines.spline(*self._posed_points[:5], *self._posed_points[6:], resolution=resolution)
        tilts = self._posed_points.tilts
        if self.match == "stations":
            tilts = tilts - self._rest_points.tilts
        return posed, splines.at_stations(tilts, posed) + splines.first_angle(rest, posed)


def _pose(read: _Bones | _Curve, body: flesh.Bound, saved: bpy.types.PropertyGroup) -> flesh.Pose:
    posed, angles = read.posed(body.rest)
    within = body.fleshing.rest_spine
    parts = within.station_lengths / within.length
    if read.match == "stations":
        angles = np.interp(within.station_parameters, posed.station_parameters, angles)
        posed = splines.trimmed(posed, saved.start, saved.end)
    else:
        angles = np.interp(parts, posed.station_lengths / posed.length, angles)
    twist = angles + spine_courses.grown(saved.twist_start, saved.twist, parts)
    return flesh.Pose(posed, twist, saved.slide, saved.stretch)


def _chain(place: NDArray[np.float64], matrices: NDArray[np.float64], tail: NDArray[np.float64]) -> spine_courses.Chain:
    return spine_courses.chain_of(place @ matrices, place[:3, :3] @ tail + place[:3, 3])


def _figures(uid: int, state: SpineState, bound: SpineBinding, outcome: flesh.Outcome) -> SpineFigures:
    """Figures of a frame. Called on the main thread when a panel is drawn, after the viewport's mesh was evaluated."""
    count, clamped = len(outcome.offsets), outcome.clamped_count
    volumes = None if outcome.volumes is None else outcome.volumes()
    if volumes is None or volumes.rest == 0.0:
        return SpineFigures(count, clamped, None, None)
    fleshed, kept = (100.0 * (volume / volumes.rest - 1.0) for volume in volumes[1:])
    shown = measured.spine_volumes(runtime.object_of(uid, state, bpy.data.objects), bound)
    deviation = None if shown is None else 100.0 * (float(np.abs(shown).sum()) / volumes.rest - 1.0)
    return SpineFigures(count, clamped, fleshed, kept, deviation)


def _inspect(uid: int, state: SpineState, bound: SpineBinding, figures: SpineFigures) -> tuple[Finding, ...]:
    target = runtime.object_of(uid, state, bpy.data.objects)
    found = findings.of_spine_figures(figures)
    return found if target is None else (*found, *measured.of_spine(target, bound, figures))
