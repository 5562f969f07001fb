"""python -m demo.fleshing --extension ZIP --output DIRECTORY."""

from __future__ import annotations

from .. import program


def main() -> None:
    """Runs every experiment."""
    parser = program.parser("demo.fleshing", "Bodies bent along a spine", "report.json, index.html and pictures")
    options = parser.parse_args()
    with program.own_blender(options.extension):
        from . import show

        show.show(options.output)


if __name__ == "__main__":
    main()
