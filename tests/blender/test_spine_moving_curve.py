"""A body follows a moving curve in the very frame that is shown, however that was reached."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from body import add_spine, body, curve
from measure import positions
from numpy.typing import NDArray
from tube import LAST_FRAME

# Up, down, in leaps, and twice at the same place.
FRAMES = (1, 2, 3, 4, 19, 18, 17, 1, 20, 7, 7, 13)
# float32 of places of the twin, whose handles Blender has written.
SAME = 2e-6
RENDERED = (5, 20)
# Of 255, per channel: edges may differ by one sample.
SAME_PICTURE = 0.05
KEYS = ((1, 0.0), (8, 0.5), (LAST_FRAME, -0.7))


def _points(spine: bpy.types.Object) -> None:
    for index, point in enumerate(spine.data.splines[0].bezier_points):
        for frame, x in KEYS:
            point.co.x = index * x / 2
            point.keyframe_insert("co", frame=frame)


def _poly_points(spine: bpy.types.Object) -> None:
    point = spine.data.splines[0].points[2]
    for frame, x in KEYS:
        point.co[0] = x
        point.keyframe_insert("co", frame=frame)


def _tilt(spine: bpy.types.Object) -> None:
    for index, point in enumerate(spine.data.splines[0].bezier_points):
        for frame, x in KEYS:
            point.tilt = index * x
            point.keyframe_insert("tilt", frame=frame)


def _shape_key(spine: bpy.types.Object) -> None:
    spine.shape_key_add(name="Basis")
    key = spine.shape_key_add(name="Bow")
    key.data[2].co.x += 0.8
    for frame, x in KEYS:
        key.value = abs(x)
        key.keyframe_insert("value", frame=frame)


def _driven_points(spine: bpy.types.Object) -> None:
    empty = bpy.data.objects.new("Driver", None)
    bpy.context.scene.collection.objects.link(empty)
    for frame, x in KEYS:
        empty.location.x = x
        empty.keyframe_insert("location", frame=frame)
    driver = spine.data.driver_add("splines[0].bezier_points[2].co", 0).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.type = "TRANSFORMS"
    variable.targets[0].id, variable.targets[0].transform_type = empty, "LOC_X"


def _hook(spine: bpy.types.Object) -> None:
    holder = bpy.data.objects.new("Hook", None)
    bpy.context.scene.collection.objects.link(holder)
    modifier = spine.modifiers.new("Hook", "HOOK")
    modifier.object, modifier.falloff_type = holder, "NONE"
    modifier.vertex_indices_set([6, 7, 8])
    for frame, x in KEYS:
        holder.location.x = x
        holder.keyframe_insert("location", frame=frame)


MOTIONS = {
    "points": _points,
    "poly": _poly_points,
    "tilt": _tilt,
    "shape key": _shape_key,
    "driven": _driven_points,
    "hook": _hook,
}


@pytest.fixture(params=MOTIONS)
def moving(request, route) -> tuple[bpy.types.Object, bpy.types.Object]:
    """A body along a curve that moves."""
    ob, spine = body(), curve("POLY" if request.param == "poly" else "BEZIER")
    MOTIONS[request.param](spine)
    bpy.context.scene.frame_set(1)
    add_spine(ob, spine)
    return ob, spine


def _twin(spine: bpy.types.Object) -> tuple[bpy.types.Object, bpy.types.Object]:
    """A body of its own, along a curve without any animation that now is as `spine` is drawn."""
    ob, copy = body("Twin"), curve(spine.data.splines[0].type)
    _copy_drawn(spine, copy)
    add_spine(ob, copy)
    return ob, copy


def _copy_drawn(spine: bpy.types.Object, copy: bpy.types.Object) -> None:
    """The points that Blender makes of the curve in this frame."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = spine.evaluated_get(depsgraph)
    drawn, own = evaluated.to_curve(depsgraph, apply_modifiers=True).splines[0], copy.data.splines[0]
    if own.type == "BEZIER":
        for point, read in zip(own.bezier_points, drawn.bezier_points, strict=True):
            point.handle_left_type = point.handle_right_type = "FREE"
            point.handle_left, point.co, point.handle_right = read.handle_left, read.co, read.handle_right
            point.tilt = read.tilt
    else:
        for point, read in zip(own.points, drawn.points, strict=True):
            point.co, point.tilt = read.co, read.tilt
    evaluated.to_curve_clear()
    bpy.context.view_layer.update()


