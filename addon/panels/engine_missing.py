"""What the modifier tab shows when the compiled engine cannot be used."""

from __future__ import annotations

from typing import ClassVar

import bpy

from .modifier_tab import ModifierTab


class TURGOR_PT_engine_missing(ModifierTab, bpy.types.Panel):
    bl_label = "Turgor Volume"

    problem: ClassVar[str] = ""

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.label(text="Turgor cannot run here; meshes show plain skinning.", icon="ERROR")
        column.label(text=self.problem)


def is_registered() -> bool:
    return hasattr(bpy.types, TURGOR_PT_engine_missing.__name__)


def register(problem: str) -> None:
    TURGOR_PT_engine_missing.problem = problem
    bpy.utils.register_class(TURGOR_PT_engine_missing)


def unregister() -> None:
    bpy.utils.unregister_class(TURGOR_PT_engine_missing)
