"""python -m demo.folds --extension ZIP --output DIRECTORY."""

from __future__ import annotations

from .. import program


def main() -> None:
    """Bends every body."""
    parser = program.parser("demo.folds", "Folds with and without repair", "report.json and pictures")
    options = parser.parse_args()
    with program.own_blender(options.extension):
        from . import show

        show.show(options.output)


if __name__ == "__main__":
    main()
