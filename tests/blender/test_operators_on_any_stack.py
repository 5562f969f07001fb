"""No operator ends in a traceback, whatever the stack and the object; what is refused leaves nothing behind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bmesh
import bpy
import library
import pytest
from measure import positions, relative_error, volume
from test_comes_and_goes import _listing
from test_exact import VOLUME_TOLERANCE
from tube import add_turgor, character, select

METHODS = ("ABSOLUTE", "REDUCED", "DRIVEN", "POINT_CACHE")
PLACES = ("before", "after", "both", "pinned")


def _types() -> list[str]:
    """Of modifiers that can be added to a mesh."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    ob = bpy.data.objects.new("Probe", bpy.data.meshes.new("Probe"))
    names = [item.identifier for item in bpy.types.Modifier.bl_rna.properties["type"].enum_items]
    return [name for name in names if not name.startswith("GREASE_PENCIL") and ob.modifiers.new(name, name) is not None]


def _give(ob: bpy.types.Object, kind: str, place: str) -> None:
    """A modifier with what it needs to do something."""
    made = ob.modifiers.new(f"{kind} {place}", kind)
    if kind == "MULTIRES":
        select([ob])
        bpy.ops.object.multires_subdivide(modifier=made.name)
    if place == "pinned":
        made.use_pin_to_last = True
    if place == "before":
        ob.modifiers.move(len(ob.modifiers) - 1, 0)


def _attempt(what: Any, **settings: object) -> tuple[bool, str]:
    """Whether an operator did it, and what was told: a refusal is an error of Blender, a fault has a traceback."""
    if not what.poll():
        return False, ""
    try:
        return what(**settings) == {"FINISHED"}, ""
    except RuntimeError as error:
        told = str(error)
    assert "Traceback" not in told, told
    return False, told


def _state(ob: bpy.types.Object) -> tuple:
    drivers = [] if ob.animation_data is None else [curve.data_path for curve in ob.animation_data.drivers]
    saved = (ob.turgor.version, ob.turgor.bound_topology, len(ob.turgor.joints), ob.turgor_spine.version)
    return [modifier.name for modifier in ob.modifiers], drivers, saved, sorted(ob.keys())


def _buttons(runtime, ob: bpy.types.Object) -> list[tuple[str, str, str]]:
    found = [("VOLUME", each) for each in runtime.character(ob.session_uid).findings if each.fix]
    found += [("SPINE", each) for each in runtime.spine(ob.session_uid).findings if each.fix]
    return [(kind, each.fix, each.subject) for kind, each in found]


def _try_all(runtime, ob: bpy.types.Object, folder: Path | None = None) -> None:
    """Add; all that can be done with what was added, bakes into a folder too; remove."""
    operators = bpy.ops.object
    for add, remove, rebind in (
        (operators.turgor_volume_add, operators.turgor_volume_remove, operators.turgor_volume_rebind),
        (operators.turgor_spine_add, operators.turgor_spine_remove, operators.turgor_spine_rebind),
    ):
        listing, state = _listing(), _state(ob)
        is_added, _ = _attempt(add)
        if not is_added:
            assert (_listing(), _state(ob)) == (listing, state)
            _attempt(rebind)
            _attempt(remove)
            continue
        bpy.context.scene.frame_set(12)
        for kind, fix, subject in _buttons(runtime, ob):
            _attempt(operators.turgor_volume_fix, kind=kind, fix=fix, subject=subject)
            _to_object_mode()
        _attempt(rebind)
        for mask in ("vertex_group", "pin_group"):
            _attempt(operators.turgor_mask_paint, mask=mask)
            _to_object_mode()
        for each in (
            operators.turgor_volume_measure,
            operators.turgor_fold_loss_measure,
            operators.turgor_joints_copy,
            operators.turgor_joints_mirror,
            operators.turgor_joints_reset,
            operators.turgor_joints_select,
            operators.turgor_joint_from_bone,
            operators.turgor_curves_reset,
            operators.turgor_joint_asset_add,
            operators.turgor_refine,
        ):
            _attempt(each)
        bpy.context.view_layer.update()
        positions(ob)
        for method in METHODS if folder is not None else ():
            ob.turgor_bake.method, ob.turgor_bake.folder = method, str(folder)
            _attempt(operators.turgor_bake)
            _attempt(operators.turgor_bake_remove)
        select([ob])
        is_removed, told = _attempt(remove)
        assert is_removed, told


