"""Refine a character's mesh where its joints give volume back."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..live import refining
from ..messages import message, of_error, translated
from ..properties import refine as properties
from .character import character_of
from .modal import progress_shown
from .polling import in_edit_mode, is_allowed, linked, linked_mesh, without_volume


class OBJECT_OT_turgor_refine(bpy.types.Operator):
    bl_idname = "object.turgor_refine"
    bl_label = "Refine"
    bl_description = (
        "Split faces where joints give back volume over the scene's frames, or its preview range;"
        " all that the mesh carries goes along"
    )
    bl_options = {"REGISTER", "UNDO"}

    __annotations__ = properties.settings()

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = character_of(context)
        elsewhere = message("The mesh is linked: refine it in its own file")
        return is_allowed(cls, without_volume(ob) or linked(ob) or linked_mesh(ob, elsewhere) or in_edit_mode(ob.mode))

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        for name in ("threshold", "use_automatic", "levels", "method"):
            layout.prop(self, name)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Refine with the settings that the panel shows."""
        saved = character_of(context).turgor.refine
        for name in properties.settings():
            if not self.properties.is_property_set(name):
                setattr(self, name, getattr(saved, name))
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        ob = character_of(context)
        try:
            with progress_shown(context, len(refining.frames(ob))) as tell:
                made = refining.refine(ob, refining.options_of(self), tell)
        except ValueError as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        ob.turgor.refine.show_preview = False
        if not made.face_count:
            self.report({"INFO"}, rpt_("No face is refined: nothing there asks for more, or the threshold is too high"))
            return {"CANCELLED"}
        for name in refining.loose_modifiers(ob.data):
            text = rpt_("{modifier} was bound to the mesh as it was: bind it again")
            self.report({"WARNING"}, text.format(modifier=name))
        text = rpt_("{count:,} of {all:,} faces refined, {vertices:,} vertices now").format(
            count=made.face_count, all=made.all_face_count, vertices=made.vertex_count
        )
        if made.short_count:
            more = rpt_("{count:,} faces ask for more than {levels} levels")
            text = f"{text}; {more.format(count=made.short_count, levels=self.levels)}"
        self.report({"INFO"}, text)
        return {"FINISHED"}


CLASSES = (OBJECT_OT_turgor_refine,)
