"""Folds that the correction makes are repaired: live, in bakes and on the command line, the same wherever asked."""

from __future__ import annotations

import importlib
import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from measure import mesh_volume, positions, relative_error
from tube import LAST_FRAME, add_turgor, character, place, select, tube_mesh, volume_modifier

VOLUME_TOLERANCE = 1e-6
FRAMES = np.arange(1.0, LAST_FRAME + 1.0)


@pytest.fixture
def ob(addon) -> bpy.types.Object:
    """A tube that is bent so far that its correction passes through itself, on its last frames."""
    ob, rig = character()
    for index, bone in enumerate(rig.pose.bones):
        bone.rotation_euler = (2.2 * (index == 1), 0.1, 0.05 * index)
        bone.keyframe_insert("rotation_euler", frame=LAST_FRAME)
    add_turgor(ob)
    # What the law of flesh itself folds is no fold of the correction.
    ob.turgor.flesh = 0.0
    for joint in ob.turgor.joints:
        joint.preset = "MUSCLE"
    bpy.context.scene.frame_set(LAST_FRAME)
    return ob


def folds(runtime, ob: bpy.types.Object):
    return runtime.character(ob.session_uid).figures.folds


def triangles(ob: bpy.types.Object) -> np.ndarray:
    """(T, 3) of the faces with up to four corners, which are cut from the first to the third."""
    corners = [tuple(polygon.vertices) for polygon in ob.data.polygons if len(polygon.vertices) <= 4]
    return np.array([[face[0], face[i], face[i + 1]] for face in corners for i in range(1, len(face) - 1)])


def passing(points: np.ndarray, cut: np.ndarray, slack: float) -> set[tuple[int, int]]:
    """Pairs of which a side goes through the other; slack: part of the longest side, less than 0: beyond doubt."""
    low, high = points[cut].min(1), points[cut].max(1)
    meets = (low[:, None] <= high).all(2) & (low <= high[:, None]).all(2)
    found = set()
    for a, b in np.argwhere(np.triu(meets, 1)).tolist():
        if len(set(cut[a]) & set(cut[b])) > 1:
            continue
        if any(
            _goes_through(points[[p, q]], points[cut[to]], slack)
            for of, to in ((a, b), (b, a))
            for p, q in zip(cut[of], np.roll(cut[of], 1), strict=True)
            if p not in cut[to] and q not in cut[to]
        ):
            found.add((a, b))
    return found


def _goes_through(ends: np.ndarray, corners: np.ndarray, slack: float) -> bool:
    (a, b, c), (p, q) = corners, ends
    turns = [np.dot(np.cross(q - p, s - p), t - p) for s, t in ((a, b), (b, c), (c, a))]
    sides = [np.dot(np.cross(b - a, c - a), end - a) for end in ends]
    room = slack * max(np.linalg.norm(s - t) for s, t in ((a, b), (b, c), (c, a), (p, q))) ** 3
    is_through = min(turns) >= -room or max(turns) <= room
    return is_through and min(sides) < min(room, 0.0) and max(sides) > max(-room, 0.0)


def new_folds(ob: bpy.types.Object) -> int:
    """Against the armature alone."""
    shown, ours = positions(ob).astype(np.float64), volume_modifier(ob)
    ours.show_viewport = False
    skinned = positions(ob).astype(np.float64)
    ours.show_viewport = True
    cut = triangles(ob)
    return len(passing(shown, cut, -1e-4) - passing(skinned, cut, 1e-4))


def test_folds_are_repaired_and_the_volume_is_exact(route, runtime, ob):
    assert folds(runtime, ob) is None
    assert new_folds(ob) > 0
    ob.turgor.repair_folds = True
    bpy.context.view_layer.update()
    assert new_folds(ob) == 0
    assert abs(relative_error(ob, mesh_volume(ob.data))) <= VOLUME_TOLERANCE
    found = folds(runtime, ob)
    assert found.found_count > 0
    assert found.left_count == 0
    assert found.blocked_count > 0


def test_frames_without_folds_stay_the_same_to_the_last_bit(runtime, ob):
    shown = {}
    for switch in (False, True):
        ob.turgor.repair_folds = switch
        for frame in (3, 8, LAST_FRAME):
            bpy.context.scene.frame_set(frame)
            shown[switch, frame] = positions(ob)
            if switch and frame < LAST_FRAME:
                assert folds(runtime, ob).found_count == 0
    assert np.array_equal(shown[False, 3], shown[True, 3])
    assert np.array_equal(shown[False, 8], shown[True, 8])
    assert not np.array_equal(shown[False, LAST_FRAME], shown[True, LAST_FRAME])


def test_a_frame_is_the_same_however_it_is_reached(route, ob):
    ob.turgor.repair_folds = True
    bpy.context.view_layer.update()
    reached = [positions(ob)]
    for path in ((1, LAST_FRAME), (17, 4, LAST_FRAME)):
        for frame in path:
            bpy.context.scene.frame_set(frame)
        reached.append(positions(ob))
    for other in reached[1:]:
        assert np.array_equal(reached[0], other)