def _to_object_mode() -> None:
    if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")


def _quiet(capfd: pytest.CaptureFixture) -> None:
    told = "".join(capfd.readouterr())
    assert "Traceback" not in told, told


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", _types())
def test_every_modifier(runtime, capfd, kind, place):
    ob, _ = character(rings=9, segments=6)
    bpy.context.scene.frame_end = 2
    for each in ("before", "after") if place == "both" else (place,):
        _give(ob, kind, each)
    select([ob])
    _try_all(runtime, ob)
    _quiet(capfd)


def _linked(ob, rig, folder):
    return library.shown(library.linked((ob, rig), folder))


def _overridden(ob, rig, folder):
    return library.overridden(library.linked((ob, rig), folder))


def _overridden_with_turgor(ob, rig, folder):
    add_turgor(ob)
    return library.overridden(library.linked((ob, rig), folder))


def _overridden_with_smoothing(ob, rig, folder):
    ob.modifiers.new("Corrective Smooth", "CORRECTIVE_SMOOTH")
    return library.overridden(library.linked((ob, rig), folder))


def _in_edit_mode(ob, rig, folder):
    select([ob])
    bpy.ops.object.mode_set(mode="EDIT")
    return ob


def _hidden(ob, rig, folder):
    ob.hide_set(True)
    ob.hide_viewport = ob.hide_render = True
    return ob


def _without_vertices(ob, rig, folder):
    ob.data.clear_geometry()
    return ob


def _without_faces(ob, rig, folder):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.delete(type="ONLY_FACE")
    bpy.ops.object.mode_set(mode="OBJECT")
    return ob


def _without_groups(ob, rig, folder):
    ob.vertex_groups.clear()
    return ob


def _without_armature_object(ob, rig, folder):
    bpy.data.objects.remove(rig)
    bpy.context.view_layer.update()
    return ob


def _shared_mesh(ob, rig, folder):
    twin = ob.copy()
    bpy.context.scene.collection.objects.link(twin)
    return ob


def _linked_mesh(ob, rig, folder):
    """The object is of this file, its mesh is not."""
    bpy.data.libraries.write(str(folder / "mesh.blend"), {ob.data})
    with bpy.data.libraries.load(str(folder / "mesh.blend"), link=True) as (_, into):
        into.meshes = [ob.data.name]
    ob.data = into.meshes[0]
    return ob


def _keyed_and_driven(ob, rig, folder):
    ob.modifiers["Armature"].keyframe_insert("show_viewport", frame=1)
    ob.modifiers["Armature"].driver_add("show_render")
    return ob


def _absolute_keys(ob, rig, folder):
    for name in ("Basis", "Other"):
        ob.shape_key_add(name=name)
    ob.data.shape_keys.use_relative = False
    return ob


def _not_a_number(ob, rig, folder):
    ob.data.attributes["position"].data[3].vector.x = float("nan")
    return ob


def _flat_scale(ob, rig, folder):
    ob.scale = rig.scale = (1.0, 0.0, 1.0)
    return ob


def _open_and_hidden(ob, rig, folder):
    """Its findings lead into Edit Mode, where no hidden object may go."""
    mesh = bmesh.new()
    mesh.from_mesh(ob.data)
    mesh.faces.ensure_lookup_table()
    mesh.faces.remove(mesh.faces[0])
    mesh.to_mesh(ob.data)
    mesh.free()
    ob.vertex_groups[0].remove([0, 1])
    ob.hide_set(True)
    return ob


