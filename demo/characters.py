"""Opens a file of any kind that Blender reads and finds what can be shown in it."""

from __future__ import annotations

from pathlib import Path

import bpy

IMPORTERS = {
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".fbx": lambda path: import_fbx(path),
}


def open_file(path: Path) -> None:
    """Replaces the current Blender file by `path`."""
    if not path.exists():
        raise SystemExit(f"{path}: no such file")
    if path.suffix == ".blend":
        bpy.ops.wm.open_mainfile(filepath=str(path))
        return
    if path.suffix.lower() not in IMPORTERS:
        raise SystemExit(f"{path}: cannot be read, need .blend, {', '.join(IMPORTERS)}")
    # Not the factory settings: they would turn the extension off.
    bpy.ops.wm.read_homefile(use_empty=True)
    IMPORTERS[path.suffix.lower()](str(path))


def import_fbx(path: str) -> None:
    """By the importer in C++, which also reads text files, or by the older one."""
    if hasattr(bpy.ops.wm, "fbx_import"):
        bpy.ops.wm.fbx_import(filepath=path)
    else:
        bpy.ops.import_scene.fbx(filepath=path)


def armature_of(mesh_object: bpy.types.Object) -> bpy.types.Object | None:
    """The armature that bends a mesh by a modifier."""
    for modifier in mesh_object.modifiers:
        if modifier.type == "ARMATURE" and modifier.object is not None and modifier.show_viewport:
            return modifier.object
    return None


def bone_shapes() -> set[bpy.types.Object]:
    """Objects that only draw bones, such as the icosphere that the glTF importer adds."""
    armatures = [item for item in bpy.context.scene.objects if item.type == "ARMATURE"]
    return {bone.custom_shape for armature in armatures for bone in armature.pose.bones if bone.custom_shape}


def skinned_meshes() -> list[bpy.types.Object]:
    """Visible meshes bent by an armature, by name."""
    shapes = bone_shapes()
    return sorted(
        (
            item
            for item in bpy.context.view_layer.objects
            if item.type == "MESH" and item not in shapes and item.visible_get() and armature_of(item)
        ),
        key=lambda item: item.name,
    )
