"""Without a fitting engine the extension says so and does nothing else."""

from __future__ import annotations

import sys

import bpy
import pytest
import turgor


@pytest.fixture
def unregistered(addon):
    addon.unregister()
    yield addon
    addon.register()


def _missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "turgor", None)


def _too_old(monkeypatch):
    monkeypatch.setattr(turgor, "__version__", "0.0.9")


@pytest.mark.parametrize(("harm", "words"), [(_missing, "engine not found"), (_too_old, "needs 0.1")])
def test_panel_and_log_say_what_to_do(unregistered, warnings_logged, harm, words):
    with pytest.MonkeyPatch.context() as monkeypatch:
        harm(monkeypatch)
        unregistered.register()
        assert words in bpy.types.TURGOR_PT_engine_missing.problem
        assert words in warnings_logged()[0]
        assert not hasattr(bpy.types.Object, "turgor")
        unregistered.unregister()
    assert not hasattr(bpy.types, "TURGOR_PT_engine_missing")
