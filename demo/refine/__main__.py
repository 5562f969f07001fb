"""python -m demo.refine --extension ZIP --output DIRECTORY."""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path


def main() -> None:
    """Refines every character in a Blender of its own, with the extension's operators."""
    parser = argparse.ArgumentParser(prog="python -m demo.refine", description="Characters before and after Refine")
    parser.add_argument("--extension", type=Path, required=True, help="zip of the extension")
    parser.add_argument("--output", type=Path, required=True, help="directory for report.json and pictures")
    parser.add_argument("--only", action="append", metavar="NAME", help="of these characters")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory() as resources:
        # Blender reads it when `bpy` is imported.
        os.environ["BLENDER_USER_RESOURCES"] = resources
        from .. import extension

        with extension.installed(options.extension, Path(resources)):
            # Only now: the zip brought the engine.
            from . import show

            show.show(options.output, options.only)


if __name__ == "__main__":
    main()
