"""A plain copy of a character that carries a bake: modifiers before the Armature applied, ours gone, the rest kept."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from . import modifier_places, plain_rig, rest


def make(
    target: bpy.types.Object, end: bpy.types.Modifier, frame: int, removed: Sequence[bpy.types.Modifier], name: str
) -> bpy.types.Object:
    """A copy of `target` to bake into, in the same collections.

    end: modifiers before it are applied, as they are at `frame`. removed: go without a trace.
    """
    mesh = rest.rest_mesh(target, end, frame)
    copy = target.copy()
    copy.name = mesh.name = name
    modifiers = list(target.modifiers)
    gone = [modifier.name for modifier in (*modifiers[: modifiers.index(end)], *removed)]
    for member in gone:
        rest.remove_with_drivers(copy, copy.modifiers[member])
    copy.data = mesh
    copy.property_unset("turgor")
    copy.property_unset("turgor_spine")
    if copy.parent_type == "ARMATURE":
        # Blender would skin it once more.
        copy.parent_type = "OBJECT"
    # Blender links nothing into collections that are linked or overridden.
    own = [each for each in target.users_collection if each.library is None and each.override_library is None]
    for collection in own or [bpy.context.scene.collection]:
        collection.objects.link(copy)
    copy.select_set(False)
    return copy


def discard(copy: bpy.types.Object) -> None:
    """Delete a baked copy with its mesh and the action of its keys."""
    mesh = copy.data
    keys = mesh.shape_keys
    doubles = plain_rig.doubles_of(copy)
    action = None if keys is None or keys.animation_data is None else keys.animation_data.action
    bpy.data.objects.remove(copy)
    if mesh.users == 0:
        bpy.data.meshes.remove(mesh)
    if action is not None and action.users == 0:
        bpy.data.actions.remove(action)
    for double in doubles:
        plain_rig.discard(double)


def follow_point_cache(copy: bpy.types.Object, path: str, first_frame: float, samples_per_frame: float, at: int) -> str:
    """A Mesh Cache modifier at place `at` of the stack: its name. path: of a PC2 file, absolute or `//`.

    Raises modifier_places.PlaceError.
    """
    cache = copy.modifiers.new("Mesh Cache", "MESH_CACHE")
    modifier_places.put(copy, cache, at)
    cache.cache_format = "PC2"
    cache.filepath = path
    cache.play_mode, cache.time_mode, cache.interpolation = "SCENE", "FRAME", "LINEAR"
    # Its place in the file is frame_scale * frame - frame_start.
    cache.frame_start, cache.frame_scale = first_frame * samples_per_frame, samples_per_frame
    return cache.name


def shown_by(copy: bpy.types.Object) -> str | None:
    """Name of the modifier after which a baked copy shows the live positions; None where its keys do."""
    first = copy.modifiers[0] if len(copy.modifiers) else None
    if first is None:
        return None
    is_cache = first.type == "MESH_CACHE" and copy.data.shape_keys is None
    return first.name if is_cache or first.type == "ARMATURE" else None


def point_caches(ob: bpy.types.Object) -> list[str]:
    """Absolute paths of the files that its Mesh Cache modifiers follow."""
    caches = [modifier for modifier in ob.modifiers if modifier.type == "MESH_CACHE" and modifier.filepath]
    return [bpy.path.abspath(cache.filepath, library=ob.library) for cache in caches]
