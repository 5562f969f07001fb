"""A bake shows the live mesh: absolute keys, correctives and caches exactly, reduced and driven ones as asked."""

from __future__ import annotations

import importlib
import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from body import add_spine, body, chain, curve
from measure import positions
from tube import LAST_FRAME, add_turgor, character, set_strength

FRAMES = np.arange(1.0, LAST_FRAME + 1.0)
EXACT = ["ABSOLUTE", "CORRECTIVE", "POINT_CACHE"]
EXACT_TOLERANCE = 1e-6
REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture
def bake(addon, tmp_path):
    """Bakes, and returns the copy and its report."""
    job = importlib.import_module("addon.bake.job")
    options = importlib.import_module("addon.bake.options")

    def run(ob, method, frames=FRAMES, **chosen):
        chosen = {"folder": tmp_path, "name": f"{ob.name} Baked"} | chosen
        made = job.Job(ob, options.Options(method, frames, **chosen))
        parts = [progress.part for progress in made.run()]
        assert parts == sorted(parts)
        assert 0.0 < parts[-1] <= 1.0
        return made.baked, made.report

    return run


def size(ob) -> float:
    return float(np.linalg.norm(np.ptp(positions(ob).astype(np.float64), axis=0)))


def at(ob, frame: float) -> np.ndarray:
    bpy.context.scene.frame_set(int(np.floor(frame)), subframe=frame % 1.0)
    return positions(ob).astype(np.float64)


def worst(live, baked, frames) -> float:
    """Largest distance of the copy from the live mesh, relative to its size."""
    length = size(live)
    return max(float(np.linalg.norm(at(live, frame) - at(baked, frame), axis=1).max()) for frame in frames) / length


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("is_dual", [False, True], ids=["linear", "dual"])
def test_exact_bakes_show_the_live_mesh(route, bake, method: str, is_dual: bool):
    ob, _ = character()
    ob.modifiers["Armature"].use_deform_preserve_volume = is_dual
    add_turgor(ob)
    baked, report = bake(ob, method)
    assert worst(ob, baked, FRAMES) <= EXACT_TOLERANCE
    assert len(report.live_errors) == len(report.computed_errors) == len(FRAMES)
    assert report.max_error <= EXACT_TOLERANCE * report.size
    assert abs(report.volume_error_relative) <= EXACT_TOLERANCE


@pytest.mark.parametrize("method", EXACT)
def test_steps_within_frames_are_baked(bake, method: str):
    ob, _ = character()
    add_turgor(ob)
    frames = np.arange(3.0, 6.01, 0.25)
    baked, _ = bake(ob, method, frames)
    assert worst(ob, baked, frames) <= EXACT_TOLERANCE


@pytest.mark.parametrize("method", ["ABSOLUTE", "POINT_CACHE"])
def test_between_frames_stands_a_part_of_both_and_the_ends_hold(bake, method: str):
    ob, _ = character()
    add_turgor(ob)
    baked, _ = bake(ob, method, np.arange(4.0, 12.5, 2.0))
    expected = 0.5 * (at(baked, 6) + at(baked, 8))
    assert np.abs(at(baked, 7) - expected).max() < EXACT_TOLERANCE * size(baked)
    assert np.array_equal(at(baked, 1), at(baked, 4))
    assert np.array_equal(at(baked, 20), at(baked, 12))


@pytest.mark.parametrize("unit_values", [False, True], ids=["signed", "unit"])
def test_reduced_keys_hold_the_error_asked_for(bake, unit_values: bool):
    ob, _ = character()
    add_turgor(ob)
    counts = []
    for relative in (1e-2, 1e-3, 1e-4, 1e-5):
        baked, report = bake(ob, "REDUCED", tolerance=relative * size(ob), unit_values=unit_values)
        assert worst(ob, baked, FRAMES) <= relative
        keys = baked.data.shape_keys.key_blocks[1:]
        assert report.key_count == len(keys)
        counts.append(len(keys))
        for frame in FRAMES:
            at(baked, frame)
            for key in baked.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.shape_keys.key_blocks[1:]:
                assert key.slider_min <= key.value <= key.slider_max
                assert key.slider_max == 1.0
                assert key.slider_min == 0.0 or not unit_values
    assert counts == sorted(counts)
    assert counts[-1] < len(FRAMES)


def test_driven_keys_follow_poses_that_nobody_baked(bake):
    ob, armature = character()
    add_turgor(ob)
    baked, report = bake(ob, "DRIVEN", tolerance=2e-3 * size(ob))
    assert report.max_error <= 4e-3 * report.size
    assert report.held_out_error is not None
    assert report.held_out_error <= 4e-3 * report.size
    assert all(curve.driver.is_valid for curve in baked.data.shape_keys.animation_data.drivers)
    armature.animation_data_clear()
    plain = ob.copy()
    bpy.context.scene.collection.objects.link(plain)
    plain.modifiers.remove(plain.modifiers["Turgor Volume"])
    rng = np.random.default_rng(2)
    for _ in range(5):
        for bone in armature.pose.bones:
            bone.rotation_euler = rng.uniform(-0.6, 0.6, 3)
        bpy.context.view_layer.update()
        live = positions(ob).astype(np.float64)
        lost, left = (np.linalg.norm(positions(other) - live, axis=1).max() for other in (plain, baked))
        assert left < 0.5 * lost


