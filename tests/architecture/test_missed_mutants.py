"""What `cargo mutants` could break unnoticed is found in its output, each with its own diff."""

from __future__ import annotations

import json
from pathlib import Path

from tests.mutation.missed import MissedMutant, read_missed


def _outcome(name: str, summary: str, diff: str) -> dict[str, object]:
    return {"scenario": {"Mutant": {"name": name}}, "summary": summary, "diff_path": diff}


def test_only_missed_mutants_are_read_each_with_its_diff(tmp_path: Path) -> None:
    sum_at_3, sum_at_9 = "volume.rs:3:9: replace + with *", "volume.rs:3:21: replace + with *"
    outcomes = [
        {"scenario": "Baseline", "summary": "Success", "diff_path": None},
        _outcome("volume.rs:2:1: replace volume with 0", "CaughtMutant", "diff/a.diff"),
        _outcome(sum_at_3, "MissedMutant", "diff/b.diff"),
        _outcome("volume.rs:4:1: replace < with ==", "Timeout", "diff/c.diff"),
        _outcome("volume.rs:5:1: delete -", "Unviable", "diff/d.diff"),
        _outcome(sum_at_9, "MissedMutant", "diff/b_001.diff"),
    ]
    (tmp_path / "outcomes.json").write_text(json.dumps({"outcomes": outcomes}), encoding="utf-8")
    assert read_missed(tmp_path) == [
        MissedMutant(sum_at_3, tmp_path / "diff/b.diff"),
        MissedMutant(sum_at_9, tmp_path / "diff/b_001.diff"),
    ]
