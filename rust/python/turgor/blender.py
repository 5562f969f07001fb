"""The extension's commands without Blender's executable: `python -m turgor.blender FILE.blend check`.

Needs Blender's Python module, `bpy`, beside this package, and the Turgor extension: installed there, or as a zip.
Commands and exit codes are those of `blender -b FILE.blend --command turgor`.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
import tempfile
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

EXTENSION = "turgor"
COMMANDS = ("check", "report", "bake", "verify", "export", "refine")
FAILED = 3


class SetupError(RuntimeError):
    """Why no command can be run; says what was found, what is needed, what to do."""


def main(argv: Sequence[str] | None = None) -> int:
    """Open the file and run the command: its exit code."""
    given = list(sys.argv[1:] if argv is None else argv)
    parser = argparse.ArgumentParser(
        prog="python -m turgor.blender",
        usage="%(prog)s FILE.blend [--extension ZIP] COMMAND …",
        description=f"Run a Turgor command ({', '.join(COMMANDS)}) on a file, in Blender's Python module.",
        epilog="COMMAND --help says what it takes.",
    )
    parser.add_argument("file", type=Path, metavar="FILE.blend", help="what to open")
    parser.add_argument("--extension", type=Path, metavar="ZIP", help="use this extension, not an installed one")
    start = next((place for place, word in enumerate(given) if place > 0 and word in COMMANDS), len(given))
    options, arguments = parser.parse_args(given[:start]), given[start:]
    if not arguments:
        parser.error(f"need a command: {', '.join(COMMANDS)}")
    # Preferences and extensions of the machine stay as they are.
    with nullcontext() if options.extension is None else tempfile.TemporaryDirectory() as resources:
        if resources is not None:
            # Blender reads it when `bpy` is imported.
            os.environ["BLENDER_USER_RESOURCES"] = resources
        try:
            command_line = enabled(options.extension)
            open_file(options.file)
        except SetupError as error:
            print(f"turgor: {error}", file=sys.stderr, flush=True)
            return FAILED
        return command_line.main(arguments)


def enabled(archive: Path | None) -> Any:
    """The extension's module of commands. Raises SetupError."""
    bpy = blender()
    if archive is not None:
        install(bpy, archive)
    else:
        enable(bpy)
    name = next((name for name in enabled_addons(bpy) if is_ours(name)), None)
    if name is None:
        raise SetupError("the Turgor extension could not be enabled, see the messages above")
    try:
        return importlib.import_module(f"{name}.commands.command_line")
    except ImportError as error:
        raise SetupError(f"the installed Turgor extension has no commands ({error}): update it") from error


def enabled_addons(bpy: Any) -> list[str]:
    """Their modules."""
    return [addon.module for addon in bpy.context.preferences.addons]


def blender() -> ModuleType:
    """Blender's Python module. Raises SetupError."""
    try:
        return importlib.import_module("bpy")
    except ImportError as error:
        raise SetupError(
            f"found no bpy in this Python ({error}): install it with pip, or use blender --command turgor"
        ) from error


def install(bpy: Any, archive: Path) -> None:
    """Installs and enables the zip. Raises SetupError."""
    if not archive.is_file():
        raise SetupError(f"there is no extension {archive}: give the path of its zip")
    try:
        bpy.ops.extensions.package_install_files(
            filepath=str(archive.resolve()), repo="user_default", enable_on_install=True
        )
    except RuntimeError as error:
        raise SetupError(f"{archive.name} could not be installed: {str(error).strip()}") from error


def enable(bpy: Any) -> None:
    """Enables the installed extension where it is off. Raises SetupError."""
    if any(is_ours(name) for name in enabled_addons(bpy)):
        return
    addon_utils = importlib.import_module("addon_utils")
    name = next((module.__name__ for module in addon_utils.modules() if is_ours(module.__name__)), None)
    if name is None:
        raise SetupError(
            f"no Turgor extension is installed in {bpy.utils.resource_path('USER')}: install it, or give its zip with"
            " --extension"
        )
    addon_utils.enable(name, default_set=True)


def is_ours(module: str) -> bool:
    """Whether an add-on's module is Turgor, from whatever repository."""
    return module.startswith("bl_ext.") and module.rpartition(".")[2] == EXTENSION


def open_file(path: Path) -> None:
    """Raises SetupError."""
    if not path.is_file():
        raise SetupError(f"there is no file {path}")
    try:
        blender().ops.wm.open_mainfile(filepath=str(path.resolve()))
    except RuntimeError as error:
        raise SetupError(f"{path.name} cannot be opened: {str(error).strip()}") from error


def leave(code: int) -> NoReturn:
    """End the process at once: Blender's module may crash when Python takes it down."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


if __name__ == "__main__":
    leave(main())
