"""python -m demo.speed --extension ZIP."""

from __future__ import annotations

from .. import program

# A bake is hundreds of frames.
BAKES_PART = 4


def main() -> None:
    """Times characters."""
    parser = program.parser("demo.speed", "How long frames take", None)
    parser.add_argument("--turns", type=int, default=16, help="without and with Turgor so many times in turn")
    options = parser.parse_args()
    with program.own_blender(options.extension) as resources:
        from . import bakes, race, stacks

        race.run(options.turns)
        stacks.run(options.turns)
        bakes.run(max(options.turns // BAKES_PART, 1), resources)


if __name__ == "__main__":
    main()
