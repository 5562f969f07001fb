"""python -m demo.fingerprints --extension ZIP FILE ..."""

from __future__ import annotations

from pathlib import Path

from .. import program


def main() -> None:
    """Prints a line for each mesh of each file and each choice of settings; compare two builds by `diff`."""
    parser = program.parser("demo.fingerprints", "Fingerprints of characters over their frames", None)
    parser.add_argument("files", type=Path, nargs="+", help=".blend, .glb, .gltf or .fbx with rigged characters")
    parser.add_argument("--frames", type=int, default=12, help="frames of each, spread over the scene's")
    options = parser.parse_args()
    with program.own_blender(options.extension):
        from . import characters

        for file in options.files:
            characters.print_fingerprints(file, options.frames)


if __name__ == "__main__":
    main()
