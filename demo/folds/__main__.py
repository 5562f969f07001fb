"""python -m demo.folds --extension ZIP --output DIRECTORY."""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path


def main() -> None:
    """Bends every body in a Blender of its own, with the engine out of the extension."""
    parser = argparse.ArgumentParser(prog="python -m demo.folds", description="Folds with and without repair")
    parser.add_argument("--extension", type=Path, required=True, help="zip of the extension")
    parser.add_argument("--output", type=Path, required=True, help="directory for report.json and pictures")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory() as resources:
        # Blender reads it when `bpy` is imported.
        os.environ["BLENDER_USER_RESOURCES"] = resources
        from .. import extension

        with extension.installed(options.extension, Path(resources)):
            # Only now: the zip brought the engine.
            from . import show

            show.show(options.output)


if __name__ == "__main__":
    main()
