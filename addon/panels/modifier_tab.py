"""Where panels of modifiers stand."""


class ModifierTab:
    """The modifier tab of the properties editor."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "modifier"
