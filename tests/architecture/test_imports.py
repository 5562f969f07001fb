"""Who may import whom (docs/ARCHITECTURE.md)."""

from __future__ import annotations

from pathlib import Path

import pytest
from sources import REPOSITORY, imported_modules, python_files

BLENDER = {"bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "blf", "bl_ui", "bpy_extras", "addon_utils"}

# Part of the extension -> the parts it may import besides itself. A part is a module or package directly in addon/.
JOINING = {"logic", "scene", "properties", "states", "runtime", "messages"}
ALLOWED_PARTS = {
    "messages": set(),
    "translations": set(),
    "presets": set(),
    "logic": {"messages"},
    "scene": {"messages"},
    "properties": set(),
    "states": {"logic", "scene"},
    "runtime": {"logic", "states"},
    "panels": {"properties", "runtime", "states", "messages"},
    "overlays": {"properties", "runtime", "states", "messages"},
    "migrations": {"properties", "scene"},
    "live": JOINING,
    "handlers": JOINING | {"live", "migrations"},
    "bake": JOINING | {"live"},
    "operators": JOINING | {"live", "bake"},
    "commands": JOINING | {"live", "bake"},
    # Without an engine only the panel that says so is shown.
    "__init__": {"registration", "panels"},
}
ALLOWED_PARTS["registration"] = ALLOWED_PARTS.keys() - {"__init__"}
# What these parts may import besides where it only names types: they draw, they never compute.
TYPES_ONLY = {"panels": {"logic"}, "overlays": {"logic"}}


def part_of(path: Path) -> str:
    """The part of the extension that a file belongs to."""
    return path.relative_to(REPOSITORY / "addon").parts[0].removesuffix(".py")


def roots(modules: set[str]) -> set[str]:
    """First names of dotted names."""
    return {module.partition(".")[0] for module in modules}


def imported_parts(path: Path, *, with_types: bool) -> set[str]:
    """Parts of the extension that a file imports; with_types: also those under `if TYPE_CHECKING`."""
    modules = imported_modules(path, with_types=with_types)
    return {module.split(".")[1] for module in modules if module.startswith("addon.")} & ALLOWED_PARTS.keys()


def addon_files() -> list[Path]:
    return python_files("addon")


def name_of(path: Path) -> str:
    return str(path.relative_to(REPOSITORY))


def test_every_part_of_the_extension_has_a_rule():
    assert {part_of(path) for path in addon_files()} <= ALLOWED_PARTS.keys()


@pytest.mark.parametrize("path", addon_files(), ids=name_of)
def test_part_imports_only_what_it_may(path: Path):
    own = part_of(path)
    assert imported_parts(path, with_types=False) <= ALLOWED_PARTS[own] | {own}
    assert imported_parts(path, with_types=True) <= ALLOWED_PARTS[own] | TYPES_ONLY.get(own, set()) | {own}


@pytest.mark.parametrize("path", python_files("addon/logic"), ids=name_of)
def test_logic_runs_without_blender(path: Path):
    assert not roots(imported_modules(path)) & BLENDER


@pytest.mark.parametrize("path", python_files("addon/scene"), ids=name_of)
def test_scene_does_not_compute(path: Path):
    assert "turgor" not in roots(imported_modules(path))


# Runs the extension's commands in Blender's Python module; nothing of the package imports it.
COMMAND_LINE = REPOSITORY / "rust/python/turgor/blender.py"


@pytest.mark.parametrize("path", python_files("rust/python"), ids=name_of)
def test_engine_knows_neither_blender_nor_the_extension(path: Path):
    modules = imported_modules(path)
    assert "turgor.blender" not in modules
    assert not roots(modules) & ({"addon"} if path == COMMAND_LINE else BLENDER | {"addon"})


@pytest.mark.parametrize("path", python_files("addon"), ids=name_of)
def test_extension_imports_itself_relatively(path: Path):
    absolute = {"addon", *ALLOWED_PARTS} - {"__init__"}
    lines = path.read_text(encoding="utf-8").splitlines()
    assert not [line for line in lines if line.split()[:1] in (["import"], ["from"]) and line.split()[1] in absolute]


def test_core_crate_depends_on_neither_python_nor_blender():
    manifest = (REPOSITORY / "rust/core/Cargo.toml").read_text(encoding="utf-8")
    assert "pyo3" not in manifest
    assert "numpy" not in manifest
