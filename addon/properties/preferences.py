"""The extension's preferences."""

from pathlib import Path

import bpy
from bpy.props import EnumProperty

ROUTES = (
    ("AUTOMATIC", "Automatic", "Pull where a self-test proves that it works, else push"),
    ("PULL", "Pull", "Blender's dependency graph asks for the correction: one evaluation per frame"),
    ("PUSH", "Push", "Frame handlers write the correction: two evaluations per frame"),
)


# Written by `make package`.
MANUAL = Path(__file__).resolve().parents[1] / "manual" / "index.html"


class TurgorPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__.rpartition(".")[0]

    route: EnumProperty(
        name="Route",
        description="How the correction reaches the mesh",
        items=ROUTES,
    )

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop(self, "route")
        buttons = self.layout.row()
        buttons.operator("preferences.turgor_asset_library", icon="ASSET_MANAGER")
        if MANUAL.is_file():
            buttons.operator("wm.url_open", text="Manual", icon="HELP").url = MANUAL.as_uri()
