"""What the architecture tests read: the repository's files, and what each Python file imports."""

from __future__ import annotations

import ast
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]


def tracked_files() -> list[Path]:
    """Every file of the repository: known to git, or new and not ignored."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True, text=True).stdout
    return [path for path in (REPOSITORY / line for line in listing.splitlines()) if path.is_file()]


def python_files(folder: str) -> list[Path]:
    """The tracked Python files under a folder of the repository."""
    return [path for path in tracked_files() if path.suffix == ".py" and path.is_relative_to(REPOSITORY / folder)]


def imported_modules(path: Path) -> set[str]:
    """Dotted names a file imports; `from a import b` gives both a and a.b; relative ones are made absolute."""
    package = list(path.relative_to(REPOSITORY).parent.parts)
    modules: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            anchor = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*anchor, *([node.module] if node.module else [])])
            modules.add(module)
            modules.update(f"{module}.{alias.name}" for alias in node.names)
    return modules
