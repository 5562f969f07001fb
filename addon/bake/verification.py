"""The baked copy, evaluated by Blender, beside what it was made of and beside the live character."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import ExitStack, contextmanager
from time import perf_counter

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..live import push
from ..logic.bake_report import FrameError
from ..logic.compared_frames import compared
from ..messages import message
from ..scene import doubles, modifier_inputs, node_group, rest
from .baking import COMPARED, MADE, Baking, Progress
from .options import BakeError
from .volume_frames import VolumeFrames

# Frames of one slice, and its length where frames may be slow; to begin one takes as long as some frames.
FRAMES_PER_SLICE = 16
SECONDS_OF_WORK = 0.1
# Poses whose joints are looked at for the worst ones: what is lost changes slowly from frame to frame.
MOST_MEASURED = 64


def verify(baking: Baking) -> Iterator[Progress]:
    """Adds errors to the report: from what was computed on every frame, from the live character on those that count.

    Raises BakeError where the copy is of another mesh.
    """
    mesh_of = _Meshes(baking)
    yield from _beside_computed(baking, mesh_of.at_rest)
    yield from _beside_live(baking, mesh_of)


def _beside_computed(baking: Baking, mesh: turgor.Mesh) -> Iterator[Progress]:
    copy = baking.copy
    assert copy is not None
    frames = baking.options.frames
    computed = (positions for chunk in baking.chunks for positions in chunk)
    for start in range(0, len(frames), FRAMES_PER_SLICE):
        with doubles.doubles([copy], [doubles.after(copy, baking.last)]) as alone:
            for number in frames[start : start + FRAMES_PER_SLICE].tolist():
                (baked,) = alone.positions(number)
                expected = next(computed)
                if baked.shape != expected.shape:
                    raise BakeError(
                        f"{copy.name} has {len(baked)} vertices, the live character {len(expected)}: bake it again"
                    )
                baking.report.computed_errors.append(_error(mesh, number, baked, expected, baking.size))
        done = min(start + FRAMES_PER_SLICE, len(frames))
        part = MADE + (COMPARED - MADE) * done / len(frames)
        yield Progress(part, f"Compared {done} of {len(frames)} frames with what was computed")


def _beside_live(baking: Baking, mesh_of: _Meshes) -> Iterator[Progress]:
    """The whole stacks; where they make other numbers of vertices, up to ours."""
    chosen = yield from _chosen(baking)
    frames = baking.options.frames[chosen].tolist()
    errors = baking.report.live_errors
    is_whole = True
    while len(errors) < len(frames):
        with _side_by_side(baking, is_whole=is_whole) as alone:
            until = perf_counter() + SECONDS_OF_WORK
            while len(errors) < len(frames) and perf_counter() < until:
                number = frames[len(errors)]
                meshes = alone.evaluated(number)
                live, baked = (rest.read_positions(each) for each in meshes)
                if live.shape != baked.shape:
                    baking.report.notes.append(_differs(number, live, baked, is_whole=is_whole))
                    errors.clear()
                    if not is_whole:
                        return
                    is_whole = False
                    break
                errors.append(_error(mesh_of(meshes[0]), number, baked, live, baking.size))
        part = COMPARED + (1.0 - COMPARED) * len(errors) / len(frames)
        yield Progress(part, f"Compared {len(errors)} of {len(frames)} frames with the live character")


def _differs(number: float, live: NDArray[np.float32], baked: NDArray[np.float32], *, is_whole: bool) -> str:
    if is_whole:
        return message(
            "On frame {frame} modifiers after Turgor make {live} vertices live and {baked} of the copy: compared"
            " without them",
            frame=f"{number:g}",
            live=len(live),
            baked=len(baked),
        )
    return message(
        "On frame {frame} the live character has {live} vertices and its copy {baked}: they cannot be compared",
        frame=f"{number:g}",
        live=len(live),
        baked=len(baked),
    )


def _chosen(baking: Baking) -> Generator[Progress, None, NDArray[np.intp]]:
    """Indices of frames that are compared with the live character."""
    source, poses = baking.source, [posed for posed in baking.poses if posed is not None]
    count = len(baking.options.frames)
    if not 0 < baking.options.live_frames < count:
        return np.arange(count)
    losses = None
    if isinstance(source, VolumeFrames) and len(poses) == count:
        looked_at = np.unique(np.linspace(0, count - 1, min(count, MOST_MEASURED)).astype(np.intp))
        losses = np.zeros((count, len(source.joint_bones)))
        for start in range(0, len(looked_at), FRAMES_PER_SLICE):
            part = looked_at[start : start + FRAMES_PER_SLICE]
            losses[part] = source.joint_losses([poses[index] for index in part])
            yield Progress(COMPARED, "Looking for the worst frames of joints")
    return compared(count, losses, baking.options.live_frames)


class _Meshes:
    """Faces of evaluated meshes, read again only where there are others."""

    def __init__(self, baking: Baking) -> None:
        read = baking.source.rest
        self._key = len(read.positions), len(read.face_corners)
        self._mesh = self.at_rest = turgor.Mesh(read.positions, read.face_offsets, read.face_corners)

    def __call__(self, evaluated: bpy.types.Mesh) -> turgor.Mesh:
        key = len(evaluated.vertices), len(evaluated.loops)
        if key != self._key:
            self._key = key
            self._mesh = turgor.Mesh(rest.read_positions(evaluated), *rest.read_faces(evaluated))
        return self._mesh


@contextmanager
def _side_by_side(baking: Baking, *, is_whole: bool) -> Iterator[doubles.Doubles]:
    """The live character and its copy, evaluated at once."""
    target, copy, source = baking.target, baking.copy, baking.source
    assert copy is not None
    objects = [target, copy]
    without = [doubles.simulations(ob) for ob in objects]
    if not is_whole:
        without = [doubles.after(target, source.own.name), doubles.after(copy, baking.last)]
    with ExitStack() as kept:
        # The panel's figures stay those of the artist's frame.
        kept.enter_context(runtime.character(target.session_uid).frame_kept())
        kept.enter_context(runtime.spine(target.session_uid).frame_kept())
        if baking.options.repair_folds and not target.turgor.repair_folds:
            kept.enter_context(_folds_repaired(target))
        alone = kept.enter_context(doubles.doubles(objects, without, push.settle))
        ours = alone.objects[0].modifiers[source.own.name]
        if modifier_inputs.has_input(ours, node_group.IN_VIEWPORT):
            modifier_inputs.write_input(ours, node_group.IN_VIEWPORT, True)
        if runtime.session.route == "PUSH":
            kept.callback(lambda: push.write_all(bpy.context.evaluated_depsgraph_get()))
        yield alone


@contextmanager
def _folds_repaired(target: bpy.types.Object) -> Iterator[None]:
    """Within it the live character repairs folds too, as the bake did."""
    target.turgor.repair_folds = True
    try:
        yield
    finally:
        target.turgor.repair_folds = False


def _error(
    mesh: turgor.Mesh, number: float, baked: NDArray[np.float32], other: NDArray[np.float32], size: float
) -> FrameError:
    distances = np.linalg.norm(baked.astype(np.float64) - other, axis=1)
    longest = float(distances.max(initial=0.0))
    before, after = (float(np.abs(mesh.component_volumes(each)).sum()) for each in (other, baked))
    return FrameError(
        number,
        longest,
        float(np.sqrt(np.mean(distances**2))) if len(distances) else 0.0,
        longest / size if size else 0.0,
        after / before - 1.0 if before else 0.0,
    )
