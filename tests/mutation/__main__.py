"""Breaks each line of `broken_lines`, and each that `cargo mutants` could break unnoticed by Rust's tests alone.

python -m tests.mutation [part of a path ...]         the list
python -m tests.mutation --missed FOLDER [--tests ...] mutants.out of `cargo mutants`, judged by the laws in Python
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from tests.mutation.broken_lines import BROKEN_LINES, BrokenLine
from tests.mutation.missed import read_missed
from tests.mutation.scratch import Scratch


def _listed(parts: list[str]) -> int:
    chosen = [line for line in BROKEN_LINES if not parts or any(part in line.path for part in parts)]
    scratch = Scratch()
    if not scratch.build():
        print("the engine does not compile as it is")
        return 2
    # Tests that fail over sound lines notice nothing.
    failing = {tests for tests in dict.fromkeys(line.tests for line in chosen) if not scratch.passes(tests)}
    survivors = sum(line.tests in failing or not _is_killed(scratch, line) for line in chosen)
    for tests in failing:
        print(f"{'FAIL UNBROKEN':16}  {' '.join(tests)}")
    print(f"{len(chosen)} broken, {survivors} unnoticed")
    return int(survivors > 0)


def _is_killed(scratch: Scratch, line: BrokenLine) -> bool:
    path = scratch.root / line.path
    whole = path.read_text(encoding="utf-8")
    verdict = "not there"
    if whole.count(line.before) == 1:
        path.write_text(whole.replace(line.before, line.after), encoding="utf-8")
        verdict = _judged(scratch, line.tests)
        path.write_text(whole, encoding="utf-8")
    print(f"{verdict:16}  {line.path}: {line.before.strip()}  ->  {line.after.strip()}", flush=True)
    return verdict == "noticed"


def _judged(scratch: Scratch, tests: tuple[str, ...]) -> str:
    if not scratch.build():
        return "does not compile"
    return "UNNOTICED" if scratch.passes(tests) else "noticed"


def _missed(folder: Path, tests: list[str]) -> int:
    """Mutants that Rust's tests missed, one after the other, judged by the laws in Python."""
    scratch = Scratch()
    if not scratch.build():
        print("the engine does not compile as it is")
        return 2
    if not scratch.passes(tuple(tests)):
        print("the tests fail over sound lines")
        return 2
    mutants = read_missed(folder)
    survivors = 0
    for mutant in mutants:
        verdict = "no diff"
        if _patch(scratch, mutant.diff):
            verdict = _judged(scratch, tuple(tests))
            if not _patch(scratch, mutant.diff, "--reverse"):
                raise SystemExit(f"the copy cannot be mended after {mutant.name}")
        survivors += verdict != "noticed"
        print(f"{verdict:16}  {mutant.name}", flush=True)
    print(f"{len(mutants)} missed by Rust's tests, {survivors} unnoticed by all or not judged")
    return int(survivors > 0)


def _patch(scratch: Scratch, diff: Path, *options: str) -> bool:
    command = ["patch", "--strip=0", "--quiet", "--forward", *options, "--input", str(diff.resolve())]
    # A patch names the mutant where the new file's name would stand: the file is that of the old one.
    return subprocess.run(command, cwd=scratch.root, capture_output=True, check=False).returncode == 0


def main() -> int:
    """The number of the process's end: 1 where a broken line went unnoticed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*")
    parser.add_argument("--missed", type=Path)
    parser.add_argument("--tests", nargs="*", default=["tests/engine"])
    chosen = parser.parse_args()
    return _listed(chosen.parts) if chosen.missed is None else _missed(chosen.missed, chosen.tests)


if __name__ == "__main__":
    sys.exit(main())
