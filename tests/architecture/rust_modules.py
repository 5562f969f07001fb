"""Which module of a Rust crate uses which, read from its `use` lines and paths."""

from __future__ import annotations

import re
from pathlib import Path

# A path that begins at the crate, this module or its parent, with a tree of names in braces or without.
PATH = re.compile(r"\b(crate|self|super(?:::super)*)((?:::\w+)*)(::\{)?")
COMMENT = re.compile(r"//[^\n]*")
TESTS = re.compile(r"#\[cfg\(test\)\]\s*mod tests \{.*", re.DOTALL)

Module = tuple[str, ...]


def modules(source: Path) -> dict[Module, Path]:
    """Path of each module's file, by its names from the crate on; the crate itself is ()."""
    found = {}
    for path in sorted(source.rglob("*.rs")):
        names = path.relative_to(source).with_suffix("").parts
        found[() if names == ("lib",) else names[:-1] if names[-1] == "mod" else names] = path
    return found


def uses(source: Path) -> dict[Module, set[Module]]:
    """The modules that each one names, but for its own children and ancestors, without its tests."""
    files = modules(source)
    found = {}
    for module, path in files.items():
        text = TESTS.sub("", COMMENT.sub("", path.read_text(encoding="utf-8")))
        named = {_module_of(target, files) for target in _paths(text, module)}
        found[module] = {other for other in named if not _is_family(other, module)}
    return found


def circles(used: dict[Module, set[Module]]) -> list[list[Module]]:
    """Sets of modules that use each other in a circle, each sorted."""
    reached = {module: _reached(module, used) for module in used}
    seen: set[Module] = set()
    result = []
    for module in sorted(used):
        circle = sorted(other for other in reached[module] if module in reached.get(other, set()))
        if circle and module not in seen:
            seen.update(circle)
            result.append(circle)
    return result


def _reached(module: Module, used: dict[Module, set[Module]]) -> set[Module]:
    found: set[Module] = set()
    ahead = [module]
    while ahead:
        new = used.get(ahead.pop(), set()) - found
        found |= new
        ahead += new
    return found


def _is_family(one: Module, other: Module) -> bool:
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]


def _module_of(names: Module, files: dict[Module, Path]) -> Module:
    while names not in files:
        names = names[:-1]
    return names


def _paths(text: str, module: Module) -> set[Module]:
    found = set()
    for match in PATH.finditer(text):
        root, names, has_tree = match.groups()
        start = () if root == "crate" else module if root == "self" else module[: -len(root.split("::"))]
        start = (*start, *[name for name in names.split("::") if name])
        if has_tree is None:
            found.add(start)
        else:
            found |= {(*start, *branch) for branch in _tree(text, match.end())}
    return found


def _tree(text: str, start: int) -> list[Module]:
    """The paths within braces that open before `start`."""
    found: list[Module] = []
    before: list[Module] = [()]
    names: list[str] = []
    for token in re.finditer(r"\w+|::|[{},]", text[start:]):
        sign = token.group()
        if sign == "{":
            before.append((*before[-1], *names))
            names = []
        elif sign in {",", "}"}:
            if names:
                found.append((*before[-1], *names))
            names = []
            if sign == "}":
                before.pop()
                if not before:
                    break
        elif sign not in {"::", "as"}:
            names.append(sign)
    return found
