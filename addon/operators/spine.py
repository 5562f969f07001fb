"""Turgor Spine: add it, bind again, take a new rest, remove it."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from .. import runtime
from ..live import push, route_choice, spine_binding, spine_housekeeping
from ..messages import message, of_error, translated
from ..properties.spine import DATA_VERSION
from ..scene import modifier_places, spine_chain, spine_stack
from .polling import in_edit_mode, is_allowed, linked


class OBJECT_OT_turgor_spine_add(bpy.types.Operator):
    bl_idname = "object.turgor_spine_add"
    bl_label = "Turgor Spine"
    bl_description = "Bend the active mesh along a chain of bones or a curve, every chunk of it keeping its volume"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not is_allowed(cls, in_edit_mode(context.mode)):
            return False
        body = None if context.object is None else _body(context)
        if body is None:
            cls.poll_message_set("Select a mesh")
            return False
        has_spine = spine_stack.spine_modifier(body) is not None
        return is_allowed(cls, linked(body) or (message("The object has Turgor Spine already") if has_spine else None))

    def execute(self, context: bpy.types.Context) -> set[str]:
        body = _body(context)
        with runtime.quiet():
            route_choice.choose()
            _choose_spine(context, body)
            try:
                spine_housekeeping.add(body)
            except modifier_places.PlaceError as error:
                spine_housekeeping.forget_settings(body)
                self.report({"WARNING"}, f"{body.name}: {translated(of_error(error), rpt_)}")
                return {"CANCELLED"}
            depsgraph = context.evaluated_depsgraph_get()
            if runtime.session.route == "PUSH":
                push.write_all(depsgraph)
        problem = runtime.spine(body.session_uid).problem
        if problem is not None:
            self.report({"WARNING"}, f"{body.name}: {translated(problem, rpt_)}")
        return {"FINISHED"}


class OBJECT_OT_turgor_spine_rebind(bpy.types.Operator):
    bl_idname = "object.turgor_spine_rebind"
    bl_label = "Rebind"
    bl_description = "Read the mesh again, and take the spine as it rests now: bones in rest, the curve as it is"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _has_own(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        spine_binding.rebind(context.object, context.scene.frame_current)
        return {"FINISHED"}


class OBJECT_OT_turgor_spine_remove(bpy.types.Operator):
    bl_idname = "object.turgor_spine_remove"
    bl_label = "Remove Turgor Spine"
    bl_description = "Remove Turgor Spine from the active mesh, with its settings and all that it made"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _has_own(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        with runtime.quiet():
            spine_housekeeping.remove(context.object)
        return {"FINISHED"}


CLASSES = (
    OBJECT_OT_turgor_spine_add,
    OBJECT_OT_turgor_spine_rebind,
    OBJECT_OT_turgor_spine_remove,
)


def draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.operator(OBJECT_OT_turgor_spine_add.bl_idname, icon="CURVE_BEZCURVE")


def _body(context: bpy.types.Context) -> bpy.types.Object | None:
    """The active mesh; in pose mode, or with the spine active, the only selected one."""
    if context.object is not None and context.object.type == "MESH":
        return context.object
    meshes = [ob for ob in context.selected_objects if ob.type == "MESH"]
    return meshes[0] if len(meshes) == 1 else None


def _has_own(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    ob = context.object
    if ob is None or ob.library is not None or ob.type != "MESH" or spine_stack.spine_modifier(ob) is None:
        operator.poll_message_set("The active object has no Turgor Spine of its own")
        return False
    return is_allowed(operator, in_edit_mode(ob.mode))


def _choose_spine(context: bpy.types.Context, body: bpy.types.Object) -> None:
    """Choose as the body's spine what is selected with it, else the armature that bends it, else nothing yet."""
    saved = body.turgor_spine
    saved.version = DATA_VERSION
    others = [ob for ob in (*context.selected_objects, context.object) if ob not in {None, body}]
    curves = [ob for ob in others if ob.type == "CURVE"]
    rigs = [ob for ob in others if ob.type == "ARMATURE"]
    rigs += [m.object for m in body.modifiers if m.type == "ARMATURE" and m.object is not None]
    if curves:
        saved.source, saved.curve = "CURVE", curves[0]
    elif rigs:
        saved.source, saved.rig = "BONES", rigs[0]
        chosen = [bone.name for bone in context.selected_pose_bones or () if bone.id_data == rigs[0]]
        saved.first_bone, saved.last_bone = spine_chain.suggest(rigs[0], chosen)


def register() -> None:
    bpy.types.OBJECT_MT_modifier_add_deform.append(draw)


def unregister() -> None:
    bpy.types.OBJECT_MT_modifier_add_deform.remove(draw)