def _shown(ob: bpy.types.Object, frame: int) -> NDArray[np.float32]:
    bpy.context.scene.frame_set(frame)
    return positions(ob)


@pytest.mark.parametrize("shows_curve", [True, False])
def test_every_frame_is_that_of_the_drawn_curve(moving, shows_curve):
    ob, spine = moving
    twin, copy = _twin(spine)
    spine.hide_viewport = spine.hide_render = not shows_curve
    rest = positions(ob)
    largest = 0.0
    for frame in FRAMES:
        shown = _shown(ob, frame)
        largest = max(largest, np.abs(shown - rest).max())
        spine.hide_viewport = False
        _copy_drawn(spine, copy)
        spine.hide_viewport = not shows_curve
        assert np.abs(shown - positions(twin)).max() <= SAME, frame
    assert largest > 0.1


def test_a_fresh_file_shows_the_same(moving, tmp_path):
    ob, _ = moving
    path = str(tmp_path / "body.blend")
    shown = {frame: _shown(ob, frame) for frame in FRAMES}
    for frame in (2, 13, 20):
        bpy.context.scene.frame_set(frame)
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        ob = bpy.data.objects["Tube"]
        assert (positions(ob) == shown[frame]).all(), frame
        assert (_shown(ob, frame) == shown[frame]).all(), frame


def test_renders_follow_the_same_curve(moving, tmp_path):
    """The pictures are those of the body as a plain mesh of what the viewport shows."""
    ob, _ = moving
    scene = bpy.context.scene
    scene.render.engine, scene.render.filepath = "BLENDER_WORKBENCH", f"{tmp_path}/"
    scene.render.resolution_x, scene.render.resolution_y = 160, 120
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -12.0, 2.0), (np.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    followed, drawn = {}, {}
    for frame in RENDERED:
        followed[frame] = _rendered(frame)
    for frame in RENDERED:
        scene.frame_set(frame)
        mesh = bpy.data.meshes.new_from_object(ob.evaluated_get(bpy.context.evaluated_depsgraph_get()))
        still = bpy.data.objects.new("Still", mesh)
        scene.collection.objects.link(still)
        ob.hide_render = True
        drawn[frame] = _rendered(frame)
        bpy.data.objects.remove(still)
        ob.hide_render = False
    for frame in RENDERED:
        assert np.abs(followed[frame] - drawn[frame]).mean() < SAME_PICTURE, frame


def _rendered(frame: int) -> NDArray[np.float32]:
    """One frame after the first, of 255 per channel."""
    scene = bpy.context.scene
    scene.frame_set(1)
    scene.frame_start = scene.frame_end = frame
    bpy.ops.render.render(animation=True)
    image = bpy.data.images.load(f"{scene.render.filepath}{frame:04d}.png")
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels * 255.0


def _tick_paths(ob: bpy.types.Object) -> list[str]:
    carrier = importlib.import_module("addon.scene.carrier")
    node_group = importlib.import_module("addon.scene.node_group")
    tick = importlib.import_module("addon.scene.drivers").tick_curve(carrier.carrier_of(ob, node_group.SPINE))
    return [variable.targets[0].data_path for variable in tick.driver.variables]


def _save_with_early_tick(ob: bpy.types.Object, path: str) -> None:
    """As files were once saved: the tick waits for the curve's data, not for what the object makes of it."""
    drivers = importlib.import_module("addon.scene.drivers")
    carrier = importlib.import_module("addon.scene.carrier")
    node_group = importlib.import_module("addon.scene.node_group")

    def early(spine: bpy.types.Object) -> list:
        return [
            drivers.Source("TRANSFORMS", "OBJECT", spine, ""),
            drivers.Source("SINGLE_PROP", "CURVE", spine.data, "use_path"),
            *drivers.shape_key_sources(spine.data.shape_keys),
        ]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drivers, "curve_sources", early)
        drivers.write_tick(carrier.carrier_of(ob, node_group.SPINE), early(ob.turgor_spine.curve))
        bpy.ops.wm.save_as_mainfile(filepath=path)
        assert "dimensions[0]" not in _tick_paths(ob)


