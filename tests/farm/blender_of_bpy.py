"""Blender's executable, as far as farms call it, made of its Python module.

[--background] [--addons MODULES] [FILE] --command extension install-file --repo REPO --enable ZIP
[--background] [--addons MODULES] [FILE] --command turgor ARGUMENTS
"""

from __future__ import annotations

import os
import sys

import bpy
from turgor import blender


def main(words: list[str]) -> int:
    """The exit code."""
    before, command = words[: words.index("--command")], words[words.index("--command") + 1 :]
    if command[:2] == ["extension", "install-file"]:
        _, _, _, repository, _, archive = command
        bpy.ops.extensions.package_install_files(filepath=archive, repo=repository, enable_on_install=True)
        return 0
    assert command[0] == "turgor"
    files = [word for word in before if word.endswith(".blend")]
    # The module leaves preferences alone, in which Blender keeps what is enabled.
    command_line = blender.enabled(None)
    for file in files:
        bpy.ops.wm.open_mainfile(filepath=file)
    return command_line.main(command[1:])


if __name__ == "__main__":
    code = main(sys.argv[1:])
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
