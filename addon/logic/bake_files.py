"""Files of one bake in a folder, and whose those are that are there already: no other character's is overwritten."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any, NamedTuple

from .file_names import file_stem


class OccupiedError(ValueError):
    """A file of something else is in the way; says whose it is, and what to do."""


class Source(NamedTuple):
    """What was baked. Reports keep it."""

    file: str  # the .blend as seen from the folder of the bake, so that both may be moved together
    digest: str  # of its bytes: a worker of a farm may have a copy somewhere else
    scene: str
    object: str
    library: str  # path of the linked file that the object comes from, as the .blend stores it

    def is_same(self, other: Source) -> bool:
        """Whether a bake of the other may take the place of one of this."""
        is_file = self.file == other.file or (bool(self.digest) and self.digest == other.digest)
        return is_file and self[2:] == other[2:]

    def __str__(self) -> str:
        linked = f" linked from {self.library}" if self.library else ""
        return f"{self.object}{linked}, scene {self.scene} of {self.file}"


class BakeFiles(NamedTuple):
    """Places of what one bake writes."""

    folder: Path
    source: Source
    method: str

    @property
    def stem(self) -> str:
        """What all names begin with."""
        return file_stem(self.source.object, self.source.library)

    @property
    def chunks(self) -> Path:
        """Where finished chunks wait for another try."""
        return self.folder / f".{self.stem}.chunks"

    @property
    def cache(self) -> Path:
        """The point cache."""
        return self.folder / f"{self.stem}.pc2"

    @property
    def report(self) -> Path:
        """Path of the report for programs, one per method; it says whose bake this is."""
        return self.folder / f"{self.stem}_{self.method.lower()}.json"

    @property
    def text(self) -> Path:
        """Path of the report for people, one per method."""
        return self.folder / f"{self.stem}_{self.method.lower()}.txt"

    def earlier(self, *, may_overwrite: bool = False) -> dict[str, Any] | None:
        """Report of the same character's earlier bake, which this one replaces; None without one.

        Raises OccupiedError where what is there is of something else, unless it may be overwritten.
        """
        written = [self.report, self.text, *([self.cache] if self.method == "POINT_CACHE" else [])]
        there = [path for path in written if path.exists()]
        if not there or may_overwrite:
            return None
        found, owner = _read(self.report)
        if owner is not None and owner.is_same(self.source):
            return found
        whose = f"a bake of {owner}" if owner is not None else "of unknown origin"
        raise OccupiedError(
            f"{there[-1].name} in {self.folder} is {whose}, and would be overwritten by {self.source}:"
            " move or delete it, or choose another folder"
        )


def seen_from(path: str, folder: Path) -> str:
    """`path` from the folder on, with /; the whole path where there is no way."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:
        return Path(path).as_posix()


def digest_of(path: str) -> str:
    """SHA-256 of the bytes of a file, in hexadecimal; empty where it cannot be read."""
    try:
        with Path(path).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def _read(path: Path) -> tuple[dict[str, Any] | None, Source | None]:
    """A report and whose it is, as far as it says so."""
    try:
        found = json.loads(path.read_bytes())
        owner = Source(**{name: str(value) for name, value in found["source"].items()})
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None, None
    return found, owner
