"""Add Turgor Volume to the selected characters."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from .. import runtime
from ..live import housekeeping, measuring, push, route_choice, sampling
from ..messages import message, of_error, translated
from ..scene import modifier_places, node_group, obstacles, stack
from .polling import in_edit_mode, is_allowed, linked


class OBJECT_OT_turgor_volume_add(bpy.types.Operator):
    bl_idname = "object.turgor_volume_add"
    bl_label = "Turgor Volume"
    bl_description = "Keep the exact volume of the selected meshes while their armature bends them"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = context.object
        if not is_allowed(cls, in_edit_mode(context.mode)):
            return False
        meshes = [ob for ob in {context.object, *context.selected_objects} if ob is not None and ob.type == "MESH"]
        if not meshes:
            cls.poll_message_set("Select a mesh that an armature deforms")
            return False
        return is_allowed(cls, _refusal(ob) if ob in meshes and len(meshes) == 1 else None)

    def execute(self, context: bpy.types.Context) -> set[str]:
        added: list[bpy.types.Object] = []
        with runtime.quiet():
            route_choice.choose()
            for ob in sorted({context.object, *context.selected_objects} - {None}, key=lambda ob: ob.name):
                if ob.type != "MESH":
                    continue
                reason = _refusal(ob) or _add(ob)
                if reason is None:
                    added.append(ob)
                else:
                    self.report({"WARNING"}, f"{ob.name}: {translated(reason, rpt_)}")
            depsgraph = context.evaluated_depsgraph_get()
            if runtime.session.route == "PUSH":
                push.write_all(depsgraph)
        for ob in added:
            _look_over(context.scene, ob)
        return {"FINISHED"} if added else {"CANCELLED"}


CLASSES = (OBJECT_OT_turgor_volume_add,)


def _look_over(scene: bpy.types.Scene, ob: bpy.types.Object) -> None:
    """Find the joints that matter, and show the settings of the one that matters most."""
    if runtime.character(ob.session_uid).binding is None:
        return
    try:
        measuring.measure(ob, sampling.quick_frames(ob, sampling.scene_frames(scene)))
    except ValueError as error:
        # A frame elsewhere is broken; the character itself is fine.
        runtime.log.warning("%s: not measured: %s", ob.name, error)
    housekeeping.choose_joint(ob)


def _add(ob: bpy.types.Object) -> str | None:
    """Why nothing was added; None where Turgor Volume keeps the volume now."""
    try:
        housekeeping.add(ob)
    except modifier_places.PlaceError as error:
        return of_error(error)
    problem = runtime.character(ob.session_uid).problem
    if problem is not None:
        housekeeping.remove(ob)
    return problem


def _refusal(ob: bpy.types.Object) -> str | None:
    reason = linked(ob)
    if reason is None and stack.volume_modifier(ob) is not None:
        reason = message("The object has Turgor Volume already")
    if reason is None and (found := obstacles.obstacle(ob)) is not None:
        reason = found.text
    return reason or modifier_places.refusal(ob, stack.place_for_new(ob), node_group.VOLUME.label)


def draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.operator(OBJECT_OT_turgor_volume_add.bl_idname, icon="MOD_ARMATURE")


def register() -> None:
    bpy.types.OBJECT_MT_modifier_add_deform.append(draw)


def unregister() -> None:
    bpy.types.OBJECT_MT_modifier_add_deform.remove(draw)
