"""File > Export > Turgor: Blender's own exporters, with the volume kept."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from turgor import TurgorError

from ..bake import exports, reimport
from ..logic import file_names
from ..messages import message, of_error, translated
from .polling import in_edit_mode, is_allowed

FORMATS = (
    ("GLTF", "glTF 2.0", "Armature and shape keys, for engines and the web"),
    ("FBX", "FBX", "Armature and shape keys, for engines and other programs"),
    ("USD", "USD", "Every frame of the mesh, without armature"),
    ("ALEMBIC", "Alembic", "Every frame of the mesh, without armature"),
)
# What is written for each suffix, and others of the same format.
KEPT_SUFFIXES = {".glb": {".gltf"}, ".usdc": {".usd", ".usda", ".usdz"}, ".fbx": set(), ".abc": set()}


class EXPORT_SCENE_OT_turgor(bpy.types.Operator):
    bl_idname = "export_scene.turgor"
    bl_label = "Export with Volume"
    bl_description = (
        "Write the selected characters over the scene's frames by Blender's own exporter, so that they keep their"
        " volume where there is no Turgor"
    )
    bl_options = {"REGISTER", "PRESET"}

    filepath: StringProperty(subtype="FILE_PATH", options={"SKIP_SAVE"})
    # The file browser warns of a file that is there.
    check_existing: BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})
    filter_glob: StringProperty(default="*.glb;*.gltf;*.fbx;*.usd;*.usda;*.usdc;*.usdz;*.abc", options={"HIDDEN"})
    format: EnumProperty(name="Format", description="What is written", items=FORMATS)
    error: FloatProperty(
        name="Largest Error",
        description="How far any vertex may be from the live mesh on any frame, in percent of its size; as few shape"
        " keys as keep it, 0 for one key per frame",
        default=0.01,
        min=0.0,
        soft_max=1.0,
        max=100.0,
        precision=3,
        subtype="PERCENTAGE",
    )
    verify: BoolProperty(
        name="Verify",
        description="Import the file again, in a Blender of its own, and compare shape and volume with the live mesh",
        default=True,
    )
    influences: IntProperty(
        name="Bones per Vertex",
        description="Largest weights of each vertex that the target keeps, 0 for all; game engines keep 4",
        default=4,
        min=0,
        max=32,
    )

    local_keys: BoolProperty(
        name="Local to Joints",
        description="Every key moves the skin around one joint only and is named after its bone, so that it can be"
        " sculpted on; takes more keys",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        found = None if characters(context) else message("Select a mesh with Turgor Volume or Turgor Spine")
        return is_allowed(cls, in_edit_mode(context.mode) or found)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not self.filepath:
            suffix = exports.SUFFIXES[self.format]
            saved = Path(bpy.data.filepath)
            first = characters(context)[0]
            library = "" if first.library is None else first.library.filepath
            start = saved.with_suffix("") if bpy.data.filepath else Path(file_names.file_stem(first.name, library))
            self.filepath = str(start.with_name(start.name + suffix))
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def check(self, context: bpy.types.Context) -> bool:
        """The file is named after the format."""
        path = self._path()
        changed = self.filepath != str(path)
        self.filepath = str(path)
        return changed

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.prop(self, "format")
        if self.format in exports.WITH_KEYS:
            column.prop(self, "error")
            column.prop(self, "influences")
            reduced = column.row()
            reduced.active = self.error > 0.0
            reduced.prop(self, "local_keys")
        column.prop(self, "verify")

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = exports.Settings(
            self.format, self._path(), 0.01 * self.error, self.influences, local_keys=self.local_keys
        )
        targets = characters(context)
        try:
            reports = exports.export(targets, settings)
        except (ValueError, OSError, TurgorError) as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        for report in reports:
            for note in report.notes:
                self.report({"WARNING"}, ": ".join((report.name, translated(note, rpt_))))
            self.report({"INFO"}, f"{report.name}: {', '.join(report.lines()[1:4])}")
        if self.verify and not any(report.notes for report in reports):
            self._compare(targets, settings)
        return {"FINISHED"}

    def _compare(self, targets: list[bpy.types.Object], settings: exports.Settings) -> None:
        try:
            found = reimport.compare(targets, settings)
        except ValueError as error:
            self.report({"WARNING"}, translated(of_error(error), rpt_))
            return
        most = reimport.tolerance_percent(settings)
        for name, each in found.items():
            error, volume = 100.0 * each.max_error_relative, 100.0 * each.volume_error_relative
            text = message(
                "{name}: imported again, largest error {error:.2g} % of the size, volume within {volume:.2g} %",
                name=name,
                error=error,
                volume=volume,
            )
            is_fine = error <= most and volume <= reimport.VOLUME_PERCENT
            self.report({"INFO"} if is_fine else {"WARNING"}, translated(text, rpt_))

    def _path(self) -> Path:
        path, suffix = Path(bpy.path.abspath(self.filepath)), exports.SUFFIXES[self.format]
        known = frozenset(each for pair in KEPT_SUFFIXES.items() for each in (pair[0], *pair[1]))
        is_right = path.suffix.lower() in {suffix, *KEPT_SUFFIXES[suffix]}
        return path if is_right else file_names.with_ending(path, suffix, known)


class TURGOR_MT_export(bpy.types.Menu):
    bl_label = "Turgor"
    bl_description = "Formats that keep the exact volume where there is no Turgor"

    def draw(self, context: bpy.types.Context) -> None:
        for name, label, _ in FORMATS:
            suffix = exports.SUFFIXES[name]
            operator = self.layout.operator(EXPORT_SCENE_OT_turgor.bl_idname, text=f"{label} ({suffix})")
            operator.format = name


CLASSES = (EXPORT_SCENE_OT_turgor, TURGOR_MT_export)


def characters(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Selected ones, also by selecting their armature."""
    chosen = [ob for ob in {context.object, *context.selected_objects} if ob is not None]
    rigs = {ob for ob in chosen if ob.type == "ARMATURE"}
    found = {ob for ob in chosen if exports.has_turgor(ob)}
    for ob in context.view_layer.objects:
        if exports.has_turgor(ob) and any(each.type == "ARMATURE" and each.object in rigs for each in ob.modifiers):
            found.add(ob)
    return sorted(found, key=lambda ob: ob.name)


def draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.menu("TURGOR_MT_export")


def register() -> None:
    bpy.types.TOPBAR_MT_file_export.append(draw)


def unregister() -> None:
    bpy.types.TOPBAR_MT_file_export.remove(draw)
