"""Every public name of the engine's package says what it is; for compiled ones the stubs say it."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest
import turgor
from sources import REPOSITORY

PACKAGE = REPOSITORY / "rust/python/turgor"
Definition = ast.ClassDef | ast.FunctionDef


def is_property(definition: Definition) -> bool:
    return any(
        isinstance(decorator, ast.Name) and decorator.id == "property" for decorator in definition.decorator_list
    )


def public_definitions(body: list[ast.stmt], prefix: str) -> Iterator[tuple[str, Definition]]:
    """Classes and functions, and the methods of classes; a property may be said by its name."""
    for node in body:
        if isinstance(node, Definition) and not node.name.startswith("_") and not is_property(node):
            yield prefix + node.name, node
            if isinstance(node, ast.ClassDef):
                yield from public_definitions(node.body, f"{prefix}{node.name}.")


def definitions() -> dict[str, Definition]:
    found: dict[str, Definition] = {}
    for file in ("_native.pyi", "presets.py"):
        module = ast.parse((PACKAGE / file).read_text(encoding="utf-8"))
        found.update(public_definitions(module.body, f"{file}:"))
    return found


@pytest.mark.parametrize("name", definitions())
def test_public_name_has_a_docstring(name: str):
    assert ast.get_docstring(definitions()[name])


def test_everything_listed_exists():
    assert all(hasattr(turgor, name) for name in turgor.__all__)
