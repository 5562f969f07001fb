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


def imported_modules(path: Path, *, with_types: bool = True) -> set[str]:
    """Dotted names a file imports; `from a import b` gives both a and a.b; relative ones are made absolute.

    with_types: also what is imported under `if TYPE_CHECKING`, where nothing is run.
    """
    package = list(path.relative_to(REPOSITORY).parent.parts)
    modules: set[str] = set()
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for_types = {child for node in ast.walk(tree) if _is_type_checking(node) for child in ast.walk(node)}
    for node in ast.walk(tree):
        if node in for_types and not with_types:
            continue
        if isinstance(node, ast.Import):
            modules.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            anchor = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*anchor, *([node.module] if node.module else [])])
            modules.add(module)
            modules.update(f"{module}.{alias.name}" for alias in node.names)
    return modules


def _is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
