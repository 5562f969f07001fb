"""Gives a wheel a local version made from its content: 0.1.0 becomes 0.1.0+b3f2a9c1.

Blender installs a wheel only when its version is new, so two builds of one version must differ in name. Releases are
not stamped.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import zipfile
from pathlib import Path


def content_version(files: dict[str, bytes], version: str) -> str:
    """`version` with the first eight digits of the digest of everything in the wheel."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(name.encode() + b"\0" + files[name])
    return f"{version}+b{digest.hexdigest()[:8]}"


def record(files: dict[str, bytes], record_name: str) -> bytes:
    """The RECORD of a wheel: path, digest and size of every file; its own line has neither."""
    lines = []
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        lines.append(f"{name},sha256={digest},{len(content)}\n")
    return "".join([*lines, f"{record_name},,\n"]).encode()


def stamp(wheel: Path) -> Path:
    """Replaces the wheel by its stamped copy; returns the new path."""
    distribution, version, *tags = wheel.name.split("-")
    plain_prefix = f"{distribution}-{version}."
    with zipfile.ZipFile(wheel) as archive:
        files = {name: archive.read(name) for name in archive.namelist() if not name.endswith("/RECORD")}

    stamped_version = content_version(files, version)
    stamped_prefix = f"{distribution}-{stamped_version}."
    files = {name.replace(plain_prefix, stamped_prefix, 1): content for name, content in files.items()}
    information = f"{stamped_prefix}dist-info"
    metadata = files[f"{information}/METADATA"]
    files[f"{information}/METADATA"] = metadata.replace(
        f"\nVersion: {version}\n".encode(), f"\nVersion: {stamped_version}\n".encode(), 1
    )

    stamped = wheel.with_name("-".join([distribution, stamped_version, *tags]))
    record_name = f"{information}/RECORD"
    with zipfile.ZipFile(stamped, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in [*files.items(), (record_name, record(files, record_name))]:
            archive.writestr(name, content)
    wheel.unlink()
    return stamped


def main() -> None:
    """Stamps the wheel named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    print(stamp(parser.parse_args().wheel))


if __name__ == "__main__":
    main()
