"""Builds the extension zip: the add-on, the wheels of the engine, and a manifest that names both versions once.

The version is the one of the Cargo workspace. Blender's own command line tool, plain Python inside the `bpy` module,
builds and validates the zip.
"""

from __future__ import annotations

import argparse
import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
ADDON = REPOSITORY / "addon"
# Of the manual, where `make pictures` took them.
PICTURES = REPOSITORY / "dist" / "pictures"


def workspace_version() -> str:
    """The version of the Cargo workspace, the only place that holds it."""
    with (REPOSITORY / "Cargo.toml").open("rb") as file:
        return tomllib.load(file)["workspace"]["package"]["version"]


def extension_tool() -> Path:
    """Blender's `blender_ext.py`, found without importing `bpy`."""
    specification = importlib.util.find_spec("bpy")
    if specification is None or specification.origin is None:
        raise SystemExit("found no bpy in this Python, need Blender's extension tool: run `make package`")
    return next(Path(specification.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))


def filled_manifest(manifest: str, version: str, wheels: list[Path]) -> str:
    """The manifest with the workspace's version and the list of wheels."""
    listed = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in wheels)
    versioned = re.sub(r'^version = ".*"$', f'version = "{version}"', manifest, flags=re.MULTILINE)
    return versioned.replace("\nwheels = []\n", f"\nwheels = [\n{listed}]\n")


def stage(directory: Path, wheels: list[Path]) -> None:
    """Copies the add-on and the wheels to `directory` and completes the manifest there."""
    shutil.copytree(ADDON, directory, ignore=shutil.ignore_patterns("__pycache__", "wheels"))
    (directory / "wheels").mkdir()
    for wheel in wheels:
        shutil.copy(wheel, directory / "wheels")
    manifest = directory / "blender_manifest.toml"
    manifest.write_text(filled_manifest(manifest.read_text(), workspace_version(), wheels))
    shutil.copy(REPOSITORY / "LICENSE", directory)
    manual = [sys.executable, "-m", "manual", "--output", directory / "manual", "--pictures", PICTURES]
    subprocess.run(manual, check=True, cwd=REPOSITORY)
    # Its own process: Blender's module can be started once.
    assets = directory / "assets" / "turgor_joints.blend"
    subprocess.run([sys.executable, REPOSITORY / "packaging" / "build_assets.py", assets], check=True)


def main() -> None:
    """Builds and validates the zip of the wheels named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheels", type=Path, nargs="+", required=True, help="one per platform")
    parser.add_argument("--output", type=Path, required=True, help="directory of the zip")
    parser.add_argument("--split-platforms", action="store_true", help="one zip per platform instead of one for all")
    options = parser.parse_args()

    tool = [sys.executable, str(extension_tool())]
    split = ["--split-platforms"] if options.split_platforms else []
    with tempfile.TemporaryDirectory() as temporary:
        staged = Path(temporary) / "turgor"
        stage(staged, options.wheels)
        subprocess.run([*tool, "build", "--source-dir", staged, "--output-dir", options.output, *split], check=True)
    for archive in options.output.glob("turgor-*.zip"):
        subprocess.run([*tool, "validate", archive], check=True)


if __name__ == "__main__":
    main()
