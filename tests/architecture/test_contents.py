"""What may stand in the repository's files."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from sources import REPOSITORY, tracked_files

# A path of somebody's machine: a home, a mounted or a scratch folder.
MACHINE_PATH = re.compile(r"/home/\w|/Users/\w|/work/\w|/root/\w|[A-Z]:\\\\?Users")
REGISTRY_HOST = re.compile(r"pypi\.org|pythonhosted\.|crates\.io/api|static\.crates|--(extra-)?index-url")
NAMELESS = {"utils", "util", "misc", "helpers", "helper", "common"}
BINARY_SUFFIXES = {".so", ".pyd", ".dylib", ".dll", ".whl", ".zip", ".exe"}
# Text of others, and the lock file that cargo writes.
FOREIGN = {"LICENSE", "Cargo.lock"}


def text_files() -> list[Path]:
    suffixes = {"", ".rs", ".py", ".pyi", ".toml", ".md", ".sh", ".yml", ".txt", ".in", ".html", ".css", ".svg"}
    return [path for path in tracked_files() if path.suffix in suffixes and path.name not in FOREIGN]


@pytest.mark.parametrize("rule", [MACHINE_PATH, REGISTRY_HOST], ids=["machine path", "registry host"])
def test_no_file_names_a_machine(rule: re.Pattern[str]):
    found = [
        f"{path.relative_to(REPOSITORY)}: {match.group()}"
        for path in text_files()
        for match in rule.finditer(path.read_text(encoding="utf-8"))
        if path != Path(__file__).resolve()
    ]
    assert not found


def test_no_file_is_named_after_nothing():
    assert not [path for path in tracked_files() if NAMELESS & set(path.relative_to(REPOSITORY).with_suffix("").parts)]


def test_no_build_product_is_kept():
    assert not [path for path in tracked_files() if path.suffix in BINARY_SUFFIXES]


def test_version_stands_once():
    """The workspace's version is inherited by both crates and read by maturin; the manifest agrees."""
    for crate in ("core", "python"):
        assert "version.workspace = true" in (REPOSITORY / "rust" / crate / "Cargo.toml").read_text(encoding="utf-8")
    assert 'dynamic = ["version"]' in (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")
    with (REPOSITORY / "Cargo.toml").open("rb") as file:
        version = tomllib.load(file)["workspace"]["package"]["version"]
    with (REPOSITORY / "addon/blender_manifest.toml").open("rb") as file:
        assert tomllib.load(file)["version"] == version
