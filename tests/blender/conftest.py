"""Every test starts from an empty file with the add-on registered from the sources."""

from __future__ import annotations

import importlib
import logging
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest

bpy = pytest.importorskip("bpy", reason="runs inside Blender's Python module")

REPOSITORY = Path(__file__).resolve().parents[2]
FIXTURES = REPOSITORY / ".fixtures"


@pytest.fixture(scope="session")
def package() -> ModuleType:
    sys.path.insert(0, str(REPOSITORY))
    return importlib.import_module("addon")


@pytest.fixture(autouse=True)
def addon(package: ModuleType):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    package.register()
    yield package
    package.unregister()


@pytest.fixture
def runtime(package: ModuleType) -> ModuleType:
    return importlib.import_module("addon.runtime")


@pytest.fixture
def warnings_logged(caplog: pytest.LogCaptureFixture):
    """Texts that the add-on wrote to its log so far."""
    caplog.set_level(logging.WARNING, logger="turgor")
    return lambda: [record.getMessage() for record in caplog.records if record.name == "turgor"]


@pytest.fixture(params=["PULL", "PUSH"])
def route(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, addon: ModuleType) -> str:
    """Runs a test on both routes, forced as by the preference."""
    module = importlib.import_module("addon.live.route_choice")
    monkeypatch.setattr(module, "preference", lambda: request.param)
    return request.param


_exit_status = 0


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    global _exit_status
    _exit_status = int(session.exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure() -> None:
    """Once EEVEE has run, Blender's module may wait forever for its own graphics thread while Python ends."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(_exit_status)
