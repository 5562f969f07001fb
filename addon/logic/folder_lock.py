"""Who uses a folder of chunks: each process holds a numbered lock in it, let go when closed or when it ends."""

from __future__ import annotations

import errno
import os
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

ENDING = ".lock"
_HELD = {errno.EACCES, errno.EAGAIN, errno.EDEADLK}


class FolderLock:
    """One process's share of a folder."""

    def __init__(self, folder: Path) -> None:
        """Takes the first number that no other process holds. Raises OSError where no file can be made."""
        number = 0
        while True:
            folder.mkdir(parents=True, exist_ok=True)
            path = folder / f"user{number}{ENDING}"
            file = path.open("ab")
            # Whoever cleared the folder may have taken the file away between the two.
            if _is_taken(file) and path.exists():
                self.number, self._path, self._file = number, path, file
                return
            number += path.exists()
            file.close()

    @property
    def is_shared(self) -> bool:
        """Whether another process uses the folder too."""
        mine = None if self._file.closed else self._path
        return any(_is_held(path) for path in self._path.parent.glob(f"*{ENDING}") if path != mine)

    def close(self) -> None:
        """Let go; may be called again."""
        with suppress(OSError):
            self._file.close()


def _is_held(path: Path) -> bool:
    try:
        with path.open("ab") as file:
            return not _is_taken(file)
    except OSError:
        return False


def _is_taken(file: BinaryIO) -> bool:
    """Whether the lock is ours now; also on a file system without locks: two bakes of one object are odd."""
    try:
        if os.name == "nt":
            import msvcrt

            file.seek(0)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in _HELD
    return True
