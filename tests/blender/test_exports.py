"""What other programs read back: shape and volume of the live frame, from each format."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import enclosed_volume, evaluated_mesh, mesh_positions, volume
from tube import LAST_FRAME, add_turgor, character, place, select, set_strength, tube_mesh

FRAMES = (1, 8, 15, LAST_FRAME)
# Of the size: float32 of the files, of several matrices in a chain, and of key values.
SHAPE, VOLUME = 1e-4, 1e-4
EXACT = 1e-6
READERS = {
    "GLTF": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "FBX": lambda path: bpy.ops.import_scene.fbx(filepath=path, anim_offset=0.0),
    "USD": lambda path: bpy.ops.wm.usd_import(filepath=path),
    "ALEMBIC": lambda path: bpy.ops.wm.alembic_import(filepath=path),
}


@pytest.fixture
def live(addon):
    """A smooth tube, whose weights the formats hold as they are."""
    ob, armature = character()
    ob.data.shade_smooth()
    add_turgor(ob)
    return ob, armature


def world(ob: bpy.types.Object) -> np.ndarray:
    """(N, 3) float64 of the evaluated mesh."""
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix = np.array(evaluated.matrix_world, np.float64)
    return mesh_positions(evaluated.data).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def over_frames(ob: bpy.types.Object, kind: str) -> dict[int, tuple[np.ndarray, float]]:
    """Points and volume; glTF cuts quads into triangles, as they lie at rest."""
    found = {}
    ob.data.calc_loop_triangles()
    triangles = np.array([triangle.vertices for triangle in ob.data.loop_triangles], np.int32)
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        points = world(ob)
        starts = np.arange(0, triangles.size + 1, 3, dtype=np.int32)
        found[frame] = points, enclosed_volume(points, starts, triangles.ravel()) if kind == "GLTF" else volume(ob)
    return found


def nearest(points: np.ndarray, others: np.ndarray) -> float:
    """The largest distance of a point from the nearest of the others: files reorder and split vertices."""
    return max(float(np.linalg.norm(others - point, axis=1).min()) for point in points)


def world_volume(ob: bpy.types.Object) -> float:
    """In the world."""
    mesh = evaluated_mesh(ob)
    offsets = np.full(len(mesh.polygons) + 1, len(mesh.loops), np.int32)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.polygons.foreach_get("loop_start", offsets[:-1])
    mesh.loops.foreach_get("vertex_index", corners)
    return abs(enclosed_volume(world(ob), offsets, corners))


def names() -> dict[str, list[str]]:
    return {
        kind: sorted(member.name for member in getattr(bpy.data, kind))
        for kind in ("objects", "meshes", "actions", "scenes", "shape_keys", "armatures", "node_groups")
    }


@pytest.mark.parametrize(("kind", "is_local"), [*((kind, False) for kind in READERS), ("GLTF", True), ("FBX", True)])
def test_imported_again_shape_and_volume_are_those_of_the_live_frame(route, live, tmp_path, kind: str, is_local: bool):
    ob, armature = live
    expected = over_frames(ob, kind)
    armature_bones = armature.data.bones.keys()
    bpy.context.scene.frame_set(7)
    other = bpy.data.objects.new("Other", bpy.data.meshes.new("Other"))
    bpy.context.scene.collection.objects.link(other)
    select([other, armature])
    before = names()
    # Named after the format.
    path = tmp_path / f"file.{'x' if kind == 'USD' else kind}"
    error = 0.005
    chosen = {"filepath": str(path), "format": kind, "error": error, "local_keys": is_local}
    assert bpy.ops.export_scene.turgor(**chosen, verify=False) == {"FINISHED"}
    (path,) = tmp_path.iterdir()
    assert names() == before
    assert bpy.context.scene.frame_current == 7
    assert other.select_get()
    assert not ob.select_get()

    bpy.ops.wm.read_factory_settings(use_empty=True)
    READERS[kind](str(path))
    read = next(ob for ob in bpy.data.objects if ob.type == "MESH" and not ob.name.startswith("Icosphere"))
    assert "Other" not in bpy.data.objects
    assert read.name == "Tube" or (kind == "GLTF" and read.name == "Tube.001")
    keys = read.data.shape_keys
    if kind in {"GLTF", "FBX"}:
        own = [key.name for key in keys.key_blocks[1:]]
        assert 0 < len(own) < (LAST_FRAME * len(armature_bones) if is_local else LAST_FRAME)
        assert is_local == all(name.rpartition(" ")[0] in armature_bones for name in own)
        assert any(modifier.type == "ARMATURE" for modifier in read.modifiers)
    size = np.linalg.norm(np.ptp(expected[1][0], axis=0))
    tolerance = SHAPE if kind in {"GLTF", "FBX"} else EXACT
    for frame, (points, kept) in expected.items():
        bpy.context.scene.frame_set(frame)
        found = world(read)
        assert nearest(found, points) < tolerance * size
        assert nearest(points, found) < tolerance * size
        assert abs(world_volume(read) / kept - 1.0) < VOLUME


def test_a_later_modifier_is_said_and_keys_survive(live, tmp_path):
    ob, _ = live
    ob.modifiers.new("Smooth", "SUBSURF").levels = 1
    select([ob])
    path = tmp_path / "file.fbx"
    assert bpy.ops.export_scene.turgor(filepath=str(path), format="FBX", error=0.5) == {"FINISHED"}
    bpy.ops.wm.read_factory_settings(use_empty=True)
    READERS["FBX"](str(path))
    assert bpy.data.objects["Tube"].data.shape_keys is not None


def test_the_button_compares_the_file_in_a_blender_of_its_own(live, tmp_path, capfd):
    ob, _ = live
    select([ob])
    bpy.context.scene.frame_set(7)
    before = names()
    path = tmp_path / "file.glb"
    assert bpy.ops.export_scene.turgor(filepath=str(path), format="GLTF", error=0.01) == {"FINISHED"}
    assert "Info: Tube: imported again" in capfd.readouterr().out
    assert names() == before
    assert bpy.context.scene.frame_current == 7
    assert ob.select_get()

    exports, reimport = (importlib.import_module(f"addon.bake.{name}") for name in ("exports", "reimport"))
    settings = exports.Settings("GLTF", path)
    # Another mesh than the one in the file, which is then found out.
    set_strength(ob, 0.2)
    found = reimport.compare([ob], settings)["Tube"]
    assert 100.0 * found.max_error_relative > reimport.tolerance_percent(settings)
    assert 100.0 * found.volume_error_relative > reimport.VOLUME_PERCENT
    path.write_bytes(b"nothing")
    with pytest.raises(reimport.ReimportError, match="cannot be imported again"):
        reimport.compare([ob], settings)


def test_nothing_is_left_of_an_export_that_failed(live, tmp_path):
    ob, _ = live
    select([ob])
    before = names()
    (tmp_path / "file").write_text("")
    with pytest.raises(RuntimeError):
        bpy.ops.export_scene.turgor(filepath=str(tmp_path / "file" / "in.fbx"), format="FBX")
    assert names() == before
    assert ob.select_get()


@pytest.mark.parametrize("kind", ["GLTF", "FBX", "USD", "ALEMBIC"])
def test_objects_whose_names_are_alike_are_compared_with_themselves(live, tmp_path, kind: str):
    ob, armature = live
    other = place("Tube.001", tube_mesh("Tube.001", at_x=3.0, rings=31), armature)
    add_turgor(other)
    exports, reimport = (importlib.import_module(f"addon.bake.{name}") for name in ("exports", "reimport"))
    settings = exports.Settings(kind, tmp_path / f"two{exports.SUFFIXES[kind]}")
    exports.export([ob, other], settings)
    found = reimport.compare([other, ob], settings)
    assert len(found) == 2
    assert all(100.0 * each.max_error_relative <= reimport.tolerance_percent(settings) for each in found.values())


def test_a_name_with_a_number_keeps_it(live, tmp_path):
    ob, _ = live
    select([ob])
    for name in ("Tube.001", "Tube.002"):
        assert bpy.ops.export_scene.turgor(filepath=str(tmp_path / name), format="GLTF", verify=False) == {"FINISHED"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["Tube.001.glb", "Tube.002.glb"]