def test_files_saved_with_an_early_tick_are_healed(moving, tmp_path):
    ob, _ = moving
    path = str(tmp_path / "body.blend")
    expected = [_shown(ob, frame) for frame in FRAMES]
    bpy.context.scene.frame_set(1)
    _save_with_early_tick(ob, path)
    bpy.ops.wm.open_mainfile(filepath=path)
    ob = bpy.data.objects["Tube"]
    assert "dimensions[0]" in _tick_paths(ob)
    for frame, shown in zip(FRAMES, expected, strict=True):
        assert (_shown(ob, frame) == shown).all(), frame


@pytest.mark.parametrize("overridden", [False, True])
def test_linked_bodies_saved_with_an_early_tick_are_healed(overridden, tmp_path):
    ob, spine = body(), curve()
    collection = bpy.data.collections.new("Body")
    bpy.context.scene.collection.children.link(collection)
    for member in (ob, spine):
        collection.objects.link(member)
        bpy.context.scene.collection.objects.unlink(member)
    _points(spine)
    bpy.context.scene.frame_set(1)
    add_spine(ob, spine)
    path, scene_path = str(tmp_path / "body.blend"), str(tmp_path / "scene.blend")
    expected = [_shown(ob, frame) for frame in FRAMES]
    bpy.context.scene.frame_set(1)
    _save_with_early_tick(ob, path)
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.collections = ["Body"]
    collection = wanted.collections[0]
    if overridden:
        collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    else:
        bpy.context.scene.collection.children.link(collection)
    bpy.context.view_layer.update()
    for _ in range(2):
        ob = next(member for member in bpy.context.scene.objects if member.name == "Tube")
        for frame, shown in zip(FRAMES, expected, strict=True):
            assert (_shown(ob, frame) == shown).all(), frame
        assert "dimensions[0]" in _tick_paths(ob)
        bpy.ops.wm.save_as_mainfile(filepath=scene_path)
        bpy.ops.wm.open_mainfile(filepath=scene_path)


@pytest.mark.parametrize("handles", ["AUTO", "VECTOR", "ALIGNED", "FREE"])
@pytest.mark.parametrize("moves", ["points", "shape key"])
def test_handles_lie_where_blender_draws_them(handles, moves):
    """Blender sets handles anew after shape keys, not after keyframes of points, and between vectors it is straight."""
    spine = curve()
    for point in spine.data.splines[0].bezier_points:
        point.handle_left_type = point.handle_right_type = handles
    MOTIONS[moves](spine)
    read_posed = importlib.import_module("addon.scene.spine_curve").read_posed
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        evaluated = spine.evaluated_get(bpy.context.evaluated_depsgraph_get())
        vertices = np.array([vertex.co for vertex in evaluated.to_mesh().vertices], np.float64)
        evaluated.to_mesh_clear()
        read = read_posed(evaluated)
        t = np.linspace(0.0, 1.0, (len(vertices) - 1) // (len(read.points) - 1) + 1)[:-1, None]
        segments = [
            (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
            for a, b, c, d in zip(read.points[:-1], read.right[:-1], read.left[1:], read.points[1:], strict=True)
        ]
        if handles == "VECTOR":
            thirds = (read.right[:-1] - read.points[:-1]) * 3.0 - np.diff(read.points, axis=0)
            assert np.abs(thirds).max() <= SAME
        assert np.abs(np.concatenate([*segments, read.points[-1:]]) - vertices).max() <= SAME, frame
