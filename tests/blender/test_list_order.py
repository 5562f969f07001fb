"""Which joints the list shows, and in which order. A window draws it; filtering is a function of the settings."""

from __future__ import annotations

import importlib
from types import SimpleNamespace

import bpy
import pytest
from tube import add_turgor, character

SHOWN = 1 << 30


@pytest.fixture
def shown(package):
    """Names that the list shows, in its order."""
    cls = importlib.import_module("addon.panels.joints").TURGOR_UL_joints

    def names(ob, **options):
        settings = {"order": "MOTION", "use_all": False, "filter_name": "", "use_filter_invert": False}
        listed = SimpleNamespace(bitflag_filter_item=SHOWN, **(settings | options))
        flags, places = cls.filter_items(listed, bpy.context, ob.turgor, "joints")
        found = [joint.name for joint in ob.turgor.joints]
        places = places or list(range(len(found)))
        assert sorted(places) == list(range(len(found)))
        ordered = sorted(range(len(found)), key=places.__getitem__)
        return [found[place] for place in ordered if flags[place]]

    return names


def _peaks(ob, *peaks):
    for joint, peak in zip(ob.turgor.joints, peaks, strict=True):
        joint.peak_loss = peak


def test_orders(shown):
    ob, _ = character()
    add_turgor(ob)
    _peaks(ob, 0.5, 0.1, 2.0)
    assert shown(ob) == ["Bone2", "Bone0", "Bone1"]
    assert shown(ob, order="NAME") == shown(ob, order="HIERARCHY") == ["Bone0", "Bone1", "Bone2"]
    bpy.context.scene.frame_set(15)
    figures = importlib.import_module("addon.runtime").character(ob.session_uid).figures.joints
    by_loss = sorted(figures, key=lambda name: -abs(figures[name].lost))
    assert shown(ob, order="NOW") == by_loss


def test_joints_that_never_lose_are_hidden_until_asked_for(shown):
    ob, _ = character()
    add_turgor(ob)
    bpy.context.scene.frame_set(1)
    ob.turgor.active_joint = 2
    _peaks(ob, 0.0, 0.0, 2.0)
    assert shown(ob) == ["Bone2"]
    assert shown(ob, use_all=True, order="NAME") == ["Bone0", "Bone1", "Bone2"]
    ob.turgor.joints["Bone1"].mute = True
    assert shown(ob) == ["Bone2", "Bone1"]
    ob.turgor.active_joint = 0
    assert shown(ob, order="NAME") == ["Bone0", "Bone1", "Bone2"]


def test_what_was_never_measured_is_shown(shown):
    ob, _ = character()
    add_turgor(ob)
    _peaks(ob, -1.0, -1.0, -1.0)
    assert len(shown(ob)) == 3


def test_joints_of_bones_that_are_gone_are_not_listed(shown):
    ob, _ = character()
    add_turgor(ob)
    ob.turgor.joints.add().name = "Gone"
    assert "Gone" not in shown(ob, use_all=True)


def test_the_sidebar_shows_the_characters_of_the_active_armature(package):
    sidebar = importlib.import_module("addon.panels.sidebar")
    ob, rig = character()
    add_turgor(ob)
    ob.name = "Renamed"
    for active in (ob, rig):
        bpy.context.view_layer.objects.active = active
        assert sidebar.shown_characters(bpy.context) == [ob]
        assert sidebar.TURGOR_PT_sidebar.poll(bpy.context)
    camera = bpy.data.objects.new("Camera", None)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.view_layer.objects.active = camera
    assert not sidebar.TURGOR_PT_sidebar.poll(bpy.context)