def test_fewer_influences_and_linear_blending_are_made_good(bake):
    ob, _ = character()
    ob.modifiers["Armature"].use_deform_preserve_volume = True
    add_turgor(ob)
    baked, report = bake(ob, "CORRECTIVE", influences=1, use_linear=True)
    assert report.clamped_count == 0
    assert max(len(vertex.groups) for vertex in baked.data.vertices) == 1
    assert not baked.modifiers["Armature"].use_deform_preserve_volume
    assert worst(ob, baked, FRAMES) <= EXACT_TOLERANCE
    assert max(len(vertex.groups) for vertex in ob.data.vertices) == 2


def _with_keys(ob) -> None:
    ob.shape_key_add(name="Basis")
    rest = np.array([vertex.co for vertex in ob.data.vertices])
    for name, factors in (("Fat", (0.4, 0.4, 0.0)), ("Tall", (0.0, 0.0, 0.1))):
        key = ob.shape_key_add(name=name)
        key.points.foreach_set("co", (rest * (1.0 + np.array(factors))).ravel())
        for frame, value in ((1, 0.0), (LAST_FRAME, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)


@pytest.mark.parametrize("method", [*EXACT, "REDUCED", "DRIVEN"])
def test_the_artists_own_keys_are_baked_in_or_kept(bake, method: str):
    ob, _ = character()
    _with_keys(ob)
    add_turgor(ob)
    baked, _ = bake(ob, method, tolerance=2e-3 * size(ob))
    assert worst(ob, baked, FRAMES) <= (EXACT_TOLERANCE if method in EXACT else 6e-3)
    kept = {"Fat", "Tall"} if method in {"CORRECTIVE", "REDUCED", "DRIVEN"} else set()
    keys = baked.data.shape_keys
    assert kept == {"Fat", "Tall"} & set(keys.key_blocks.keys() if keys is not None else ())


@pytest.mark.parametrize("method", [*EXACT, "REDUCED"])
def test_modifiers_before_are_applied_and_those_after_stay(bake, method: str):
    ob, _ = character()
    ob.modifiers.new("First", "SUBSURF").levels = 1
    ob.modifiers.move(len(ob.modifiers) - 1, 0)
    ob.modifiers["First"].render_levels = 1
    add_turgor(ob)
    after = ob.modifiers.new("Second", "SUBSURF")
    after.levels = 1
    baked, _ = bake(ob, method, tolerance=1e-3 * size(ob))
    expected = {"ABSOLUTE": [], "POINT_CACHE": ["Mesh Cache"]}.get(method, ["Armature"])
    assert [modifier.name for modifier in baked.modifiers] == [*expected, "Second"]
    assert worst(ob, baked, FRAMES[::4]) <= (1e-3 if method == "REDUCED" else EXACT_TOLERANCE)


def test_keyed_strength_settings_and_object_motion_are_baked(bake):
    ob, _ = character()
    add_turgor(ob)
    for frame, part in ((1, 0.2), (LAST_FRAME, 1.0)):
        ob.turgor.target_volume = 1.0 + 0.2 * part
        ob.turgor.keyframe_insert("target_volume", frame=frame)
        ob.turgor.joints[1].strength = part
        ob.keyframe_insert(f'turgor.joints["{ob.turgor.joints[1].name}"].strength', frame=frame)
        ob.location.x = part
        ob.keyframe_insert("location", frame=frame)
    set_strength(ob, 0.7)
    for method in EXACT:
        baked, _ = bake(ob, method, np.array([1.0, 7.0, 13.0, 19.0]))
        assert worst(ob, baked, (1, 7, 13, 19)) <= EXACT_TOLERANCE
        world = baked.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world
        assert world == ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world


@pytest.mark.parametrize("by", ["driver", "strength", "strip"])
def test_settings_that_move_without_an_action_are_baked(bake, by: str):
    ob, armature = character()
    add_turgor(ob)
    if by != "strip":
        inputs = importlib.import_module("addon.scene.modifier_inputs")
        strength = inputs.input_path(ob.modifiers["Turgor Volume"], "Socket_2")
        driver = ob.driver_add("turgor.target_volume" if by == "driver" else strength).driver
        variable = driver.variables.new()
        variable.targets[0].id, variable.targets[0].data_path = armature, 'pose.bones["Bone1"].rotation_euler[0]'
        driver.expression = f"1 - 0.2 * {variable.name}"
    else:
        for frame, value in ((1, 1.0), (LAST_FRAME, 1.3)):
            ob.turgor.target_volume = value
            ob.turgor.keyframe_insert("target_volume", frame=frame)
        animation = ob.animation_data
        action, slot = animation.action, animation.action_slot
        animation.action = None
        animation.nla_tracks.new().strips.new("Swell", 1, action).action_slot = slot
    baked, _ = bake(ob, "ABSOLUTE", FRAMES[::3])
    assert worst(ob, baked, FRAMES[::3]) <= EXACT_TOLERANCE


@pytest.mark.parametrize("method", EXACT)
def test_flesh_along_bones_and_skin_together(bake, method: str):
    ob, armature = character()
    add_spine(ob, armature)
    add_turgor(ob)
    baked, _ = bake(ob, method, FRAMES[::3])
    assert worst(ob, baked, FRAMES[::3]) <= EXACT_TOLERANCE


@pytest.mark.parametrize("method", ["ABSOLUTE", "POINT_CACHE"])
@pytest.mark.parametrize("kind", ["BONES", "CURVE"])
def test_bodies_along_a_spine_are_baked(bake, method: str, kind: str):
    ob = body()
    if kind == "BONES":
        add_spine(ob, chain())
    else:
        spine = curve()
        holder = bpy.data.objects.new("Holder", None)
        bpy.context.scene.collection.objects.link(holder)
        hook = spine.modifiers.new("Hook", "HOOK")
        hook.object, hook.falloff_type = holder, "NONE"
        hook.vertex_indices_set([3, 4, 5])
        add_spine(ob, spine)
        for frame, by in ((1, 0.0), (LAST_FRAME, 0.7)):
            holder.location.x = ob.turgor_spine.twist = by
            holder.keyframe_insert("location", frame=frame)
            ob.turgor_spine.keyframe_insert("twist", frame=frame)
    baked, _ = bake(ob, method, FRAMES[::3])
    assert np.ptp([at(baked, frame)[:, 0].max() for frame in (1, 19)]) > 0.05
    assert worst(ob, baked, FRAMES[::3]) <= EXACT_TOLERANCE


def test_nothing_of_the_artists_scene_changes(bake):
    ob, armature = character()
    _with_keys(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(9)
    armature.pose.bones["Bone1"].rotation_euler.z = 0.777
    bpy.context.view_layer.update()
    before = positions(ob)
    lists = {
        name: set(getattr(bpy.data, name).keys()) for name in ("objects", "meshes", "scenes", "armatures", "shape_keys")
    }
    actions = {action.name: _curves(action) for action in bpy.data.actions}
    for method in [*EXACT, "REDUCED", "DRIVEN"]:
        baked, _ = bake(ob, method, tolerance=1e-2)
        assert bpy.context.scene.frame_current == 9
        assert armature.pose.bones["Bone1"].rotation_euler.z == pytest.approx(0.777)
        bpy.data.objects.remove(baked)
    bpy.data.orphans_purge()
    assert {name: set(getattr(bpy.data, name).keys()) for name in lists} == lists
    assert {name: _curves(bpy.data.actions[name]) for name in actions} == actions
    bpy.context.view_layer.update()
    assert np.array_equal(positions(ob), before)


def _curves(action) -> list[str]:
    return [
        curve.data_path
        for layer in action.layers
        for strip in layer.strips
        for bag in strip.channelbags
        for curve in bag.fcurves
    ]


def test_the_report_is_written_beside(bake, tmp_path):
    ob, _ = character()
    add_turgor(ob)
    _, report = bake(ob, "REDUCED", tolerance=1e-2)
    saved = json.loads((tmp_path / "Tube_reduced.json").read_text())
    assert saved["key_count"] == report.key_count
    assert saved["max_error"] == report.max_error <= 1e-2
    assert [error["frame"] for error in saved["live_errors"]] == FRAMES.tolist()
    assert "Largest error" in (tmp_path / "Tube_reduced.txt").read_text()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["Tube_reduced.json", "Tube_reduced.txt"]


def test_the_same_bake_is_the_same_bytes(bake, tmp_path):
    ob, _ = character()
    add_turgor(ob)
    bytes_of = []
    for name in ("one", "two"):
        bake(ob, "POINT_CACHE", folder=tmp_path / name)
        bytes_of.append((tmp_path / name / "Tube.pc2").read_bytes())
    assert bytes_of[0] == bytes_of[1]


@pytest.mark.parametrize("path", sorted((REPOSITORY / ".fixtures").glob("elephant.blend")), ids=lambda path: path.stem)
def test_the_elephants_walk_needs_few_keys(bake, path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    ob = next(ob for ob in scene.objects if ob.type == "MESH" and ob.find_armature() is not None)
    add_turgor(ob)
    frames = np.arange(scene.frame_start, scene.frame_end + 1.0)
    baked, report = bake(ob, "REDUCED", frames, tolerance=0.005 * size(ob))
    assert report.key_count <= 12
    assert worst(ob, baked, frames[::5]) <= 0.005
