"""What a command hands back, and what becomes of it."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..logic import whole_file

# Exit codes.
FINE, OFF, USAGE, FAILED = range(4)
# Of the JSON, so that others can tell what they read.
FORMAT = 1
TO_STANDARD_OUTPUT = "-"


class CommandError(ValueError):
    """Why a command did not do its work, and what to do."""


@dataclass
class Outcome:
    """What a command found: equal for equal files, on any machine and however long it took."""

    is_fine: bool
    data: dict[str, Any]  # for programs
    lines: list[str] = field(default_factory=list)  # for people


def show(command: str, outcome: Outcome, json_path: str | None) -> None:
    """Lines go to the standard output, or to the error output where the JSON takes its place.

    Raises whole_file.WriteError.
    """
    lines_to = sys.stderr if json_path == TO_STANDARD_OUTPUT else sys.stdout
    for line in outcome.lines:
        print(line, file=lines_to)
    if json_path is not None:
        found = {"format": FORMAT, "command": command, "is_fine": outcome.is_fine, **outcome.data}
        text = json.dumps(found, indent=1) + "\n"
        if json_path == TO_STANDARD_OUTPUT:
            sys.stdout.write(text)
        else:
            with whole_file.written(Path(json_path)) as file:
                file.write(text.encode())
    sys.stdout.flush()
    sys.stderr.flush()
