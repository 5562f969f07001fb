"""Settings of baking and the report of the last bake: `Object.turgor_bake`, on characters and on their baked copies."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from .tagging import OVERRIDABLE

METHODS = (
    ("ABSOLUTE", "Shape Keys", "One shape key per frame on a copy without armature"),
    ("CORRECTIVE", "Corrective Keys", "One shape key per frame before the Armature, which still moves the copy"),
    ("REDUCED", "Reduced Correctives", "As few keyed correctives before the Armature as keep the error asked for"),
    ("DRIVEN", "Pose Correctives", "Correctives that the pose drives: new animation needs no new bake"),
    ("POINT_CACHE", "Point Cache", "A PC2 file with the points of every frame, read by a Mesh Cache modifier"),
)
UNITS = (
    ("PERCENT", "Percent", "Part of the size of the mesh, the diagonal of its bounds"),
    ("LENGTH", "Length", "Length in the scene"),
)


class TurgorBake(bpy.types.PropertyGroup):
    """Settings of baking."""

    method: EnumProperty(
        name="Bake", description="What keeps the result", items=METHODS, override=OVERRIDABLE, options=set()
    )
    frames: StringProperty(
        name="Frames",
        description="Frames to bake, such as 1-100, 1-100x2 for every second one, or 1-100x0.25 for steps within"
        " frames. Empty: the scene's range",
        override=OVERRIDABLE,
        options=set(),
    )
    unit: EnumProperty(
        name="Error In", description="What the error is measured in", items=UNITS, override=OVERRIDABLE, options=set()
    )
    error_percent: FloatProperty(
        name="Largest Error",
        description="How far any vertex may be from the live mesh on any frame",
        default=0.1,
        min=0.0001,
        soft_max=1.0,
        max=100.0,
        precision=3,
        subtype="PERCENTAGE",
        override=OVERRIDABLE,
        options=set(),
    )
    error_length: FloatProperty(
        name="Largest Error",
        description="How far any vertex may be from the live mesh on any frame",
        default=0.001,
        min=1e-7,
        soft_max=0.1,
        precision=4,
        subtype="DISTANCE",
        override=OVERRIDABLE,
        options=set(),
    )
    unit_values: BoolProperty(
        name="Values 0 to 1",
        description="No negative values, for engines that clamp them: one more key, which is always on, or keys for"
        " both directions where they are local to joints",
        override=OVERRIDABLE,
        options=set(),
    )
    local_keys: BoolProperty(
        name="Local to Joints",
        description="Every key moves the skin around one joint only and is named after its bone, so that it can be"
        " sculpted on; takes more keys",
        override=OVERRIDABLE,
        options=set(),
    )
    most_keys: IntProperty(
        name="Most Keys",
        description="Pose correctives to have at most",
        default=64,
        min=1,
        soft_max=256,
        override=OVERRIDABLE,
        options=set(),
    )
    influences: IntProperty(
        name="Bones per Vertex",
        description="Largest weights of each vertex that the target keeps, 0 for all; game engines keep 4",
        min=0,
        max=32,
        override=OVERRIDABLE,
        options=set(),
    )
    use_linear: BoolProperty(
        name="Linear Skinning",
        description="The target blends bones linearly, as game engines do, also where the Armature preserves volume",
        override=OVERRIDABLE,
        options=set(),
    )
    folder: StringProperty(
        name="Folder",
        description="Where point caches, reports and unfinished bakes are kept",
        default="//turgor_bake/",
        subtype="DIR_PATH",
        override=OVERRIDABLE,
        # Else Blender shows the path in red.
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    verify: BoolProperty(
        name="Verify",
        description="Play the bake in Blender and compare it with the live character, and on every frame with what was"
        " computed",
        default=True,
        override=OVERRIDABLE,
        options=set(),
    )
    every_frame: BoolProperty(
        name="On Every Frame",
        description="Compare every frame with the live character. Off: the first and the last, those at which joints"
        " are worst, and some between",
        override=OVERRIDABLE,
        options=set(),
    )
    repair_folds: BoolProperty(
        name="Repair Folds",
        description="Repair folds on every frame of the bake, also where Turgor Volume does not",
        override=OVERRIDABLE,
        options=set(),
    )
    hide_original: BoolProperty(
        name="Hide Original",
        description="Hide the live mesh in the viewport and in renders when its bake is there",
        default=True,
        override=OVERRIDABLE,
        options=set(),
    )
    # Of the last bake: its copy, on the copy the original, and lines for the panel.
    other: PointerProperty(type=bpy.types.Object, override=OVERRIDABLE, options={"HIDDEN"})
    report: StringProperty(override=OVERRIDABLE, options={"HIDDEN"})
