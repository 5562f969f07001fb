"""python -m demo FILE --extension ZIP --output DIRECTORY."""

from __future__ import annotations

from pathlib import Path

from . import program


def main() -> None:
    """Shows one file."""
    parser = program.parser("demo", "A character with and without Turgor", "report.json, index.html and pictures")
    parser.add_argument("file", type=Path, help=".blend, .glb, .gltf or .fbx with a rigged character")
    options = parser.parse_args()
    with program.own_blender(options.extension):
        from . import show

        show.show(options.file, options.output)


if __name__ == "__main__":
    main()