SITUATIONS = (
    _linked,
    _overridden,
    _overridden_with_turgor,
    _overridden_with_smoothing,
    _in_edit_mode,
    _hidden,
    _open_and_hidden,
    _without_vertices,
    _without_faces,
    _without_groups,
    _without_armature_object,
    _shared_mesh,
    _linked_mesh,
    _keyed_and_driven,
    _absolute_keys,
    _not_a_number,
    _flat_scale,
)


@pytest.mark.parametrize("situation", SITUATIONS, ids=lambda each: each.__name__)
def test_every_situation(route, runtime, capfd, tmp_path, situation):
    ob, rig = character(rings=9, segments=6)
    bpy.context.scene.frame_end = 2
    select([ob])
    ob = situation(ob, rig, tmp_path)
    if ob.mode == "OBJECT":
        select([ob])
    _try_all(runtime, ob, tmp_path)
    _quiet(capfd)


@pytest.mark.parametrize("place", ["before", "after", "pinned"])
@pytest.mark.parametrize("kind", ["SUBSURF", "MULTIRES", "CORRECTIVE_SMOOTH", "SOLIDIFY", "MASK", "NODES", "ARMATURE"])
def test_every_bake(runtime, capfd, tmp_path, kind, place):
    ob, _ = character(rings=9, segments=6)
    bpy.context.scene.frame_end = 2
    _give(ob, kind, place)
    select([ob])
    _try_all(runtime, ob, tmp_path)
    _quiet(capfd)


@pytest.mark.parametrize("kind", ["MULTIRES", "SOFT_BODY"])
def test_what_needs_the_stored_mesh_is_told_and_can_be_mended(runtime, kind):
    """Blender lets no modifier of ours stand before it."""
    ob, _ = character()
    _give(ob, kind, "after")
    select([ob])
    before = _listing(), _state(ob)
    with pytest.raises(RuntimeError, match="needs the mesh as it is stored"):
        bpy.ops.object.turgor_volume_add()
    assert (_listing(), _state(ob)) == before
    if kind == "MULTIRES":
        ob.modifiers.move(1, 0)
        add_turgor(ob)
        assert runtime.character(ob.session_uid).problem is None


def test_multires_that_comes_later_is_told_and_its_button_says_why_not(runtime):
    """Blender puts it between the Armature and ours."""
    ob, _ = character()
    add_turgor(ob)
    _give(ob, "MULTIRES", "after")
    bpy.context.view_layer.update()
    names = [modifier.type for modifier in ob.modifiers]
    assert names == ["ARMATURE", "MULTIRES", "NODES"]
    found = next(each for each in runtime.character(ob.session_uid).findings if each.severity == "ERROR")
    assert found.fix == "MOVE_ABOVE"
    select([ob])
    is_done, _ = _attempt(bpy.ops.object.turgor_volume_fix, fix=found.fix, subject=found.subject, kind="VOLUME")
    assert not is_done
    assert [modifier.type for modifier in ob.modifiers] == names


def test_ours_goes_after_an_armature_that_is_pinned_to_the_end(runtime):
    ob, _ = character()
    ob.modifiers["Armature"].use_pin_to_last = True
    rest = volume(ob)
    add_turgor(ob)
    assert [modifier.type for modifier in ob.modifiers] == ["ARMATURE", "NODES"]
    bpy.context.scene.frame_set(12)
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


@pytest.mark.parametrize(("kind", "suffix"), [("GLTF", ".glb"), ("FBX", ".fbx"), ("USD", ".usdc"), ("ALEMBIC", ".abc")])
def test_an_export_that_cannot_be_written_says_so(runtime, tmp_path, kind, suffix):
    ob, _ = character(rings=9, segments=6)
    bpy.context.scene.frame_end = 2
    add_turgor(ob)
    listing, state = _listing(), _state(ob)
    folder = (tmp_path / "folder").with_suffix(suffix)
    folder.mkdir()
    (tmp_path / "file").write_text("")
    for path in (folder, tmp_path / "file" / f"below{suffix}"):
        is_done, told = _attempt(bpy.ops.export_scene.turgor, filepath=str(path), format=kind, verify=False)
        assert not is_done
        assert path.name in told
        assert (_listing(), _state(ob)) == (listing, state)
