"""What all demonstrations have in common: the zip of the extension, and a Blender of their own to install it in."""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def parser(module: str, description: str, output: str | None) -> argparse.ArgumentParser:
    """For `python -m MODULE`. output: what is written to the directory `--output`; None has no such option."""
    made = argparse.ArgumentParser(prog=f"python -m {module}", description=description)
    made.add_argument("--extension", type=Path, required=True, help="zip of the extension")
    if output is not None:
        made.add_argument("--output", type=Path, required=True, help=f"directory for {output}")
    return made


@contextmanager
def own_blender(extension_zip: Path) -> Iterator[str]:
    """With the extension, whose zip also brings the engine: `bpy` and `turgor` can be imported within, not before.

    Its settings and extensions lie in the directory that is given, and are thrown away at the end.
    """
    with tempfile.TemporaryDirectory() as resources:
        # Blender reads it when `bpy` is imported.
        os.environ["BLENDER_USER_RESOURCES"] = resources
        from . import extension

        with extension.installed(extension_zip, Path(resources)):
            yield resources
