"""Files that are whole or not there: written beside their place, then moved to it in one step."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

UNFINISHED = ".part"


class WriteError(OSError):
    """The file could not be written; says why and what to do."""


@contextmanager
def written(path: Path, *, is_kept: bool = True) -> Iterator[BinaryIO]:
    """A file for `path`, which is there and complete once the block has ended well, and unchanged else.

    is_kept: it is on the disk by then, else only as soon as the system likes: after a power cut it may be torn.

    Raises WriteError. What a killed process leaves ends in `UNFINISHED` and its process id.
    """
    partial = path.with_name(f"{path.name}.{os.getpid()}{UNFINISHED}")
    with explained(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with partial.open("wb") as file:
                yield file
                file.flush()
                if is_kept:
                    os.fsync(file.fileno())
            partial.replace(path)
        finally:
            with suppress(OSError):
                partial.unlink(missing_ok=True)


@contextmanager
def explained(path: Path) -> Iterator[None]:
    """What the system says against writing `path` becomes a WriteError."""
    try:
        yield
    except WriteError:
        raise
    except OSError as error:
        raise WriteError(_reason(error, path)) from error


def check_folder(folder: Path, byte_count: int = 0) -> None:
    """Raises WriteError where nothing can be written, or not so much."""
    with written(folder / f".turgor-{os.getpid()}", is_kept=False) as probe:
        probe.write(b"0")
    (folder / f".turgor-{os.getpid()}").unlink(missing_ok=True)
    free = _free_bytes(folder)
    if free is not None and free < byte_count:
        raise WriteError(
            f"{folder} has {free / 1e6:.0f} MB free, the bake needs {byte_count / 1e6:.0f} MB:"
            " free space or choose another folder"
        )


def _free_bytes(folder: Path) -> int | None:
    import shutil

    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return None


def _reason(error: OSError, path: Path) -> str:
    folder = path.parent
    if error.errno in {errno.ENOSPC, errno.EDQUOT}:
        return f"No space left for {path.name} in {folder}: free space or choose another folder"
    if error.errno in {errno.EACCES, errno.EPERM, errno.EROFS}:
        return f"{folder} cannot be written to: change its permissions or choose another folder"
    if error.errno in {errno.ENOTDIR, errno.EEXIST}:
        return f"{folder} is a file, need a folder: choose another"
    return f"{path.name} could not be written in {folder}: {error.strerror or error}"
