"""Refining a character's mesh: the same rest shape, all that it carries goes along, the volume stays exact."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import mesh_positions, mesh_volume, positions, volume
from tube import LAST_FRAME, LENGTH, act_locally, add_turgor, character, place, rig, select, subdivide, tube_mesh, weigh

REFINE = {"use_automatic": False, "levels": 2, "threshold": 0.2}
# Refined vertices are stored in single precision.
TOLERANCE = 1e-6


@pytest.fixture
def refining(package):
    return importlib.import_module("addon.live.refining")


def refine(ob: bpy.types.Object, **options) -> set[str]:
    select([ob])
    found = bpy.ops.object.turgor_refine(**(REFINE | options))
    bpy.context.view_layer.update()
    return found


def read(data, name: str, width: int = 1, kind=np.float32) -> np.ndarray:
    found = np.empty(len(data) * width, kind)
    data.foreach_get(name, found)
    return found.reshape(-1, width) if width > 1 else found


def affine(points: np.ndarray, width: int) -> np.ndarray:
    """Values from 0 to 1 that are linear in the place."""
    x, y, z = points.T
    rows = [0.5 + 0.4 * x, 0.5 + 0.3 * y - 0.2 * x, z / LENGTH, 0.5 + 0.1 * (x + y)]
    return np.stack(rows[:width], axis=1)


def corner_vertices(mesh: bpy.types.Mesh) -> np.ndarray:
    return read(mesh.loops, "vertex_index", kind=np.int32)


def edge_lengths(mesh: bpy.types.Mesh) -> np.ndarray:
    ends = mesh_positions(mesh)[read(mesh.edges, "vertices", 2, np.int32)]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


def is_watertight(mesh: bpy.types.Mesh) -> bool:
    uses = np.bincount(read(mesh.loops, "edge_index", kind=np.int32), minlength=len(mesh.edges))
    return bool((uses == 2).all())


def laden(ob: bpy.types.Object) -> None:
    """A value of every kind on vertices, edges, faces and corners."""
    mesh, points = ob.data, mesh_positions(ob.data)
    corners = points[corner_vertices(mesh)]
    for name, kind, width in (("UVMap", "FLOAT2", 2), ("Bytes", "BYTE_COLOR", 4), ("Floats", "FLOAT_COLOR", 4)):
        layer = mesh.attributes.new(name, kind, "CORNER")
        layer.data.foreach_set("vector" if width == 2 else "color", affine(corners, width).astype(np.float32).ravel())
    layer = mesh.attributes.new("Wear", "FLOAT", "POINT")
    layer.data.foreach_set("value", affine(points, 1).ravel().astype(np.float32))
    for number in range(2):
        mesh.materials.append(bpy.data.materials.new(f"Material{number}"))
    faces = np.arange(len(mesh.polygons))
    mesh.polygons.foreach_set("material_index", (faces % 2).astype(np.int32))
    layer = mesh.attributes.new("Part", "INT", "FACE")
    layer.data.foreach_set("value", (faces % 5).astype(np.int32))
    edges = np.arange(len(mesh.edges))
    mesh.edges.foreach_set("use_seam", edges % 3 == 0)
    mesh.edges.foreach_set("use_edge_sharp", edges % 4 == 0)
    layer = mesh.attributes.new("crease_vert", "FLOAT", "POINT")
    layer.data.foreach_set("value", (np.arange(len(points)) % 3 == 0).astype(np.float32))
    layer = mesh.attributes.new("crease_edge", "FLOAT", "EDGE")
    layer.data.foreach_set("value", (edges % 7 == 0).astype(np.float32) * 0.5)
    ob.shape_key_add(name="Basis", from_mix=False)
    for name in ("Wide", "Tall"):
        key = ob.shape_key_add(name=name, from_mix=False)
        key.value = 0.25
        moved = points + (affine(points, 3) - 0.5) * (0.3 if name == "Wide" else 0.5)
        key.points.foreach_set("co", moved.astype(np.float32).ravel())
    mesh.update()


def on_edges(mesh: bpy.types.Mesh) -> np.ndarray:
    """Length of all seams, sharp edges, and of creases by their value."""
    values = (
        read(mesh.edges, "use_seam", kind=bool),
        read(mesh.edges, "use_edge_sharp", kind=bool),
        read(mesh.attributes["crease_edge"].data, "value"),
    )
    return np.array([(edge_lengths(mesh) * flags).sum() for flags in values])


def areas(mesh: bpy.types.Mesh, labels: np.ndarray) -> np.ndarray:
    return np.bincount(labels, read(mesh.polygons, "area"))


def test_all_that_a_mesh_carries_goes_along():
    ob, _ = character()
    laden(ob)
    add_turgor(ob)
    mesh = ob.data
    old, lines = mesh_positions(mesh), on_edges(mesh)
    parts = [areas(mesh, read(mesh.polygons, "material_index", kind=np.int32))]
    parts.append(areas(mesh, read(mesh.attributes["Part"].data, "value", kind=np.int32)))
    before = mesh_volume(mesh)
    groups = [[(item.group, item.weight) for item in vertex.groups] for vertex in mesh.vertices]
    assert refine(ob) == {"FINISHED"}

    new = mesh_positions(mesh)
    assert len(new) > 2 * len(old)
    assert np.array_equal(new[: len(old)], old)
    assert is_watertight(mesh)
    assert not mesh.validate()
    assert mesh_volume(mesh) == pytest.approx(before, rel=1e-7)
    corners = new[corner_vertices(mesh)]
    uv, wear = mesh.attributes["UVMap"], mesh.attributes["Wear"]
    np.testing.assert_allclose(read(uv.data, "vector", 2), affine(corners, 2), atol=TOLERANCE)
    np.testing.assert_allclose(read(mesh.attributes["Floats"].data, "color", 4), affine(corners, 4), atol=TOLERANCE)
    # Bytes are those of sRGB.
    assert np.abs(read(mesh.attributes["Bytes"].data, "color", 4) - affine(corners, 4)).max() < 0.02
    np.testing.assert_allclose(read(wear.data, "value"), affine(new, 1)[:, 0], atol=TOLERANCE)
    np.testing.assert_allclose(on_edges(mesh), lines, rtol=1e-5)
    found = [areas(mesh, read(mesh.polygons, "material_index", kind=np.int32))]
    found.append(areas(mesh, read(mesh.attributes["Part"].data, "value", kind=np.int32)))
    for now, then in zip(found, parts, strict=True):
        np.testing.assert_allclose(now, then, rtol=1e-5)
    creased = read(mesh.attributes["crease_vert"].data, "value")
    assert np.array_equal(np.flatnonzero(creased), np.arange(0, len(old), 3))
    keys = mesh.shape_keys.key_blocks
    assert [(key.name, key.value) for key in keys][1:] == [("Wide", 0.25), ("Tall", 0.25)]
    np.testing.assert_allclose(read(keys["Basis"].points, "co", 3), new, atol=1e-7)
    for name, size in (("Wide", 0.3), ("Tall", 0.5)):
        np.testing.assert_allclose(
            read(keys[name].points, "co", 3), new + (affine(new, 3) - 0.5) * size, atol=TOLERANCE
        )
    assert [[(item.group, item.weight) for item in mesh.vertices[i].groups] for i in range(len(old))] == groups
    sums = [sum(item.weight for item in vertex.groups) for vertex in mesh.vertices]
    np.testing.assert_allclose(sums, 1.0, atol=1e-6)


def test_selection_and_hiding_go_along():
    ob, _ = character()
    add_turgor(ob)
    mesh = ob.data
    heights = read(mesh.polygons, "center", 3)[:, 2]
    for vertex in mesh.vertices:
        vertex.select = False
    for edge in mesh.edges:
        edge.select = False
    for face, height in zip(mesh.polygons, heights, strict=True):
        face.select = bool(1.0 < height < 2.0)
    hidden = read(mesh.polygons, "area")[(heights > 3.0)].sum()
    mesh.polygons.foreach_set("hide", heights > 3.0)
    selected = sum(face.area for face in mesh.polygons if face.select)
    refine(ob)
    assert sum(face.area for face in mesh.polygons if face.select) == pytest.approx(selected, rel=1e-5)
    assert sum(face.area for face in mesh.polygons if face.hide) == pytest.approx(hidden, rel=1e-5)


def test_custom_normals_are_between_those_around():
    ob, _ = character()
    mesh = ob.data
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    own = affine(mesh_positions(mesh)[corner_vertices(mesh)], 3) - [0.5, 0.5, -1.0]
    own /= np.linalg.norm(own, axis=1, keepdims=True)
    mesh.normals_split_custom_set(own.tolist())
    add_turgor(ob)
    refine(ob, levels=1)
    corners = mesh_positions(mesh)[corner_vertices(mesh)]
    wanted = affine(corners, 3) - [0.5, 0.5, -1.0]
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    assert mesh.has_custom_normals
    # Mixed and made as long as before, and stored in 16 bits: in between, not the same as affine.
    assert np.abs(read(mesh.corner_normals, "vector", 3) - wanted).max() < 0.01


@pytest.mark.parametrize("method", ["LINEAR", "SMOOTH"])
def test_volume_is_exact_and_nothing_jumps(route, method):
    ob, _ = character()
    add_turgor(ob)
    for joint in ob.turgor.joints:
        joint.preset = "BELLY"
    assert refine(ob, method=method) == {"FINISHED"}
    rest = mesh_volume(ob.data)
    steps = {}
    for step in (1.0, 0.5):
        last, steps[step] = None, 0.0
        for frame in np.arange(8.0, 14.0 + step, step):
            bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
            assert abs(volume(ob) / rest - 1.0) < 1e-6
            now = positions(ob)
            if last is not None:
                steps[step] = max(steps[step], np.linalg.norm(now - last, axis=1).max())
            last = now
    # Half the time, half the way.
    assert steps[0.5] < 0.6 * steps[1.0]


def test_a_threshold_beyond_all_touches_nothing(runtime):
    ob, _ = character()
    add_turgor(ob)
    mesh = ob.data
    old, body = mesh_positions(mesh), runtime.character(ob.session_uid).binding.body
    assert refine(ob, threshold=1.0) == {"CANCELLED"}
    assert np.array_equal(mesh_positions(mesh), old)
    assert runtime.character(ob.session_uid).binding.body.current_engine is not None
    assert runtime.character(ob.session_uid).binding.body is body


def test_a_lower_threshold_keeps_what_a_higher_one_made():
    found = []
    for threshold in (0.5, 0.2, 0.02):
        ob, _ = character(f"Tube{threshold}")
        add_turgor(ob)
        act_locally(ob)
        refine(ob, threshold=threshold)
        found.append({tuple(place) for place in mesh_positions(ob.data).round(5).tolist()})
    # Cut neighbours have centres of their own, which whole ones have too.
    assert found[0] < found[1] < found[2]


def test_undo_takes_it_back_in_one_step_and_it_can_be_done_otherwise(route, runtime):
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(LAST_FRAME)
    bpy.ops.ed.undo_push(message="before")
    before, count = positions(ob), len(ob.data.vertices)
    refine(ob)
    bpy.ops.ed.undo_push(message="refined")
    assert len(ob.data.vertices) > count
    bpy.ops.ed.undo()
    ob = bpy.data.objects["Tube"]
    bpy.context.view_layer.update()
    assert len(ob.data.vertices) == count
    assert runtime.character(ob.session_uid).problem is None
    np.testing.assert_allclose(positions(ob), before, atol=1e-6)
    # As the redo panel does.
    assert refine(ob, levels=1) == {"FINISHED"}
    assert volume(ob) == pytest.approx(mesh_volume(ob.data), rel=1e-6)


@pytest.mark.parametrize("method", ["LINEAR", "SMOOTH"])
def test_automatic_is_enough_at_once(refining, method):
    """A denser mesh sees more of the folds: the second time there is nothing left to do, unless levels ran out."""
    counts = {}
    for levels in (1, 4):
        ob, _ = character(f"Tube{levels}", rings=13, segments=12)
        add_turgor(ob)
        act_locally(ob)
        for joint in ob.turgor.joints:
            joint.preset = "FOLDS"
        options = refining.Options(0.1, levels, is_automatic=True, is_smooth=method == "SMOOTH")
        made = refining.refine(ob, options)
        bpy.context.view_layer.update()
        counts[levels] = made.vertex_count
        assert 0 < made.face_count < made.all_face_count
        assert made.vertex_count == len(ob.data.vertices)
        again = refining.refine(ob, options)
        assert (made.short_count > 0) == (again.face_count > 0) == (levels == 1)
        assert is_watertight(ob.data)
    assert counts[4] > counts[1]


def test_what_cannot_be_looked_at_again_is_refined_once(refining, monkeypatch):
    ob, _ = character(rings=13, segments=12)
    add_turgor(ob)
    for joint in ob.turgor.joints:
        joint.preset = "FOLDS"
    find, calls = refining.find, []

    def once(*arguments):
        calls.append(arguments)
        if len(calls) > 1:
            raise ValueError("a driver names the scene")
        return find(*arguments)

    monkeypatch.setattr(refining, "find", once)
    before = len(ob.data.vertices)
    assert refine(ob, use_automatic=True, threshold=0.1) == {"FINISHED"}
    assert len(ob.data.vertices) > before
    assert len(calls) == 2


def test_the_preview_says_what_refining_does(refining, runtime):
    ob, _ = character()
    add_turgor(ob)
    act_locally(ob)
    saved = ob.turgor.refine
    saved.use_automatic, saved.levels = False, 1
    assert refining.look(ob) is None
    saved.show_preview = True
    region = refining.look(ob)
    assert region is refining.look(ob)
    assert 0 < region.face_count < region.all_face_count == len(ob.data.polygons)
    assert len(region.lines(positions(ob))) > 0
    assert region.triangles.max() < len(ob.data.vertices)
    # Settings of joints change it.
    for joint in ob.turgor.joints[1:]:
        joint.strength = 0.0
    bpy.context.view_layer.update()
    fewer = refining.look(ob)
    assert fewer.face_count < region.face_count
    refine(ob, levels=1)
    assert len(ob.data.vertices) == fewer.vertex_count
    assert refining.look(ob) is None
    assert not saved.show_preview


def test_the_preview_is_there_when_a_file_is_opened_and_after_an_edit(refining, runtime, tmp_path):
    ob, _ = character()
    add_turgor(ob)
    ob.turgor.refine.use_automatic, ob.turgor.refine.show_preview = False, True
    count = refining.look(ob).face_count
    path = str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    ob = bpy.data.objects["Tube"]
    # Not before it is looked at.
    assert runtime.session.characters[ob.session_uid].refinement is None
    assert refining.look(ob).face_count == count
    subdivide(ob)
    bpy.ops.object.turgor_volume_rebind()
    assert refining.look(ob).all_face_count > count


def test_half_a_body_under_a_mirror(runtime):
    ob, armature = character()
    mesh = ob.data
    half = [(v.co.x, v.co.y, v.co.z) for v in mesh.vertices]
    faces = [tuple(face.vertices) for face in mesh.polygons if len(face.vertices) == 4 and face.center.x > 0.0]
    made = bpy.data.meshes.new("Half")
    made.from_pydata(half, [], faces)
    other = bpy.data.objects.new("Half", made)
    bpy.context.scene.collection.objects.link(other)
    weigh(other)
    other.modifiers.new("Mirror", "MIRROR")
    other.modifiers.new("Armature", "ARMATURE").object = armature
    bpy.data.objects.remove(ob)
    bpy.context.view_layer.update()
    add_turgor(other)
    act_locally(other)
    before = len(made.vertices)
    assert refine(other, method="SMOOTH") == {"FINISHED"}
    assert len(made.vertices) > before
    bpy.context.scene.frame_set(LAST_FRAME)
    body = runtime.character(other.session_uid).binding.body
    assert body.shells.open == 1
    assert body.current_engine.mesh.components[0].boundary_edge_count == 24
    mid = mesh_positions(made)
    assert (np.abs(mid[:, 0]) < 1e-6).sum() > 2 * 21


def test_a_subdivision_before_the_armature():
    ob, _ = character()
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    ob.modifiers.move(1, 0)
    modifier.levels = modifier.render_levels = 1
    add_turgor(ob)
    before = len(ob.data.vertices)
    assert refine(ob, levels=1) == {"FINISHED"}
    assert before < len(ob.data.vertices) < 4 * before
    bpy.context.scene.frame_set(1)
    rest = volume(ob)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert volume(ob) == pytest.approx(rest, rel=1e-6)


def test_all_users_of_a_mesh_are_bound_anew(runtime):
    ob, armature = character()
    twin = bpy.data.objects.new("Twin", ob.data)
    bpy.context.scene.collection.objects.link(twin)
    for group in ob.vertex_groups:
        if group.name not in twin.vertex_groups:
            twin.vertex_groups.new(name=group.name)
    twin.modifiers.new("Armature", "ARMATURE").object = armature
    add_turgor(ob, twin)
    assert refine(ob) == {"FINISHED"}
    bpy.context.scene.frame_set(LAST_FRAME)
    for each in (ob, twin):
        assert runtime.character(each.session_uid).problem is None
        assert volume(each) == pytest.approx(mesh_volume(ob.data), rel=1e-6)


def test_split_seams_stay_closed(runtime):
    ob, _ = character()
    select([ob])
    for edge in ob.data.edges:
        edge.select = edge.index % 3 == 0
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.edge_split(type="EDGE")
    bpy.ops.object.mode_set(mode="OBJECT")
    add_turgor(ob)
    before = runtime.character(ob.session_uid).binding.body.current_engine.mesh.components
    assert refine(ob, method="SMOOTH") == {"FINISHED"}
    after = runtime.character(ob.session_uid).binding.body.current_engine.mesh.components
    assert [part.status for part in after] == [part.status for part in before] == ["closed"]


def test_masks_and_pins_go_along(runtime):
    ob, _ = character()
    group = ob.vertex_groups.new(name="Pin")
    group.add([v.index for v in ob.data.vertices if v.co.z > 3.0], 1.0, "REPLACE")
    add_turgor(ob)
    ob.turgor.pin_group = "Pin"
    refine(ob)
    mask = runtime.character(ob.session_uid).binding.body.mask
    heights = mesh_positions(ob.data)[:, 2]
    assert len(mask) == len(heights)
    # In the ring below it fades.
    assert (mask[heights > 3.19] == 0.0).all()
    assert (mask[heights < 2.7] == 1.0).all()


@pytest.mark.parametrize("creased", [False, True])
@pytest.mark.parametrize("levels", [1, 2])
def test_smooth_is_blenders_own_subdivision(package, levels, creased):
    """All over; with openings, triangles, faces of many corners and creases of all kinds."""
    logic = importlib.import_module("addon.logic.refined_region")
    refinement = importlib.import_module("addon.logic.refinement")
    scene = importlib.import_module("addon.scene.refined_mesh")
    mesh = tube_mesh("Tube", rings=5, segments=7)
    faces = [tuple(face.vertices) for face in mesh.polygons]
    faces = [faces[0][:3], (faces[0][0], *faces[0][2:]), *faces[2:]]
    points = mesh_positions(mesh) + np.random.default_rng(3).uniform(-0.1, 0.1, (len(mesh.vertices), 3))
    made = bpy.data.meshes.new("Made")
    made.from_pydata(points.tolist(), [], faces)
    if creased:
        edges, vertices = np.arange(len(made.edges)), np.arange(len(made.vertices))
        values = np.choose(edges % 5, [0.0, 1.0, 0.0, 0.55, 0.2]).astype(np.float32)
        made.attributes.new("crease_edge", "FLOAT", "EDGE").data.foreach_set("value", values)
        values = np.where(vertices % 11 == 0, 1.0, 0.0).astype(np.float32)
        made.attributes.new("crease_vert", "FLOAT", "POINT").data.foreach_set("value", values)
    surface = scene.read_surface(made)
    found = refinement.refine(logic.surface(*surface[1:]), np.full(len(made.polygons), levels))
    smooth = found.smoothed(surface.positions, keeps_vertices=False)

    ob = bpy.data.objects.new("Made", made)
    bpy.context.scene.collection.objects.link(ob)
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.use_limit_surface = levels, False
    expected = positions(ob)
    assert len(expected) == len(smooth)
    distances = np.linalg.norm(smooth[:, None] - expected, axis=2)
    assert distances.min(axis=1).max() < 2e-6
    assert distances.min(axis=0).max() < 2e-6


def test_smooth_keeps_the_vertices_that_are_there():
    ob, _ = character()
    add_turgor(ob)
    old = mesh_positions(ob.data)
    assert refine(ob, method="SMOOTH") == {"FINISHED"}
    assert np.array_equal(mesh_positions(ob.data)[: len(old)], old)


def test_smooth_keeps_what_a_subdivision_surface_makes():
    """Away from the border of what is refined."""
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(1)
    modifier = ob.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.use_limit_surface = 2, True
    before, old = positions(ob), mesh_positions(ob.data)
    assert refine(ob, levels=1, method="SMOOTH", threshold=0.0) == {"FINISHED"}
    assert np.linalg.norm(mesh_positions(ob.data)[: len(old)] - old, axis=1).max() > 0.01
    # The same places of the limit surface, one level less of it.
    modifier.levels = 1
    middle = np.abs(before[:, 2] - 0.5 * LENGTH) < 0.1 * LENGTH
    distances = np.linalg.norm(before[middle][:, None] - positions(ob), axis=2).min(axis=1)
    assert distances.max() < 1e-5


@pytest.mark.parametrize("reason", ["linked mesh", "edit mode", "other in edit mode", "multires", "nothing of ours"])
def test_what_cannot_be_refined_says_why(reason, tmp_path):
    ob, _ = character()
    if reason != "nothing of ours":
        add_turgor(ob)
    select([ob])
    if reason == "linked mesh":
        path = str(tmp_path / "mesh.blend")
        bpy.data.libraries.write(path, {ob.data})
        with bpy.data.libraries.load(path, link=True) as (_, wanted):
            wanted.meshes = [ob.data.name]
        ob.data = wanted.meshes[0]
    elif reason == "edit mode":
        bpy.ops.object.mode_set(mode="EDIT")
    elif reason == "other in edit mode":
        twin = bpy.data.objects.new("Twin", ob.data)
        bpy.context.scene.collection.objects.link(twin)
        select([twin])
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.context.view_layer.objects.active = ob
    elif reason == "multires":
        ob.modifiers.new("Multires", "MULTIRES")
    with pytest.raises(RuntimeError, match=r"linked|Edit Mode|edit or paint|Multiresolution|no Turgor"):
        bpy.ops.object.turgor_refine(**REFINE)
    if bpy.context.object.mode == "EDIT":
        bpy.ops.object.mode_set(mode="OBJECT")


def test_a_body_on_a_spine_and_the_volume_after_it(runtime):
    armature = rig()
    ob = place("Tube", tube_mesh(rings=31), armature)
    add_turgor(ob)
    select([armature, ob])
    assert bpy.ops.object.turgor_spine_add() == {"FINISHED"}
    for index, bone in enumerate(armature.pose.bones):
        bone.rotation_euler = (0.5 * (index > 0), 0.0, 0.0)
        bone.keyframe_insert("rotation_euler", frame=LAST_FRAME)
        bone.rotation_euler = (0.0, 0.0, 0.0)
        bone.keyframe_insert("rotation_euler", frame=1)
    found = refine(ob, threshold=0.01)
    assert found in ({"FINISHED"}, {"CANCELLED"})
    bpy.context.scene.frame_set(LAST_FRAME)
    assert runtime.character(ob.session_uid).problem is None
    assert runtime.spine(ob.session_uid).problem is None
    assert volume(ob) == pytest.approx(mesh_volume(ob.data), rel=1e-5)


def test_an_edit_right_before_is_seen():
    """A script changes the mesh, and nothing has been evaluated since."""
    ob, _ = character()
    add_turgor(ob)
    select([ob])
    wider = mesh_positions(ob.data) * np.float32([1.5, 1.5, 1.0])
    ob.data.attributes["position"].data.foreach_set("vector", wider.ravel())
    ob.data.update()
    assert bpy.ops.object.turgor_refine(**REFINE) == {"FINISHED"}
    assert np.array_equal(mesh_positions(ob.data)[: len(wider)], wider)
    bpy.context.scene.frame_set(LAST_FRAME)
    assert volume(ob) == pytest.approx(mesh_volume(ob.data), rel=1e-6)


def test_a_mesh_that_has_to_be_bound_anew_says_so():
    ob, _ = character()
    add_turgor(ob)
    select([ob])
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.quads_convert_to_tris()
    bpy.ops.object.mode_set(mode="OBJECT")
    with pytest.raises(RuntimeError, match="press Rebind"):
        bpy.ops.object.turgor_refine(**REFINE)
