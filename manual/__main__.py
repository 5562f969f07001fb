"""`python -m manual --output FOLDER [--pictures FOLDER]` writes the manual as one page.

Pictures that were not taken are left out: they need a Blender with a window (`make pictures`).
"""

from __future__ import annotations

import argparse
import re
import shutil
from pathlib import Path

import markdown

HERE = Path(__file__).resolve().parent
PICTURE = re.compile(r"^!\[.*\]\((.*)\)\n", re.MULTILINE)


def page(text: str, pictures: set[str]) -> str:
    """HTML of the text, with those of its pictures that exist."""
    kept = PICTURE.sub(lambda found: found[0] if found[1] in pictures else "", text)
    body = markdown.markdown(kept, extensions=["tables", "sane_lists"])
    title = text.splitlines()[0].removeprefix("# ")
    return (HERE / "page.html").read_text().replace("TITLE", title).replace("BODY", body)


def main() -> None:
    """Writes the page and copies its pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, required=True, help="folder to write")
    parser.add_argument("--pictures", type=Path, help="folder with the pictures, if there is one")
    options = parser.parse_args()

    options.output.mkdir(parents=True, exist_ok=True)
    taken = [] if options.pictures is None else sorted(options.pictures.glob("*.png"))
    for picture in taken:
        shutil.copy(picture, options.output)
    text = (HERE / "manual.md").read_text(encoding="utf-8")
    (options.output / "index.html").write_text(page(text, {picture.name for picture in taken}), encoding="utf-8")


if __name__ == "__main__":
    main()
