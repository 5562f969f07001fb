"""What every setting has: it can be overridden, and a change of it is seen at once."""

import bpy

OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}


def tag(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """What a script sets without this is not seen until something else changes."""
    settings.id_data.update_tag()
