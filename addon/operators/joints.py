"""What the menu beside the list of joints does."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty

from ..live import joint_edits
from ..messages import message, of_error, translated
from ..properties.joint_names import bone_of
from ..properties.selected_joints import edited_joints
from ..scene import bone_choice, stack
from .character import character_of
from .polling import is_allowed, linked, without_volume


class _JointOperator:
    """On the joints of the character that is shown."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        ob = character_of(context)
        if without_volume(ob) is not None or not len(ob.turgor.joints):
            cls.poll_message_set("The active object has no joints of Turgor Volume")
            return False
        return is_allowed(cls, linked(ob))


class OBJECT_OT_turgor_joints_copy(_JointOperator, bpy.types.Operator):
    bl_idname = "object.turgor_joints_copy"
    bl_label = "Copy to Selected"
    bl_description = "Give the selected joints all settings and curves of the active one"

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not joint_edits.copy_to_selected(character_of(context)):
            self.report({"WARNING"}, "No other joint is selected: tick some in the list")
            return {"CANCELLED"}
        return {"FINISHED"}


class OBJECT_OT_turgor_joints_mirror(_JointOperator, bpy.types.Operator):
    bl_idname = "object.turgor_joints_mirror"
    bl_label = "Mirror"
    bl_description = (
        "Give the joints on the other side of the body, by the names of their bones, all settings and curves of the"
        " active and the selected ones"
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        count, missing = joint_edits.mirror(character_of(context))
        if missing:
            text = message("No joint on the other side of {joints}", joints=", ".join(missing))
            self.report({"WARNING"}, translated(text, rpt_))
        elif not count:
            self.report({"WARNING"}, "The names of these joints have no side, like Arm.L or left_arm")
        return {"FINISHED"} if count else {"CANCELLED"}


class OBJECT_OT_turgor_joints_select(_JointOperator, bpy.types.Operator):
    bl_idname = "object.turgor_joints_select"
    bl_label = "Select Joints"
    bl_description = "Choose which joints are edited together"

    action: EnumProperty(
        name="Action",
        description="Which joints to select",
        items=(
            ("ALL", "All", "Select all joints"),
            ("NONE", "None", "Deselect all joints"),
            ("INVERT", "Invert", "Select the others"),
        ),
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        joint_edits.select(character_of(context), self.action)
        return {"FINISHED"}


class OBJECT_OT_turgor_joints_reset(_JointOperator, bpy.types.Operator):
    bl_idname = "object.turgor_joints_reset"
    bl_label = "Reset"
    bl_description = "Give the active and the selected joints the settings of a new one"

    def execute(self, context: bpy.types.Context) -> set[str]:
        joint_edits.reset(edited_joints(character_of(context).turgor))
        return {"FINISHED"}


class OBJECT_OT_turgor_joint_to_bone(_JointOperator, bpy.types.Operator):
    bl_idname = "object.turgor_joint_to_bone"
    bl_label = "Select Bone"
    bl_description = "Enter Pose Mode and select the bone of the active joint"

    def execute(self, context: bpy.types.Context) -> set[str]:
        ob = character_of(context)
        armature = stack.armature_modifier(ob)
        joints = edited_joints(ob.turgor)
        if armature is None or armature.object is None or not joints:
            self.report({"ERROR"}, "The character has no armature, or no joint is active")
            return {"CANCELLED"}
        try:
            bone_choice.choose_bone(context, armature.object, bone_of(joints[0].name))
        except bone_choice.ChoiceError as error:
            self.report({"ERROR"}, translated(of_error(error), rpt_))
            return {"CANCELLED"}
        return {"FINISHED"}


class OBJECT_OT_turgor_joint_from_bone(_JointOperator, bpy.types.Operator):
    bl_idname = "object.turgor_joint_from_bone"
    bl_label = "Joint of Active Bone"
    bl_description = "Show the settings of the joint at the armature's active bone"

    def execute(self, context: bpy.types.Context) -> set[str]:
        ob = character_of(context)
        armature = stack.armature_modifier(ob)
        name = "" if armature is None or armature.object is None else bone_choice.active_bone_name(armature.object)
        place = ob.turgor.joints.find(name)
        if place < 0:
            self.report({"WARNING"}, "The active bone has no joint" if name else "The armature has no active bone")
            return {"CANCELLED"}
        ob.turgor.active_joint = place
        return {"FINISHED"}


CLASSES = (
    OBJECT_OT_turgor_joints_copy,
    OBJECT_OT_turgor_joints_mirror,
    OBJECT_OT_turgor_joints_select,
    OBJECT_OT_turgor_joints_reset,
    OBJECT_OT_turgor_joint_to_bone,
    OBJECT_OT_turgor_joint_from_bone,
)
