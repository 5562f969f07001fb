"""Both routes, and how one of them is chosen."""

from __future__ import annotations

import importlib

import bpy
import pytest
from measure import positions
from tube import add_turgor, carrier, character

FRAME = 15


@pytest.fixture
def route_module(addon):
    return importlib.import_module("addon.live.route_choice")


def test_self_test_passes_and_leaves_nothing(route_module):
    before = [len(getattr(bpy.data, kind)) for kind in ("objects", "meshes", "scenes", "node_groups")]
    assert route_module.self_test() is None
    assert [len(getattr(bpy.data, kind)) for kind in ("objects", "meshes", "scenes", "node_groups")] == before


def test_automatic_takes_pull(route_module, runtime):
    ob, _ = character()
    add_turgor(ob)
    assert runtime.session.route == "PULL"


def test_push_serves_where_the_self_test_fails(route_module, runtime, monkeypatch):
    monkeypatch.setattr(route_module, "self_test", lambda: "this Blender reads no ticks")
    ob, _ = character()
    add_turgor(ob)
    assert (runtime.session.route, runtime.session.route_reason) == ("PUSH", "this Blender reads no ticks")


def test_routes_agree_to_the_bit(route_module, runtime, monkeypatch):
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    pulled = positions(ob)
    monkeypatch.setattr(route_module, "preference", lambda: "PUSH")
    bpy.context.scene.frame_set(1)
    ob.update_tag()
    bpy.context.view_layer.update()
    assert runtime.session.route == "PUSH"
    bpy.context.scene.frame_set(FRAME)
    assert (positions(ob) == pulled).all()


def test_pull_never_writes_the_saved_offsets():
    ob, _ = character()
    add_turgor(ob)
    attribute = carrier(ob).data.attributes["turgor_offset"]
    for frame in range(1, FRAME):
        bpy.context.scene.frame_set(frame)
        assert not any(any(item.vector) for item in attribute.data)


def test_each_scene_has_its_own_frame():
    ob, rig = character()
    add_turgor(ob)
    other = bpy.data.scenes.new("Other")
    for member in (ob, rig):
        other.collection.objects.link(member)
    bpy.context.scene.frame_set(FRAME)
    expected = positions(ob)
    other.frame_set(3)
    bpy.context.view_layer.update()
    assert (positions(ob) == expected).all()
