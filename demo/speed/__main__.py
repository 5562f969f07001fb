"""python -m demo.speed --extension ZIP."""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path

# A bake is hundreds of frames.
BAKES_PART = 4


def main() -> None:
    """Times characters in a Blender of its own, with the engine out of the extension."""
    parser = argparse.ArgumentParser(prog="python -m demo.speed", description="How long frames take")
    parser.add_argument("--extension", type=Path, required=True, help="zip of the extension")
    parser.add_argument("--turns", type=int, default=16, help="without and with Turgor so many times in turn")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory() as resources:
        # Blender reads it when `bpy` is imported.
        os.environ["BLENDER_USER_RESOURCES"] = resources
        from .. import extension

        with extension.installed(options.extension, Path(resources)):
            # Only now: the zip brought the engine.
            from . import bakes, race

            race.run(options.turns)
            bakes.run(max(options.turns // BAKES_PART, 1), resources)


if __name__ == "__main__":
    main()