def test_folds_that_are_left_are_told(runtime, ob):
    """Pinned but for the fold itself: the volume has nowhere else to come back, and plain fields are narrow."""
    ob.turgor.fields = "PLAIN"
    ob.turgor.repair_folds = True
    bpy.context.view_layer.update()
    places = positions(ob).astype(np.float64)
    ours = volume_modifier(ob)
    ours.show_viewport = False
    moved = np.linalg.norm(places - positions(ob), axis=1)
    ours.show_viewport = True
    pinned = ob.vertex_groups.new(name="Pinned")
    crease = places[np.argsort(moved)[-1]]
    far = np.linalg.norm(places - crease, axis=1) > 0.35
    pinned.add(np.flatnonzero(far).tolist(), 1.0, "REPLACE")
    ob.turgor.pin_group = "Pinned"
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(LAST_FRAME)
    known = runtime.character(ob.session_uid)
    left = folds(runtime, ob).left_count
    said = [finding for finding in known.findings if finding.id == "folds_left"]
    assert left > 0
    assert f"{left:,}" in said[0].text
    # The exact volume goes before folds.
    assert abs(relative_error(ob, mesh_volume(ob.data))) <= VOLUME_TOLERANCE


def test_shells_that_are_not_corrected_are_kept_out_of(addon, runtime):
    """A sheet of the same mesh, close to where the tube bulges."""
    rig_of_tube = character()[1]
    mesh = tube_mesh("Tube")
    points = [tuple(vertex.co) for vertex in mesh.vertices]
    faces = [tuple(polygon.vertices) for polygon in mesh.polygons]
    first = len(points)
    points += [(0.53, y, z) for z in np.linspace(2.0, 3.4, 8) for y in np.linspace(-0.4, 0.4, 6)]
    faces += [
        (first + 6 * i + j, first + 6 * i + j + 1, first + 6 * i + j + 7, first + 6 * i + j + 6)
        for i in range(7)
        for j in range(5)
    ]
    both = bpy.data.meshes.new("Both")
    both.from_pydata(points, [], faces)
    ob = place("Both", both, rig_of_tube)
    add_turgor(ob)
    ob.turgor.flesh = 0.0
    ob.turgor.repair_folds = True
    for frame in (8, LAST_FRAME):
        bpy.context.scene.frame_set(frame)
        assert new_folds(ob) == 0
        assert folds(runtime, ob).left_count == 0


@pytest.mark.parametrize("method", ["ABSOLUTE", "POINT_CACHE"])
def test_a_bake_repairs_where_the_character_does_not(ob, tmp_path, method: str):
    job = importlib.import_module("addon.bake.job")
    options = importlib.import_module("addon.bake.options")
    chosen = options.Options(method, FRAMES, folder=tmp_path, name="Copy", repair_folds=True, chunk_frames=4)
    made = job.Job(ob, chosen)
    # As by a bake that was killed.
    list(made.compute(range(2)))
    made = job.Job(ob, chosen)
    list(made.run())
    report = made.report
    assert report.resumed_chunks == 2
    assert 0 < report.fold_frame_count < len(FRAMES)
    assert report.folds_found > 0
    assert report.folds_left == 0
    assert "Folds on" in report.as_text()
    assert report.max_error <= 1e-6 * report.size
    live = {}
    for switch in (False, True):
        ob.turgor.repair_folds = switch
        bpy.context.view_layer.update()
        live[switch] = positions(ob)
    baked = positions(made.baked)
    assert np.abs(baked - live[True]).max() <= 1e-6 * report.size
    assert np.abs(baked - live[False]).max() > 1e-3
    # What was computed without repair is not what is asked for.
    ob.turgor.repair_folds = False
    plain = job.Job(ob, options.Options(method, FRAMES, folder=tmp_path, name="Plain", chunk_frames=4))
    list(job.Job(ob, chosen).compute(range(5)))
    list(plain.run())
    assert plain.report.resumed_chunks == 0
    assert plain.report.fold_frame_count is None


def test_the_button_repairs_if_asked(ob, tmp_path):
    ob.turgor_bake.folder, ob.turgor_bake.frames, ob.turgor_bake.repair_folds = str(tmp_path), "18-20", True
    select([ob])
    assert bpy.ops.object.turgor_bake() == {"FINISHED"}
    assert "Folds on" in bpy.context.object.turgor_bake.report


def test_the_command_line_repairs_and_verifies_what_it_baked(ob, tmp_path):
    path, figures = tmp_path / "saved.blend", tmp_path / "figures.json"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    main = importlib.import_module("addon.commands.command_line").main
    target: Path = tmp_path / "baked.blend"
    words = ["bake", "--repair-folds", "--frames", "16-20", "--save", str(target), "--json", str(figures)]
    assert main(words) == 0
    (entry,) = json.loads(figures.read_text())["objects"]
    assert entry["folds_found"] > entry["folds_left"] == 0
    bpy.ops.wm.open_mainfile(filepath=str(target))
    assert not bpy.data.objects["Tube"].turgor.repair_folds
    assert main(["verify", "--error", "0.0001"]) == 0
