"""Volumes over frames on meshes that Blender evaluates, apart from the artist's scene. Main thread only."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import NamedTuple

import bpy
import numpy as np
import turgor
from numpy.typing import NDArray

from .. import runtime
from ..scene import doubles
from . import push


class Volumes(NamedTuple):
    """F frames, in cubed units of object space, shells counted positive; NaN where the mesh has other vertices."""

    right_after: NDArray[np.float64]  # (F,) right after the modifier of ours
    at_end: NDArray[np.float64]  # (F,) after all modifiers but simulations


def volumes(
    target: bpy.types.Object,
    ours: bpy.types.Modifier,
    mesh: turgor.Mesh,
    frames: Sequence[float],
    tell: Callable[[int], None] = lambda done: None,
) -> Volumes:
    """Measure the target's mesh in float64 by `mesh`, beside all that the solver says.

    mesh: as the stack makes it up to `ours`. tell: is told how many frames are done. Raises
    scene_drivers.SceneDriverError.
    """
    later = doubles.after(target, ours.name)
    chains = [later]
    if not set(later) <= set(doubles.simulations(target)):
        chains.append(doubles.simulations(target))
    found = np.full((len(chains), len(frames)), np.nan)
    with ExitStack() as kept:
        kept.enter_context(runtime.quiet())
        # The panel's figures stay those of the artist's frame.
        kept.enter_context(runtime.character(target.session_uid).frame_kept())
        kept.enter_context(runtime.spine(target.session_uid).frame_kept())
        if runtime.session.route == "PUSH":
            kept.callback(lambda: push.write_all(bpy.context.evaluated_depsgraph_get()))
        alone = kept.enter_context(doubles.doubles([target] * len(chains), chains, push.settle))
        for number, frame in enumerate(frames):
            for place, positions in enumerate(alone.positions(frame)):
                if len(positions) == mesh.vertex_count and np.isfinite(positions).all():
                    found[place, number] = np.abs(mesh.component_volumes(positions)).sum()
            tell(number + 1)
    return Volumes(found[0], found[-1])


def deviations(volumes: NDArray[np.float64], targets: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """(F,) in percent of the targets; 0 where there is no volume to keep, NaN where none was measured."""
    targets = np.broadcast_to(np.asarray(targets, np.float64), volumes.shape)
    return 100.0 * np.divide(volumes - targets, targets, out=np.zeros_like(volumes), where=targets > 0.0)
