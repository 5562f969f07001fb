"""Mutants that `cargo mutants` could break unnoticed by Rust's tests, read from its output folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple


class MissedMutant(NamedTuple):
    """One change of one place."""

    name: str  # file, line, column and what is changed
    diff: Path  # of the file as it was against the file with the change


def read_missed(folder: Path) -> list[MissedMutant]:
    """In the order in which they were tried. folder: `mutants.out`, of a run that may still go on."""
    outcomes = json.loads((folder / "outcomes.json").read_text(encoding="utf-8"))["outcomes"]
    return [
        MissedMutant(outcome["scenario"]["Mutant"]["name"], folder / outcome["diff_path"])
        for outcome in outcomes
        if outcome["summary"] == "MissedMutant"
    ]
