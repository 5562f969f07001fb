"""Prints what an event costs with the add-on on and nothing of it in the scene: python tests/blender/idle_cost.py"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import bpy

ROUNDS = 2000


def microseconds(call: Callable[..., object], *arguments: object) -> float:
    """Median of many calls."""
    times = []
    for _ in range(ROUNDS):
        started = perf_counter()
        call(*arguments)
        times.append(perf_counter() - started)
    return 1e6 * sorted(times)[ROUNDS // 2]


def main() -> None:
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    bpy.ops.wm.read_factory_settings()
    package = importlib.import_module("addon")
    package.register()
    for number in range(1000):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(f"Empty {number}", None))
    handlers = importlib.import_module("addon.handlers")
    overlays = [importlib.import_module(f"addon.overlays.{name}") for name in ("volume", "spine")]
    scene, depsgraph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    handlers.load_post()
    print("microseconds per event, in a scene of a thousand objects without Turgor")
    groups = {
        "update of the scene": [(handlers.depsgraph_update_post, (scene, depsgraph))],
        "frame": [(handlers.frame_change_pre, (scene,)), (handlers.frame_change_post, (scene, depsgraph))],
        "redraw of a viewport": [
            (overlays[0].draw_in_space, ()),
            (overlays[0].draw_on_top, ()),
            (overlays[1].draw, ()),
        ],
        "timer": [(handlers.follow_dragged_curve, ())],
    }
    for name, calls in groups.items():
        print(f"{sum(microseconds(call, *arguments) for call, arguments in calls):8.2f}  {name}")
    package.unregister()
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
