"""The manual's pictures: `blender --factory-startup elephant.blend --python manual/pictures.py -- FOLDER [turgor.zip]`.

Needs an X server (Xvfb will do) and ImageMagick. Ends Blender, with 1 where a picture failed.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from manual.window import Picture, area, of_area, take, whole

# A frame at which the elephant bends, and what of it is shown.
FRAME = 10
KNEE = "leg_front_lower.L"


def character() -> bpy.types.Object:
    """The mesh that bends most."""
    skinned = [ob for ob in bpy.data.objects if any(modifier.type == "ARMATURE" for modifier in ob.modifiers)]
    return max(skinned, key=lambda ob: len(ob.data.vertices))


def prepare() -> None:
    """The elephant alone, the modifier tab beside it."""
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.view.show_developer_ui = False
    bpy.context.scene.frame_set(FRAME)
    ob = character()
    for other in bpy.context.view_layer.objects:
        other.select_set(other == ob)
    bpy.context.view_layer.objects.active = ob
    make_room()
    area("PROPERTIES").spaces.active.context = "MODIFIER"
    view = area("VIEW_3D")
    view.spaces.active.overlay.show_bones = False
    in_view(bpy.ops.view3d.view_selected)


def make_room() -> None:
    """The properties editor over the whole height, in place of the outliner above it."""
    if any(found.type == "OUTLINER" for found in bpy.context.window.screen.areas):
        kept, lost = area("PROPERTIES"), area("OUTLINER")
        middle = kept.x + kept.width // 2
        bpy.ops.screen.area_join(
            source_xy=(middle, kept.y + kept.height // 2), target_xy=(middle, lost.y + lost.height // 2)
        )


def in_view(operator: Callable[..., object], *arguments: object, **options: object) -> None:
    """Runs an operator in the viewport."""
    found = area("VIEW_3D")
    region = next(region for region in found.regions if region.type == "WINDOW")
    with bpy.context.temp_override(area=found, region=region):
        operator(*arguments, **options)


def add() -> None:
    """One click."""
    prepare()
    bpy.context.window.cursor_warp(5, 5)
    in_view(bpy.ops.object.turgor_volume_add)


def choose_muscle() -> None:
    """Its three curves."""
    saved = character().turgor
    saved.active_joint = max(saved.joints.find(KNEE), 0)
    saved.joints[saved.active_joint].preset = "MUSCLE"
    saved.display.show_axes = True


def show_heat() -> None:
    """Colours, axes, volumes."""
    bpy.ops.object.turgor_volume_measure()
    display = character().turgor.display
    display.heat = "DISPLACEMENT"
    display.show_readout = display.show_joint_readout = display.show_graph = True


def paint_mask() -> None:
    """A new group, in Weight Paint."""
    display = character().turgor.display
    display.heat, display.show_joint_readout, display.show_graph, display.show_axes = "NONE", False, False, False
    in_view(bpy.ops.object.turgor_mask_paint, mask="vertex_group")


def break_something() -> None:
    """Another modifier before the Armature."""
    if bpy.context.mode != "OBJECT":
        in_view(bpy.ops.object.mode_set, mode="OBJECT")
    ob = character()
    ob.turgor.vertex_group = ""
    lattice = ob.modifiers.new("Wave", "WAVE")
    ob.modifiers.move(len(ob.modifiers) - 1, 0)
    lattice.show_expanded = False


def show_menu() -> None:
    """Add Modifier, Deform; the last, since nothing closes a menu but the artist."""
    found = area("VIEW_3D")
    bpy.context.window.cursor_warp(found.x + found.width // 2, found.y + found.height * 2 // 3)
    in_view(bpy.ops.wm.call_menu, name="OBJECT_MT_modifier_add_deform")


PICTURES = (
    Picture("joints", add, whole),
    Picture("curves", choose_muscle, of_area("PROPERTIES")),
    Picture("heat", show_heat, of_area("VIEW_3D")),
    Picture("mask", paint_mask, whole),
    Picture("diagnostics", break_something, of_area("PROPERTIES")),
    Picture("add", show_menu, of_area("VIEW_3D")),
)


def main() -> None:
    """Installs the zip where one is named, and takes all pictures."""
    folder, *archives = sys.argv[sys.argv.index("--") + 1 :]
    for archive in archives:
        bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
    take(PICTURES, Path(folder), lambda is_well: os._exit(0 if is_well else 1))


if __name__ == "__main__":
    main()
