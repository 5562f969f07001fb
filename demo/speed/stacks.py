"""Stacks that Blender evaluates for Turgor: a frame with it over the stack alone, but for the engine's own time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import process_time
from typing import Any, NamedTuple

import bpy
import numpy as np

from blend_fixtures.character import Character

from ..live import extension_module, must_turn_on, quiet, volume_modifier
from .race import STEP, frame_durations
from .runners import LARGE, SMALL, tube

BONE_COUNT = 17
ROW = "{:<28}{:>9}{:>9}{:>13}{:>7}{:>9}{:>7}{:>9}"
HEADER = ("stack", "vertices", "alone", "uncorrected", "ratio", "frame", "ratio", "first")
# Evaluating a stack of a large mesh takes long.
LARGE_PART = 4


class Stack(NamedTuple):
    """What stands between the Armature and Turgor."""

    name: str
    add: Callable[[Character], None]


class Times(NamedTuple):
    """Milliseconds: the stack alone, a frame with all but the correction, one with it, binding and the first frame."""

    alone: float
    bare: float
    whole: float
    first: float

    def cells(self) -> list[str]:
        """With the ratios to the stack alone."""
        times = f"{self.alone:.2f}", f"{self.bare:.2f}", f"{self.bare / self.alone:.2f}"
        return [*times, f"{self.whole:.2f}", f"{self.whole / self.alone:.2f}", f"{self.first:.0f}"]


def run(turn_count: int) -> None:
    """Prints a row per stack and size."""
    print("\nStacks that Blender evaluates for Turgor: milliseconds of the processor, ratios to the stack alone")
    print(ROW.format(*HEADER), flush=True)
    for size, turns in ((SMALL, turn_count), (LARGE, max(turn_count // LARGE_PART, 1))):
        for stack in stacks():
            bpy.ops.wm.read_homefile(use_empty=True)
            character = tube(*size, BONE_COUNT)
            stack.add(character)
            times = timed(stack, character.body, turns)
            print(ROW.format(stack.name, f"{len(character.body.data.vertices):,}", *times.cells()), flush=True)


def stacks() -> list[Stack]:
    """One that moves everything a little, one that poses it anew, one that moves a part."""
    return [
        Stack("Corrective Smooth", lambda c: _add(c, "CORRECTIVE_SMOOTH", iterations=5)),
        Stack("Multi Modifier pair", _add_pair),
        Stack("Hook", _add_hook),
    ]


def _add(character: Character, kind: str, **settings: object) -> bpy.types.Modifier:
    modifier = character.body.modifiers.new(kind.title(), kind)
    for name, value in settings.items():
        setattr(modifier, name, value)
    return modifier


def _add_pair(character: Character) -> None:
    _add(
        character,
        "ARMATURE",
        object=character.armature,
        use_multi_modifier=True,
        use_deform_preserve_volume=True,
        vertex_group=character.body.vertex_groups[BONE_COUNT // 2].name,
    )


def _add_hook(character: Character) -> None:
    hook = bpy.data.objects.new("Hook", None)
    bpy.context.scene.collection.objects.link(hook)
    hook.location = (0.5, 0.0, 2.0)
    modifier = _add(character, "HOOK", object=hook, falloff_radius=0.5, strength=0.5)
    positions = np.empty(3 * len(character.body.data.vertices), np.float32)
    character.body.data.attributes["position"].data.foreach_get("vector", positions)
    near = np.linalg.norm(positions.reshape(-1, 3) - hook.location, axis=1) < modifier.falloff_radius
    modifier.vertex_indices_set(np.flatnonzero(near).tolist())
    hook.location.x += 0.3


def timed(stack: Stack, body: bpy.types.Object, turn_count: int) -> Times:
    """The least of each, with Turgor as the last modifier."""
    must_turn_on(body, stack.name)
    ours = volume_modifier(body)
    start = process_time()
    body.modifiers.move(list(body.modifiers).index(ours), len(body.modifiers) - 1)
    bpy.context.view_layer.update()
    bpy.ops.object.turgor_volume_rebind()
    bpy.context.scene.frame_set(bpy.context.scene.frame_start + STEP)
    first = 1000.0 * (process_time() - start)
    alone, bare, whole = [], [], []
    for _ in range(turn_count):
        ours.show_viewport = False
        with quiet():
            alone += frame_durations(process_time)
        ours.show_viewport = True
        with idle_engine():
            bare += frame_durations(process_time)
        whole += frame_durations(process_time)
    return Times(min(alone), min(bare), min(whole), first)


@contextmanager
def idle_engine() -> Iterator[None]:
    """Within it all of a frame is done but the correction: offsets are as they were."""
    engines = extension_module("live.engines")
    settled = engines.settled

    def idle(*arguments: Any) -> Any:
        found = settled(*arguments)
        return found._replace(engine=IdleEngine())

    engines.settled = idle
    try:
        yield
    finally:
        engines.settled = settled


class IdleEngine:
    """What a frame asks of an engine, not done."""

    def deform_into_address(self, *_: object, **__: object) -> None:
        """Nothing."""
