"""Names of files for characters: one name on disk for each character, the same on every machine.

A plain name stays as it is: a capital letter, then small ASCII letters, digits and underscores, perhaps the number that
Blender adds, as in `Tube` or `Tube.001`. Any other is made readable and gets a digest of what it was: disks take some
letters for others (capital and small ones, composed and decomposed ones) and systems refuse some names. Of `Body` and
`body` the second gets one, whatever lies in the folder.
"""

from __future__ import annotations

import re
import unicodedata
from hashlib import blake2b
from pathlib import Path

# Characters of the readable part; suffixes and the digest come on top, systems allow 255.
MOST_CHARACTERS = 48
DIGEST_BYTES = 6
_PLAIN = re.compile(r"[A-Z][a-z0-9_]*(\.\d{3})?")
_UNREADABLE = re.compile(r"[^A-Za-z0-9_]+")
# Devices of Windows, whatever comes after a full stop.
_RESERVED = re.compile(r"(con|prn|aux|nul|conin|conout|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def file_stem(name: str, library: str = "") -> str:
    """The beginning of all names of files of one object.

    What is appended to it begins with `_`, or with `.` and a letter. library: the linked file that the object comes
    from, as Blender stores the path; empty for one of the open file.

    Unequal for unequal arguments, also where case and Unicode composition do not count.
    """
    if not library and len(name) <= MOST_CHARACTERS and _PLAIN.fullmatch(name) and not _RESERVED.fullmatch(name):
        return name
    path = library.replace("\\", "/")
    digest = blake2b(f"{path}\0{name}".encode("utf-8", "surrogatepass"), digest_size=DIGEST_BYTES).hexdigest()
    ascii_only = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    readable = _UNREADABLE.sub("_", ascii_only).strip("_")[:MOST_CHARACTERS]
    return f"{readable or 'Object'}-{digest}"


def with_ending(path: Path, ending: str, known: frozenset[str]) -> Path:
    """`path` with this ending; an ending that is among `known` makes room for it, any other belongs to the name."""
    if path.suffix.lower() in known:
        return path.with_suffix(ending)
    return path.with_name(path.name + ending)
