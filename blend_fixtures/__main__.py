"""Write the scene fixtures as .blend files."""

from __future__ import annotations

import argparse
from pathlib import Path

from . import NAMES, write


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python -m blend_fixtures", description=__doc__)
    parser.add_argument("directory", nargs="?", type=Path, metavar="OUT_DIR", help="where the .blend files go")
    parser.add_argument("names", nargs="*", metavar="name", help="fixtures to write; all if none is named")
    parser.add_argument("--list", action="store_true", help="print the names and stop")
    arguments = parser.parse_args()
    if arguments.list:
        print("\n".join(NAMES))
        return
    if arguments.directory is None:
        parser.error("OUT_DIR is missing")
    unknown = sorted(set(arguments.names) - set(NAMES))
    if unknown:
        parser.error(f"no such fixture: {', '.join(unknown)}; there are {', '.join(NAMES)}")
    for name in arguments.names or NAMES:
        print(write(name, arguments.directory), flush=True)


if __name__ == "__main__":
    main()
