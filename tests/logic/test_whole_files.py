"""Files are whole or not there; chunks go round and notice what is wrong."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import numpy as np
import pytest

from addon.logic.chunk_store import ChunkStore
from addon.logic.whole_file import WriteError, check_folder, written

SAMPLES = np.random.default_rng(1).normal(size=(7, 5, 3)).astype(np.float32)


def _names(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


def test_a_failed_write_leaves_what_was_there_and_nothing_else(tmp_path: Path):
    path = tmp_path / "kept"
    with written(path) as file:
        file.write(b"old")

    def fail():
        with written(path) as file:
            file.write(b"new")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert path.read_bytes() == b"old"
    assert _names(tmp_path) == ["kept"]


@pytest.mark.parametrize(
    ("number", "words"), [(errno.ENOSPC, "No space left"), (errno.EROFS, "cannot be written"), (errno.EIO, "could not")]
)
def test_errors_of_the_system_say_what_to_do(tmp_path: Path, number: int, words: str):
    def fail():
        with written(tmp_path / "file"):
            raise OSError(number, os.strerror(number))

    with pytest.raises(WriteError, match=words):
        fail()
    assert not _names(tmp_path)


def test_a_full_disk_is_told(tmp_path: Path):
    """/dev/full takes nothing: the file that is written beside its place is there."""
    if not Path("/dev/full").exists():
        pytest.skip("no device that is always full")
    (tmp_path / f"cache.{os.getpid()}.part").symlink_to("/dev/full")

    def fill():
        with written(tmp_path / "cache") as file:
            file.write(bytes(1 << 20))

    with pytest.raises(WriteError, match="No space left for cache"):
        fill()
    assert not (tmp_path / "cache").exists()


def test_a_folder_that_cannot_be_written_is_refused_before_any_work(tmp_path: Path):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(WriteError, match="is a file, need a folder"):
        check_folder(tmp_path / "file")
    with pytest.raises(WriteError, match="free space"):
        check_folder(tmp_path, 1 << 60)
    check_folder(tmp_path / "new", 10)
    assert not _names(tmp_path / "new")


def test_chunks_are_found_by_what_they_were_made_from(tmp_path: Path):
    store = ChunkStore(tmp_path / "chunks")
    assert store.find(0, "aa", SAMPLES.shape) is None
    assert not store.may_have(0)
    store.put(0, "aa", SAMPLES)
    assert np.array_equal(store.read(0, SAMPLES.shape), SAMPLES)
    again = ChunkStore(tmp_path / "chunks")
    assert again.may_have(0)
    assert not again.may_have(1)
    found = again.find(0, "aa", SAMPLES.shape)
    assert found is not None
    assert np.array_equal(found, SAMPLES)
    assert again.find(0, "bb", SAMPLES.shape) is None
    assert again.find(1, "aa", SAMPLES.shape) is None
    assert again.find(0, "aa", (1, 5, 3)) is None
    assert again.found_count == 1
    again.put(0, "bb", SAMPLES + 1)
    assert again.find(0, "aa", SAMPLES.shape) is None
    again.clear()
    assert not (tmp_path / "chunks").exists()


def test_a_torn_chunk_is_computed_anew(tmp_path: Path):
    """A power cut may leave a file of the right name and length with pages that were never written."""
    store = ChunkStore(tmp_path)
    store.put(3, "aa", SAMPLES)
    path = next(tmp_path.iterdir())
    whole = path.read_bytes()
    torn = [whole[:size] for size in (0, 3, 100, 200, len(whole) - 1)]
    torn += [whole[:at] + bytes(8) + whole[at + 8 :] for at in (0, 128, 300, len(whole) - 8)]
    for content in torn:
        path.write_bytes(content)
        assert store.find(3, "aa", SAMPLES.shape) is None
    path.write_bytes(whole)
    found = store.find(3, "aa", SAMPLES.shape)
    assert found is not None
    assert np.array_equal(found, SAMPLES)
