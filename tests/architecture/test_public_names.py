"""Every public name of the engine's package says what it is."""

from __future__ import annotations

import inspect

import pytest
import turgor


def public_objects() -> dict[str, object]:
    """Classes and functions of `turgor` and `turgor.presets`, with the public members of the classes."""
    found: dict[str, object] = {}
    for module in (turgor, turgor.presets):
        for name, value in vars(module).items():
            if name.startswith("_") or not (inspect.isclass(value) or inspect.isroutine(value)):
                continue
            if not str(value.__module__).startswith("turgor"):
                continue
            found[name] = value
            if inspect.isclass(value):
                own = {key: member for key, member in vars(value).items() if not key.startswith("_")}
                found.update({f"{name}.{key}": member for key, member in own.items()})
    return found


@pytest.mark.parametrize("name", sorted(public_objects()))
def test_public_name_has_a_docstring(name: str):
    assert (inspect.getdoc(public_objects()[name]) or "").strip()


def test_everything_listed_exists():
    assert all(hasattr(turgor, name) for name in turgor.__all__)
