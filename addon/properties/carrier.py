"""Settings of a carrier, the hidden object that holds the offset of every vertex: `Object.turgor.carrier`."""

from collections.abc import Callable
from typing import ClassVar

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, PointerProperty

from .tagging import OVERRIDABLE


def ignore_tick(carrier: "TurgorCarrier") -> None:
    """What a tick does while no route is registered."""


class TurgorCarrier(bpy.types.PropertyGroup):
    """On the carrier only."""

    # Called with the evaluated group whenever the dependency graph reads `tick`, perhaps on a worker thread.
    # It must not raise, and must not call anything that tags data.
    on_tick: ClassVar[Callable[["TurgorCarrier"], None]] = staticmethod(ignore_tick)

    def _tick(self) -> float:
        TurgorCarrier.on_tick(self)
        return 0.0

    tick: FloatProperty(get=_tick, override=OVERRIDABLE, options={"HIDDEN"})
    kind: EnumProperty(
        items=(("VOLUME", "Turgor Volume", ""), ("SPINE", "Turgor Spine", "")),
        override=OVERRIDABLE,
        options={"HIDDEN"},
    )
    mesh: PointerProperty(type=bpy.types.Mesh, override=OVERRIDABLE)
    target: PointerProperty(type=bpy.types.Object, override=OVERRIDABLE)
    # Of a character that is read as Blender evaluates it, see `scene.twin`; `is_twin` is set on those alone.
    pose_twin: PointerProperty(type=bpy.types.Object, override=OVERRIDABLE)
    body_twin: PointerProperty(type=bpy.types.Object, override=OVERRIDABLE)
    is_twin: BoolProperty(override=OVERRIDABLE, options={"HIDDEN"})
