"""What modifiers after Turgor Volume change is found, with its amount, by a button that moves ours below."""

from __future__ import annotations

import importlib
from collections.abc import Callable

import bpy
import library
import numpy as np
import pytest
from measure import positions, volume
from test_comes_and_goes import _listing
from tube import add_turgor, bend, character, select, set_strength, volume_modifier

FRAME = 15


def _corrective_smooth(ob):
    return ob.modifiers.new("Corrective Smooth", "CORRECTIVE_SMOOTH")


def _smooth(ob):
    smooth = ob.modifiers.new("Smooth", "SMOOTH")
    smooth.iterations = 3
    return smooth


def _cast(ob):
    cast = ob.modifiers.new("Cast", "CAST")
    cast.factor = 0.2
    return cast


def _lattice(ob):
    holder = bpy.data.objects.new("Lattice", bpy.data.lattices.new("Lattice"))
    bpy.context.scene.collection.objects.link(holder)
    holder.scale, holder.location.z = (6.0, 6.0, 6.0), 2.0
    holder.data.points[7].co_deform.x += 0.3
    lattice = ob.modifiers.new("Lattice", "LATTICE")
    lattice.object = holder
    return lattice


def _subdivision(ob):
    return ob.modifiers.new("Subdivision", "SUBSURF")


def _found(runtime, ob: bpy.types.Object) -> dict:
    findings = runtime.character(ob.session_uid).findings
    return {found.subject: found for found in findings if found.id == "later_modifier"}


def _amount(found) -> float:
    return float(found.text.values["percent"].removesuffix(" %"))


def _expected(ob: bpy.types.Object, modifier: bpy.types.Modifier, *, has_rest: bool) -> float:
    """By switching modifiers of the artist's own object, and this folder's own measure of volumes."""

    def ratio() -> float:
        found = []
        for is_on in (False, True):
            modifier.show_viewport = is_on
            bpy.context.view_layer.update()
            found.append(volume(ob))
        return found[1] / found[0]

    posed, at_rest = ratio(), 1.0
    if has_rest:
        for each in (ob.modifiers["Armature"], volume_modifier(ob)):
            each.show_viewport = False
        at_rest = ratio()
        for each in (ob.modifiers["Armature"], volume_modifier(ob)):
            each.show_viewport = True
        bpy.context.view_layer.update()
    return 100.0 * (posed / at_rest - 1.0)


