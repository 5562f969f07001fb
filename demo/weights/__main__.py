"""python -m demo.weights --extension ZIP --output DIRECTORY."""

from __future__ import annotations

from .. import program


def main() -> None:
    """Weights every case."""
    parser = program.parser("demo.weights", "Automatic weights beside Blender's own", "report.json and pictures")
    options = parser.parse_args()
    with program.own_blender(options.extension):
        from . import show

        show.show(options.output)


if __name__ == "__main__":
    main()
