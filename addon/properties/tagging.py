"""What every setting has: it can be overridden, and a change of it is seen at once."""

import bpy

OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}

# Session uids of objects whose settings were changed since `take_changed` was asked.
_changed: set[int] = set()


def tag(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """What a script sets without this is not seen until something else changes."""
    settings.id_data.update_tag()
    _changed.add(settings.id_data.session_uid)


def take_changed(uid: int) -> bool:
    """Whether a setting of this object explains an update of it: Blender then says that its mesh changed too."""
    is_changed = uid in _changed
    _changed.discard(uid)
    return is_changed