@pytest.mark.parametrize(
    ("kind", "severity"),
    [
        (_corrective_smooth, "WARNING"),
        (_smooth, "WARNING"),
        (_cast, "WARNING"),
        (_lattice, "WARNING"),
        (_subdivision, "INFO"),
    ],
)
def test_the_amount_is_what_an_independent_measure_finds(route, runtime, kind: Callable, severity: str):
    ob, _ = character()
    modifier = kind(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    found = _found(runtime, ob)[modifier.name]
    assert (found.severity, found.fix, found.refusal) == (severity, "MOVE_BELOW", "")
    expected = _expected(ob, modifier, has_rest=kind is not _lattice)
    assert abs(expected) > 0.05
    assert _amount(found) == pytest.approx(expected, abs=2e-3)


def test_what_a_modifier_does_at_rest_is_meant(runtime):
    """A Subdivision Surface shrinks a tube by some per cent; what it does to the posed one beyond that is told."""
    ob, _ = character()
    subdivision = _subdivision(ob)
    without = volume(ob)
    subdivision.show_viewport = False
    bpy.context.view_layer.update()
    assert abs(without / volume(ob) - 1.0) > 0.02
    subdivision.show_viewport = True
    add_turgor(ob)
    bpy.context.scene.frame_set(1)
    assert _found(runtime, ob) == {}
    bpy.context.scene.frame_set(20)
    assert 0.005 < abs(_amount(_found(runtime, ob)["Subdivision"])) < 1.0


def test_each_of_several_is_told_with_its_own_part(runtime):
    ob, _ = character()
    chain = [_corrective_smooth(ob), _cast(ob), _smooth(ob)]
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    found = _found(runtime, ob)
    assert list(found) == [each.name for each in chain]
    whole = np.prod([1.0 + 0.01 * _amount(each) for each in found.values()])
    shown = volume(ob)
    for each in chain:
        each.show_viewport = False
    bpy.context.view_layer.update()
    ratio = shown / volume(ob)
    for each in (ob.modifiers["Armature"], volume_modifier(ob)):
        each.show_viewport = False
    bpy.context.view_layer.update()
    at_rest = volume(ob)
    for each in chain:
        each.show_viewport = True
    bpy.context.view_layer.update()
    assert whole == pytest.approx(ratio / (volume(ob) / at_rest), abs=5e-5)


@pytest.mark.parametrize(
    "kind", ["UV_WARP", "TRIANGULATE", "EDGE_SPLIT", "MASK", "WEIGHTED_NORMAL", "CLOTH", "SOFT_BODY", "BUILD"]
)
def test_what_changes_no_volume_is_not_told(runtime, kind):
    ob, _ = character()
    add_turgor(ob)
    made = ob.modifiers.new(kind, kind)
    if kind == "MASK":
        made.vertex_group = "Bone0"
    bpy.context.scene.frame_set(FRAME)
    assert _found(runtime, ob) == {}


def test_renders_count_too(runtime):
    ob, _ = character()
    modifier = _smooth(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    amount = _amount(_found(runtime, ob)["Smooth"])
    modifier.show_viewport = False
    bpy.context.view_layer.update()
    assert _amount(_found(runtime, ob)["Smooth"]) == amount
    modifier.show_render = False
    bpy.context.view_layer.update()
    assert _found(runtime, ob) == {}


def test_nothing_of_the_scene_is_touched(route, runtime):
    ob, _ = character()
    _corrective_smooth(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME, subframe=0.5)
    before = _listing(), positions(ob), bpy.context.scene.frame_current_final
    figures = runtime.character(ob.session_uid).figures
    assert _found(runtime, ob)
    assert _listing() == before[0]
    bpy.context.view_layer.update()
    assert (positions(ob) == before[1]).all()
    assert bpy.context.scene.frame_current_final == before[2]
    now = runtime.character(ob.session_uid).figures
    assert (now.shown_deviation, now.joints) == (figures.shown_deviation, figures.joints)


def test_it_costs_nothing_per_frame_and_one_look_per_picture(route, runtime, monkeypatch):
    later_modifiers = importlib.import_module("addon.scene.later_modifiers")
    looks = []
    steps = later_modifiers.steps
    monkeypatch.setattr(later_modifiers, "steps", lambda *given: looks.append(given) or steps(*given))
    ob, _ = character()
    _smooth(ob)
    add_turgor(ob)
    for frame in range(2, 10):
        bpy.context.scene.frame_set(frame)
    assert looks == []
    for _ in range(3):
        assert _found(runtime, ob)
        bpy.context.view_layer.update()
    assert len(looks) == 1


def test_a_pose_that_is_not_keyed_is_told_or_nothing_is(runtime):
    """It is seen in the artist's scene alone; what keyframes would show is not what is looked at."""
    ob, rig = character()
    _smooth(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    assert _found(runtime, ob)["Smooth"]
    rig.pose.bones["Bone1"].rotation_euler.x += 0.3
    bpy.context.view_layer.update()
    assert _found(runtime, ob) == {}
    rig.animation_data_clear()
    rig.pose.bones["Bone1"].rotation_euler.x = 1.1
    bpy.context.view_layer.update()
    assert _found(runtime, ob)["Smooth"]


def test_ours_is_moved_below_with_all_it_has():
    modifier_order = importlib.import_module("addon.scene.modifier_order")
    ob, _ = character()
    modifiers = [_corrective_smooth(ob), _cast(ob)]
    add_turgor(ob)
    set_strength(ob, 0.75)
    drivers = sorted(curve.data_path for curve in ob.animation_data.drivers)
    carried = next(held for held in bpy.data.objects if held.turgor.carrier.target == ob)
    ours = volume_modifier(ob)
    modifier_order.move_below(ob, ours, modifiers[0])
    assert [each.name for each in ob.modifiers] == ["Armature", "Corrective Smooth", "Turgor Volume", "Cast"]
    modifier_order.move_below(ob, ours, modifiers[0])
    assert list(ob.modifiers).index(ours) == 2
    assert sorted(curve.data_path for curve in ob.animation_data.drivers) == drivers
    scene_carrier = importlib.import_module("addon.scene.carrier")
    inputs = importlib.import_module("addon.scene.modifier_inputs")
    assert scene_carrier.carrier_of(ob) == carried
    assert inputs.read_input(ours, "Socket_2") == 0.75


def test_the_button_moves_it_or_says_why_not(route, runtime):
    """What cannot be kept below that modifier stays above it, as it was."""
    ob, _ = character()
    _corrective_smooth(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    before = [each.name for each in ob.modifiers]
    found = _found(runtime, ob)["Corrective Smooth"]
    select([ob])
    is_done = bpy.ops.object.turgor_volume_fix(fix=found.fix, subject=found.subject, kind="VOLUME") == {"FINISHED"}
    bpy.context.scene.frame_set(FRAME)
    names = [each.name for each in ob.modifiers]
    assert names == (["Armature", "Corrective Smooth", "Turgor Volume"] if is_done else before)
    assert runtime.character(ob.session_uid).problem is None
    assert ("Corrective Smooth" in _found(runtime, ob)) != is_done


def test_linked_and_overridden_ones_say_why_it_cannot_be_moved(runtime, tmp_path):
    ob, rig = character()
    _corrective_smooth(ob)
    add_turgor(ob)
    tube = library.overridden(library.linked((ob, rig), tmp_path))
    bpy.context.scene.frame_set(FRAME)
    assert "move it there" in _found(runtime, tube)["Corrective Smooth"].refusal


def test_a_healthy_stack_has_no_finding(runtime):
    ob, rig = character()
    bend(rig, 2.0)
    add_turgor(ob)
    for frame in (1, 8, FRAME):
        bpy.context.scene.frame_set(frame)
        assert runtime.character(ob.session_uid).later_findings == ()


def test_with_a_window_it_waits_until_nothing_moves_and_looks_once(route, runtime, monkeypatch):
    """A panel that is drawn only asks; a timer looks, and the panel drawn then has it."""
    strokes = importlib.import_module("addon.live.strokes")
    later_findings = importlib.import_module("addon.live.later_findings")
    later_modifiers = importlib.import_module("addon.scene.later_modifiers")
    looks = []
    steps = later_modifiers.steps
    monkeypatch.setattr(strokes, "CAN_WAIT", True)
    monkeypatch.setattr(later_findings, "SECONDS_TO_REST", 0.0)
    monkeypatch.setattr(later_modifiers, "steps", lambda *given: looks.append(given) or steps(*given))
    ob, _ = character()
    _smooth(ob)
    add_turgor(ob)
    for frame in (FRAME - 1, FRAME):
        bpy.context.scene.frame_set(frame)
        assert _found(runtime, ob) == {}
    assert looks == []
    strokes.finish()
    assert len(looks) == 1
    for _ in range(3):
        assert _found(runtime, ob)["Smooth"]
        bpy.context.view_layer.update()
        strokes.finish()
    assert len(looks) == 1


@pytest.mark.parametrize("has_armature", [False, True])
def test_later_modifiers_of_stacks_that_are_read_as_evaluated(runtime, has_armature):
    """Beyond what they do to the body, which nothing poses."""
    ob, _ = character()
    posing = [_lattice(ob)]
    if has_armature:
        posing.append(ob.modifiers["Armature"])
    else:
        ob.modifiers.remove(ob.modifiers["Armature"])
    add_turgor(ob)
    ob.modifiers.move(list(ob.modifiers).index(volume_modifier(ob)), len(ob.modifiers) - 1)
    later = _smooth(ob)
    bpy.context.scene.frame_set(FRAME)
    assert runtime.character(ob.session_uid).binding.evaluated is not None
    found = _found(runtime, ob)[later.name]

    def ratio() -> float:
        volumes = []
        for is_on in (False, True):
            later.show_viewport = is_on
            bpy.context.view_layer.update()
            volumes.append(volume(ob))
        return volumes[1] / volumes[0]

    posed = ratio()
    posing.append(volume_modifier(ob))
    for each in posing:
        each.show_viewport = False
    assert _amount(found) == pytest.approx(100.0 * (posed / ratio() - 1.0), abs=2e-3)
