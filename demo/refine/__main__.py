"""python -m demo.refine --extension ZIP --output DIRECTORY."""

from __future__ import annotations

from .. import program


def main() -> None:
    """Refines every character with the extension's operators."""
    parser = program.parser("demo.refine", "Characters before and after Refine", "report.json and pictures")
    parser.add_argument("--only", action="append", metavar="NAME", help="of these characters")
    options = parser.parse_args()
    with program.own_blender(options.extension):
        from . import show

        show.show(options.output, options.only)


if __name__ == "__main__":
    main()
