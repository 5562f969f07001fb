"""python -m demo.elastic FOLDER: how near skins come to elastic flesh, and what the law costs.

FOLDER holds the cases, one .npz each, and the `compare.py` that scores them. The engine is the `turgor` on the path.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
from pathlib import Path

# Before the engine starts its threads: costs are those of one.
os.environ.setdefault("RAYON_NUM_THREADS", "1")

from . import cost, skins

# Columns: the score, and how many digits of it.
FIGURES = {
    "surface": ("surface", 3),
    "normal": ("normal", 1),
    "outline": ("silhouette", 3),
    "stretch": ("stretch", 2),
    "slabs %": ("slab_rms", 1),
    "crossings": ("crossings", 0),
}


def _comparison(folder: Path):
    spec = importlib.util.spec_from_file_location("compare", folder / "compare.py")
    if spec is None or spec.loader is None:
        raise SystemExit(f"{folder}: found no compare.py, need the folder of the elastic cases")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main() -> None:
    """Prints a row for each case, weights and skin, then costs."""
    options = argparse.ArgumentParser(prog="python -m demo.elastic", description="How near skins come to elastic flesh")
    options.add_argument("folder", type=Path, help="folder of the cases and compare.py")
    options.add_argument("cases", nargs="*", help="names of cases; all")
    options.add_argument("--weights", nargs="*", default=["auto"], help="auto, simple")
    options.add_argument("--skins", nargs="*", default=list(skins.SKINS), help="of " + ", ".join(skins.SKINS))
    options.add_argument("--turns", type=int, default=60, help="frames without and with the law in turn; 0: no costs")
    given = options.parse_args()
    compare = _comparison(given.folder)
    print(f"{'':40}" + "".join(f"{name:>10}" for name in FIGURES), flush=True)
    for case in given.cases or sorted(path.stem for path in given.folder.glob("*.npz")):
        data = compare.load(case, str(given.folder))
        for weights in given.weights:
            for name in given.skins:
                found = compare.score(data, skins.skinned(data, weights, name))
                figures = "".join(f"{found[key]:10.{digits}f}" for key, digits in FIGURES.values())
                print(f"{f'{case}, {weights}: {name}':40}{figures}", flush=True)
    if given.turns:
        cost.run(given.turns)


if __name__ == "__main__":
    main()
