"""A wheel is named after its content, and stays a wheel that pip would accept."""

from __future__ import annotations

import base64
import csv
import hashlib
import io
import zipfile
from pathlib import Path

from stamp_wheel import stamp

NAME = "turgor-0.1.0-cp311-abi3-manylinux_2_34_x86_64.whl"
METADATA = "Metadata-Version: 2.4\nName: turgor\nVersion: 0.1.0\n\nKeep Version: 0.1.0 in this text.\n"


def made(directory: Path, engine: str) -> Path:
    """A small wheel whose engine is a line of text."""
    directory.mkdir(exist_ok=True)
    wheel = directory / NAME
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("turgor/_native.abi3.so", engine)
        archive.writestr("turgor-0.1.0.dist-info/METADATA", METADATA)
        archive.writestr("turgor-0.1.0.dist-info/RECORD", "")
    return wheel


def test_name_follows_the_content(tmp_path: Path):
    one, same, other = (
        stamp(made(tmp_path / folder, text)).name for folder, text in (("a", "x"), ("b", "x"), ("c", "y"))
    )
    assert one == same
    assert one != other
    assert one.startswith("turgor-0.1.0+b")
    assert one.endswith("-cp311-abi3-manylinux_2_34_x86_64.whl")


def test_stamped_wheel_replaces_the_other(tmp_path: Path):
    stamped = stamp(made(tmp_path, "x"))
    assert list(tmp_path.iterdir()) == [stamped]


def test_metadata_and_record_agree_with_the_name(tmp_path: Path):
    stamped = stamp(made(tmp_path, "x"))
    version = stamped.name.split("-")[1]
    with zipfile.ZipFile(stamped) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    information = f"turgor-{version}.dist-info"
    assert files[f"{information}/METADATA"].decode() == METADATA.replace("\nVersion: 0.1.0", f"\nVersion: {version}")
    recorded = {row[0]: row[1:] for row in csv.reader(io.StringIO(files.pop(f"{information}/RECORD").decode()))}
    assert recorded.pop(f"{information}/RECORD") == ["", ""]
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        assert recorded[name] == [f"sha256={digest}", str(len(content))]
    assert recorded.keys() == files.keys()
