"""Turgor: a mesh bent by an armature keeps its exact volume, in the viewport and in renders."""

from __future__ import annotations

import logging

# Major and minor version of the engine whose calls this add-on makes.
ENGINE_VERSION = "0.1"

_log = logging.getLogger("turgor")


def _engine_problem() -> str | None:
    """Why the compiled engine cannot be used, or None when it can."""
    try:
        import turgor
    except ImportError as error:
        return f"engine not found ({error}): install the Turgor extension zip of your platform"
    found = turgor.__version__
    if found.split(".")[:2] != ENGINE_VERSION.split("."):
        return f"engine is version {found}, needs {ENGINE_VERSION}: reinstall Turgor and restart Blender"
    return None


def register() -> None:
    problem = _engine_problem()
    if problem is None:
        from . import registration

        registration.register()
    else:
        from .panels import engine_missing

        _log.error("%s", problem)
        engine_missing.register(problem)


def unregister() -> None:
    from .panels import engine_missing

    if engine_missing.is_registered():
        engine_missing.unregister()
    else:
        from . import registration

        registration.unregister()
