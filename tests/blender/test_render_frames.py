"""What a renderer is handed is the live mesh of its own frame, to the last bit, however the render is made."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, NamedTuple

import bpy
import numpy as np
import pytest
from measure import evaluated_mesh, mesh_positions, positions
from tube import add_turgor, character

MANY_FRAMES = 500
SUBFRAMES = (-0.25, 0.0, 0.25)


class Seen(NamedTuple):
    """A mesh as the renderer got it."""

    scene: str
    view_layer: str
    frame: float
    points: bytes


class Witness(bpy.types.RenderEngine):
    """A render engine that notes down the meshes of the dependency graph it is handed, and draws nothing."""

    bl_idname = "TURGOR_WITNESS"
    bl_label = "Witness"
    seen: ClassVar[list[Seen]] = []
    subframes: ClassVar[tuple[float, ...]] = (0.0,)

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        frame = depsgraph.scene.frame_current
        for part in self.subframes:
            if self.subframes != (0.0,):
                # As Cycles does for motion blur.
                whole = int(np.floor(frame + part))
                self.frame_set(whole, subframe=frame + part - whole)
            points = mesh_positions(evaluated_mesh(bpy.data.objects["Tube"], depsgraph)).tobytes()
            self.seen.append(Seen(depsgraph.scene.name, depsgraph.view_layer.name, frame + part, points))


@pytest.fixture
def scene(addon) -> Iterator[bpy.types.Scene]:
    bpy.utils.register_class(Witness)
    Witness.seen, Witness.subframes = [], (0.0,)
    ob, rig = character()
    add_turgor(ob)
    for bone in rig.pose.bones[1:]:
        bone.rotation_euler = (-1.0, 0.3, 0.2)
        bone.keyframe_insert("rotation_euler", frame=MANY_FRAMES)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = Witness.bl_idname
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.frame_start, scene.frame_end = 1, 12
    scene.frame_set(3)
    yield scene
    bpy.utils.unregister_class(Witness)


def animation(scene: bpy.types.Scene, folder) -> list[Seen]:
    scene.render.filepath = f"{folder}/"
    Witness.seen = []
    bpy.ops.render.render(animation=True, scene=scene.name)
    return Witness.seen


def live(frame: float) -> bytes:
    bpy.context.scene.frame_set(int(np.floor(frame)), subframe=frame % 1.0)
    return positions(bpy.data.objects["Tube"]).tobytes()


def check(seen: list[Seen], frames: list[float]) -> None:
    assert [each.frame for each in seen] == frames
    assert len({each.points for each in seen}) == len(set(frames))
    for each in seen:
        assert each.points == live(each.frame), each.frame


@pytest.mark.parametrize("is_persistent", [False, True], ids=["anew", "persistent"])
def test_many_frames(route, scene, tmp_path, is_persistent: bool):
    scene.render.use_persistent_data = is_persistent
    scene.frame_end = MANY_FRAMES if route == "PULL" else 60
    seen = animation(scene, tmp_path)
    assert scene.frame_current == 3
    check(seen, list(range(1, scene.frame_end + 1)))


def test_one_frame_after_another_in_any_order(route, scene):
    for frame in (9, 2, 9, 30, 1):
        scene.frame_set(frame)
        Witness.seen = []
        bpy.ops.render.render()
        check(Witness.seen, [frame])


def test_shutter_times(route, scene, tmp_path):
    Witness.subframes = SUBFRAMES
    scene.frame_start, scene.frame_end = 2, 4
    check(animation(scene, tmp_path), [frame + part for frame in (2, 3, 4) for part in SUBFRAMES])


def test_several_view_layers_and_scenes_at_other_frames(route, scene, tmp_path):
    scene.view_layers.new("Second")
    other = bpy.data.scenes.new("Other")
    for ob in scene.collection.objects:
        other.collection.objects.link(ob)
    other.camera, other.render.engine = scene.camera, Witness.bl_idname
    other.render.resolution_x = other.render.resolution_y = 8
    other.frame_start, other.frame_end = 8, 10
    scene.frame_end = 3
    first = animation(scene, tmp_path)
    second = animation(other, tmp_path)
    assert {each.view_layer for each in first} == {layer.name for layer in scene.view_layers}
    for layer in scene.view_layers:
        check([each for each in first if each.view_layer == layer.name], [1, 2, 3])
    check(second, [8, 9, 10])


def test_without_the_extension_a_file_shows_plain_skinning(addon, scene, tmp_path):
    """Saved and rendered in a bent pose: nothing of the last frame stays behind in the file."""
    ob = bpy.data.objects["Tube"]
    scene.frame_set(11)
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    modifier = ob.modifiers["Turgor Volume"]
    modifier.show_viewport = modifier.show_render = False
    plain = [live(frame) for frame in range(1, 13)]
    addon.unregister()
    try:
        bpy.ops.wm.open_mainfile(filepath=path)
        assert bpy.data.objects["Tube"].modifiers["Turgor Volume"].show_render
        seen = animation(bpy.context.scene, tmp_path)
        assert [each.points for each in seen] == plain
        assert [live(frame) for frame in range(1, 13)] == plain
    finally:
        addon.register()
