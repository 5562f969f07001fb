"""A copy of the repository in which lines are broken, with an engine of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
# Ignored by git, as all of `target*`.
FOLDER = REPOSITORY / "target-mutants"
# Quick to build, and fast enough for the laws.
PROFILE = "mutants"


class Scratch:
    """The copy; made anew."""

    def __init__(self) -> None:
        self.root = FOLDER / "tree"
        shutil.rmtree(self.root, ignore_errors=True)
        listed = subprocess.run(
            ["git", "ls-files", "-co", "--exclude-standard"], cwd=REPOSITORY, check=True, capture_output=True, text=True
        )
        for name in listed.stdout.splitlines():
            if (REPOSITORY / name).is_file():
                (self.root / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(REPOSITORY / name, self.root / name)
        for made in (".fixtures", ".venv-3.11", ".venv-3.13"):
            if (REPOSITORY / made).exists() and not (self.root / made).exists():
                (self.root / made).symlink_to(REPOSITORY / made)
        self._packages = FOLDER / "site-packages"

    def build(self) -> bool:
        """Whether the engine of the copy compiles, as it is now; from then on tests use it."""
        command = ["cargo", "build", "--locked", "--quiet", "--package", "turgor-python", "--profile", PROFILE]
        environment = os.environ | {"CARGO_TARGET_DIR": str(FOLDER / "target")}
        if subprocess.run(command, cwd=self.root, env=environment, capture_output=True, check=False).returncode:
            return False
        shutil.rmtree(self._packages, ignore_errors=True)
        shutil.copytree(self.root / "rust/python/turgor", self._packages / "turgor")
        built = FOLDER / "target" / PROFILE / "lib_native.so"
        shutil.copy2(built, self._packages / "turgor/_native.abi3.so")
        return True

    def passes(self, tests: tuple[str, ...], seconds: float = 900.0) -> bool:
        """Whether all of these tests do; one that does not end has failed."""
        command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
        environment = os.environ | {"PYTHONPATH": str(self._packages), "PYTHONDONTWRITEBYTECODE": "1"}
        try:
            done = subprocess.run(
                command, cwd=self.root, env=environment, capture_output=True, timeout=seconds, check=False
            )
        except subprocess.TimeoutExpired:
            return False
        return done.returncode == 0
