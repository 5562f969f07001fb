"""Characters that come out of another file."""

from __future__ import annotations

from pathlib import Path

import bpy


def linked(members: tuple[bpy.types.Object, ...], folder: Path) -> bpy.types.Collection:
    """A collection of these objects, saved to a library and linked into an empty file; in no scene yet."""
    collection = bpy.data.collections.new("Character")
    bpy.context.scene.collection.children.link(collection)
    for member in members:
        collection.objects.link(member)
    path = str(folder / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, into):
        into.collections = ["Character"]
    return into.collections[0]


def shown(collection: bpy.types.Collection) -> bpy.types.Object:
    """The mesh of a linked collection, put into the scene as it is."""
    bpy.context.scene.collection.children.link(collection)
    bpy.context.view_layer.update()
    return mesh_of(collection.all_objects)


def overridden(collection: bpy.types.Collection) -> bpy.types.Object:
    """The mesh of a linked collection, put into the scene with all of it overridden."""
    made = collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer, do_fully_editable=True)
    bpy.context.view_layer.update()
    return mesh_of(made.all_objects)


def opened_override() -> bpy.types.Object:
    """The overridden mesh of the file that was opened."""
    return mesh_of(member for member in bpy.context.scene.objects if member.override_library)


def mesh_of(objects) -> bpy.types.Object:
    return next(member for member in objects if member.type == "MESH")
