"""python -m demo FILE --extension ZIP --output DIRECTORY."""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path


def main() -> None:
    """Shows one file in a Blender of its own, whose settings and extensions are thrown away afterwards."""
    parser = argparse.ArgumentParser(prog="python -m demo", description="A character with and without Turgor")
    parser.add_argument("file", type=Path, help=".blend, .glb, .gltf or .fbx with a rigged character")
    parser.add_argument("--extension", type=Path, required=True, help="zip of the extension")
    parser.add_argument("--output", type=Path, required=True, help="directory for report.json, index.html and pictures")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory() as resources:
        # Blender reads it when `bpy` is imported.
        os.environ["BLENDER_USER_RESOURCES"] = resources
        from . import extension

        with extension.installed(options.extension, Path(resources)):
            # Only now: the zip brought the engine.
            from . import show

            show.show(options.file, options.output)


if __name__ == "__main__":
    main()
