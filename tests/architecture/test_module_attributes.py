"""What the add-on reads of one of its own modules is there: type checkers are told to be silent about Blender's."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ADDON = Path(__file__).resolve().parents[2] / "addon"
# What has names of its own.
SCOPES = (ast.FunctionDef, ast.Lambda, ast.GeneratorExp, ast.ListComp, ast.SetComp, ast.DictComp)
FILES = sorted(path for path in ADDON.rglob("*.py") if "presets" not in path.parts)


def _module(folder: Path, name: str) -> Path | None:
    found = (folder / f"{name}.py", folder / name / "__init__.py")
    return next((path for path in found if path.is_file()), None)


def _imported(path: Path, tree: ast.Module) -> dict[str, Path]:
    """By the name that it has in the file, each module of ours that is imported as a whole."""
    modules: dict[str, Path] = {}
    for node in ast.walk(tree):
        if not isinstance(node, ast.ImportFrom) or not node.level:
            continue
        folder = path.parent
        for _ in range(node.level - 1):
            folder = folder.parent
        folder = folder.joinpath(*(node.module or "").split(".")) if node.module else folder
        for alias in node.names:
            found = _module(folder, alias.name) if folder.is_dir() else None
            if found is not None:
                modules[alias.asname or alias.name] = found
    return modules


def _names(path: Path) -> set[str]:
    """What a module has: all that it binds, wherever that is done, and the modules beside a package's file."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names = {"__name__", "__doc__", "__file__", "__package__"}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names |= {(alias.asname or alias.name).partition(".")[0] for alias in node.names}
    if path.name == "__init__.py":
        names |= {beside.stem for beside in path.parent.iterdir()}
    return names


def _bound_within(function: ast.AST) -> set[str]:
    """Names of a function's own: its arguments, and what it binds."""
    own = {node.arg for node in ast.walk(function) if isinstance(node, ast.arg)}
    return own | {
        node.id for node in ast.walk(function) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }


def _reads(node: ast.AST, hidden: frozenset[str] = frozenset()) -> Iterator[tuple[str, str, int]]:
    """Name, attribute and line of each attribute that is read of a name which nothing hides."""
    if isinstance(node, SCOPES):
        hidden = hidden | _bound_within(node)
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id not in hidden:
        yield node.value.id, node.attr, node.lineno
    for child in ast.iter_child_nodes(node):
        yield from _reads(child, hidden)


def _missing(path: Path) -> list[str]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    modules = _imported(path, tree)
    has = {name: _names(module) for name, module in modules.items()}
    return [
        f"line {line}: {name}.{attribute}"
        for name, attribute, line in _reads(tree)
        if name in has and attribute not in has[name]
    ]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ADDON)))
def test_what_is_read_of_our_modules_is_there(path: Path) -> None:
    assert _missing(path) == []


def test_what_is_not_there_is_found(tmp_path: Path) -> None:
    (tmp_path / "shapes.py").write_text("def area(): ...\n", encoding="utf-8")
    user = tmp_path / "user.py"
    user.write_text(
        "from . import shapes\n"
        "def ours():\n    shapes.area()\n    shapes.volume()\n"
        "def own(shapes):\n    shapes.other()\n",
        encoding="utf-8",
    )
    assert _missing(user) == ["line 4: shapes.volume"]
