"""Reads the arguments, runs the command, and turns what came of it into an exit code."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any

import bpy
from turgor import TurgorError

from .. import runtime
from ..live import start
from . import bake, check, export, outcome, refine, report, verify

COMMANDS = (check, report, bake, verify, export, refine)
# What is wrong with the file, the disk or the settings: said in a line. All else is a bug, with its traceback.
REFUSALS = (ValueError, OSError, TurgorError)
NAME = "turgor"


def parser() -> argparse.ArgumentParser:
    """The parser of the command line, with a subparser for each command."""
    made = argparse.ArgumentParser(
        prog=NAME,
        description="Turgor without a window",
        epilog="Exit codes: 0 fine, 1 something is off, 2 wrong arguments, 3 failed.",
    )
    commands = made.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in COMMANDS:
        each = commands.add_parser(module.NAME, help=module.HELP, description=module.DESCRIPTION)
        module.add_arguments(each)
        each.add_argument("--json", metavar="FILE", help="write all figures there; - for the standard output")
        each.set_defaults(run=module.run)
    return made


def main(argv: Sequence[str]) -> int:
    """Work on the open file: the exit code."""
    try:
        arguments = parser().parse_args(list(argv))
    except SystemExit as stop:
        return outcome.FINE if not stop.code else outcome.USAGE
    try:
        if not runtime.session.is_started:
            start.start()
        start.bind_waiting()
        found = arguments.run(arguments)
        outcome.show(arguments.command, found, arguments.json)
    except REFUSALS as error:
        print(f"{NAME}: {error}", file=sys.stderr, flush=True)
        return outcome.FAILED
    return outcome.FINE if found.is_fine else outcome.OFF


_registered: list[Any] = []


def register() -> None:
    _registered.append(bpy.utils.register_cli_command(NAME, main))


def unregister() -> None:
    bpy.utils.unregister_cli_command(_registered.pop())
