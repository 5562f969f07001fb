"""Objects evaluated apart from the artist's scene, by doubles that stand in a scene of their own.

Blender evaluates with them whatever they depend on: rigs, carriers, drivers. Its dependency graph is never the active
one, so nothing is written back: current frame, poses without keys and caches of simulations stay as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from math import floor

import bpy
import numpy as np
from numpy.typing import NDArray

from . import pose_samples, rest, stack


class Doubles:
    """Alone in a scene."""

    def __init__(
        self, scene: bpy.types.Scene, objects: Sequence[bpy.types.Object], settle: Callable[[bpy.types.Depsgraph], None]
    ) -> None:
        self._scene, self.objects, self._settle = scene, objects, settle

    def evaluated(self, frame: float) -> list[bpy.types.Mesh]:
        """One for each object, until the next frame is asked for."""
        whole = floor(frame)
        self._scene.frame_set(whole, subframe=frame - whole)
        layer = self._scene.view_layers[0]
        self._settle(layer.depsgraph)
        return [ob.evaluated_get(layer.depsgraph).data for ob in self.objects]

    def positions(self, frame: float) -> list[NDArray[np.float32]]:
        """(N, 3) object space, one for each object."""
        return [rest.read_positions(mesh) for mesh in self.evaluated(frame)]


@contextmanager
def doubles(
    objects: Sequence[bpy.types.Object],
    without: Sequence[Collection[str]],
    settle: Callable[[bpy.types.Depsgraph], None] = lambda _: None,
) -> Iterator[Doubles]:
    """without: names of modifiers, for each object, that its double lacks. settle: makes what is evaluated final."""
    made: list[bpy.types.Object] = []
    with pose_samples.scene_apart() as scene:
        try:
            for ob, names in zip(objects, without, strict=True):
                double = ob.copy()
                made.append(double)
                for name in names:
                    rest.remove_with_drivers(double, double.modifiers[name])
                _show(double)
                scene.collection.objects.link(double)
            yield Doubles(scene, made, settle)
        finally:
            for double in made:
                bpy.data.objects.remove(double)


def _show(double: bpy.types.Object) -> None:
    """On every frame: Blender evaluates nothing that is hidden, and hands out the mesh of the frame before."""
    double.hide_viewport = False
    if double.animation_data is not None:
        double.driver_remove("hide_viewport")
        # The sum of nothing; drivers come after keyframes and strips.
        double.driver_add("hide_viewport").driver.type = "SUM"


def after(ob: bpy.types.Object, last: str | None) -> list[str]:
    """Names of the modifiers after the one of that name; None: all."""
    names = [modifier.name for modifier in ob.modifiers]
    return names if last is None else names[names.index(last) + 1 :]


def simulations(ob: bpy.types.Object) -> list[str]:
    """Names of modifiers that simulate, which would write caches of the original."""
    return [modifier.name for modifier in ob.modifiers if modifier.type in stack.SIMULATED_TYPES]
