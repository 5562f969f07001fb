"""The volume error that is shown is measured on the mesh that is shown, whatever the engine says of itself."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from measure import volume
from tube import add_turgor, character, set_strength, volume_modifier

FRAME = 15


def _prepared() -> tuple[bpy.types.Object, float]:
    ob, _ = character()
    rest = volume(ob)
    add_turgor(ob)
    bpy.context.scene.frame_set(FRAME)
    return ob, rest


def _percent(ob: bpy.types.Object, rest: float) -> float:
    return 100.0 * (volume(ob) / rest - 1.0)


@pytest.mark.parametrize("strength", [1.0, 0.5, 0.0])
def test_it_is_what_an_independent_measure_finds(route, runtime, strength):
    ob, rest = _prepared()
    # Half of a small correction is half of its volume; what the law of flesh adds is not small.
    ob.turgor.flesh = 0.0
    set_strength(ob, strength)
    bpy.context.view_layer.update()
    figures = runtime.character(ob.session_uid).figures
    assert figures.shown_deviation == pytest.approx(_percent(ob, rest), abs=2e-5)
    assert abs(figures.corrected_deviation) < 1e-9
    assert figures.skinned_deviation < -0.3
    assert figures.shown_deviation == pytest.approx((1.0 - strength) * figures.skinned_deviation, abs=0.1)


def test_what_stands_after_ours_is_part_of_it(runtime):
    ob, rest = _prepared()
    ob.modifiers.new("Smooth", "SMOOTH").iterations = 5
    bpy.context.scene.frame_set(FRAME + 1)
    figures = runtime.character(ob.session_uid).figures
    assert figures.shown_deviation < -1.0
    assert figures.shown_deviation == pytest.approx(_percent(ob, rest), abs=2e-5)


def test_before_is_skinning_as_shown(runtime):
    ob, rest = _prepared()
    volume_modifier(ob).show_viewport = False
    bpy.context.scene.frame_set(FRAME + 1)
    figures = runtime.character(ob.session_uid).figures
    assert figures.shown_deviation == pytest.approx(_percent(ob, rest), abs=2e-5)
    assert figures.shown_deviation == pytest.approx(figures.skinned_deviation, abs=2e-5)


def test_other_vertices_are_not_measured(runtime):
    ob, _ = _prepared()
    ob.modifiers.new("Subdivision", "SUBSURF")
    bpy.context.scene.frame_set(FRAME + 1)
    assert runtime.character(ob.session_uid).figures.shown_deviation is None


def test_a_wrong_mesh_cannot_hide_behind_the_solver(runtime, monkeypatch):
    """The engine believes that it has succeeded; what it wrote is lost on the way."""
    ob, rest = _prepared()
    frame_by_kind = importlib.import_module("addon.live.frame_by_kind")
    live = importlib.import_module("addon.live.frame")

    def lossy(target: bpy.types.Object, address: int, vertex_count: int) -> bool:
        room = np.zeros((vertex_count, 3), np.float32)
        live.correct(target, room.ctypes.data, vertex_count)
        return False

    monkeypatch.setitem(frame_by_kind.FRAMES, "VOLUME", lossy)
    bpy.context.scene.frame_set(FRAME + 1)
    figures = runtime.character(ob.session_uid).figures
    assert abs(figures.corrected_deviation) < 1e-9
    assert figures.shown_deviation == pytest.approx(_percent(ob, rest), abs=2e-5)
    assert figures.shown_deviation < -0.3
