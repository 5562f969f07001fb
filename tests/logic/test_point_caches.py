"""Point caches go round, whatever the order of their chunks and whatever was killed; what is torn is computed anew."""

from __future__ import annotations

import errno
import os
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from addon.logic import point_cache, point_cache_store
from addon.logic.chunk_store import ChunkStore
from addon.logic.point_cache_store import PointCacheStore
from addon.logic.whole_file import WriteError

SAMPLES = np.random.default_rng(1).normal(size=(7, 5, 3)).astype(np.float32)
HEADER = point_cache.Header(5, 3.5, 0.25, len(SAMPLES))
CHUNK = 3
CHUNKS = [SAMPLES[first : first + CHUNK] for first in range(0, len(SAMPLES), CHUNK)]


def _store(folder: Path, header: point_cache.Header = HEADER, chunk: int = CHUNK) -> PointCacheStore:
    return PointCacheStore(folder / "chunks", header, chunk)


def _found(store: PointCacheStore) -> list[bool]:
    found = [store.find(number, f"f{number}", chunk.shape) for number, chunk in enumerate(CHUNKS)]
    assert all(np.array_equal(each, chunk) for each, chunk in zip(found, CHUNKS, strict=True) if each is not None)
    return [each is not None for each in found]


def _written(folder: Path, numbers: list[int]) -> PointCacheStore:
    store = _store(folder)
    for number in numbers:
        store.put(number, f"f{number}", CHUNKS[number])
    return store


def _whole(folder: Path, numbers: list[int]) -> bytes:
    store = _written(folder, numbers)
    size = store.finish(folder / "one.pc2")
    store.clear()
    assert [path.name for path in folder.iterdir()] == ["one.pc2"]
    assert size == (folder / "one.pc2").stat().st_size
    return (folder / "one.pc2").read_bytes()


def test_caches_go_round_whatever_the_order_of_their_chunks(tmp_path: Path):
    one, other = _whole(tmp_path / "a", [0, 1, 2]), _whole(tmp_path / "b", [2, 0, 1])
    assert one == other
    header, samples = point_cache.read(tmp_path / "a" / "one.pc2")
    assert header == HEADER
    assert np.array_equal(samples, SAMPLES)
    assert struct.unpack_from("<12sii", one) == (b"POINTCACHE2\0", 1, 5)


def test_chunks_are_read_before_and_after_the_file_is_finished(tmp_path: Path):
    store = _written(tmp_path, [0, 1, 2])
    for _ in range(2):
        assert np.array_equal(store.read(1, CHUNKS[1].shape), CHUNKS[1])
        if not (tmp_path / "one.pc2").exists():
            store.finish(tmp_path / "one.pc2")


def test_a_missing_or_narrow_chunk_is_told_and_nothing_is_left_at_the_place(tmp_path: Path):
    store = _written(tmp_path, [0, 2])
    with pytest.raises(point_cache.PointCacheError, match=r"\[1\]"):
        store.finish(tmp_path / "one.pc2")
    with pytest.raises(point_cache.PointCacheError, match="need"):
        store.put(1, "f1", CHUNKS[1][:, :4])
    assert not (tmp_path / "one.pc2").exists()
    for header in (HEADER._replace(point_count=0), HEADER._replace(sample_count=0)):
        with pytest.raises(point_cache.PointCacheError, match="holds nothing"):
            _store(tmp_path / "other", header)


def test_what_was_written_is_found_again_by_what_it_was_made_from(tmp_path: Path):
    _written(tmp_path, [0, 2]).close()
    store = _store(tmp_path)
    assert [store.may_have(number) for number in range(3)] == [True, False, True]
    assert store.find(0, "other", CHUNKS[0].shape) is None
    assert _found(store) == [True, False, True]
    assert store.found_count == 2
    store.put(1, "f1", CHUNKS[1])
    store.finish(tmp_path / "one.pc2")
    assert (tmp_path / "one.pc2").read_bytes() == _whole(tmp_path / "fresh", [0, 1, 2])


def test_what_was_moved_to_its_place_before_a_kill_is_found_there(tmp_path: Path):
    place = tmp_path / "one.pc2"
    _written(tmp_path, [0, 1, 2]).finish(place)
    whole = place.read_bytes()
    again = PointCacheStore(tmp_path / "chunks", HEADER, CHUNK, place)
    assert _found(again) == [True] * 3
    assert place.read_bytes() == whole
    again.put(1, "other", CHUNKS[1] + 1)
    again.close()
    assert place.read_bytes() == whole
    third = PointCacheStore(tmp_path / "chunks", HEADER, CHUNK, place)
    assert third.find(1, "f1", CHUNKS[1].shape) is None
    assert _found(third) == [True, False, True]
    third.put(1, "f1", CHUNKS[1])
    third.finish(place)
    assert place.read_bytes() == whole


def test_another_range_or_chunk_size_begins_anew(tmp_path: Path):
    for header, chunk in ((HEADER._replace(step=0.5), CHUNK), (HEADER, CHUNK + 1)):
        _written(tmp_path, [0, 1, 2]).close()
        store = _store(tmp_path, header, chunk)
        assert not any(store.may_have(number) for number in range(3))
        store.close()


def test_chunks_of_another_machine_are_taken_over(tmp_path: Path):
    for number in (0, 2):
        ChunkStore(tmp_path / "chunks").put(number, f"f{number}", CHUNKS[number])
    store = _store(tmp_path)
    assert _found(store) == [True, False, True]
    store.put(1, "f1", CHUNKS[1])
    store.finish(tmp_path / "one.pc2")
    assert np.array_equal(point_cache.read(tmp_path / "one.pc2")[1], SAMPLES)


def test_torn_chunks_and_lines_are_computed_anew(tmp_path: Path):
    _written(tmp_path, [0, 1, 2]).close()
    path, journal = tmp_path / "chunks" / "cache.pc2", tmp_path / "chunks" / "cache.journal"
    whole, lines = path.read_bytes(), journal.read_bytes()
    at = HEADER.place(CHUNK)
    for content, expected in (
        (whole, [True, True, True]),
        (whole[: at + 5], [True, False, False]),
        (whole[: at + 8] + bytes(8) + whole[at + 16 :], [True, False, True]),
        (b"", [False, False, False]),
    ):
        path.write_bytes(content)
        journal.write_bytes(lines)
        store = _store(tmp_path)
        assert _found(store) == expected
        store.close()
    for size in range(0, len(lines), 7):
        path.write_bytes(whole)
        journal.write_bytes(lines[:size])
        store = _store(tmp_path)
        for number, is_there in enumerate(_found(store)):
            if not is_there:
                store.put(number, f"f{number}", CHUNKS[number])
        store.close()
        again = _store(tmp_path)
        assert _found(again) == [True] * 3
        again.close()
    assert path.read_bytes() == whole


OTHER = """
import sys
sys.path.insert(0, {repository!r})
from pathlib import Path
from addon.logic import point_cache
from addon.logic.point_cache_store import PointCacheStore
store = PointCacheStore(Path({folder!r}), point_cache.Header(*{header!r}), {chunk})
print(store.path.name, [store.may_have(number) for number in range(3)], flush=True)
sys.stdin.read()
"""


def test_two_bakes_at_one_time_have_files_of_their_own_and_a_killed_one_leaves_its_own(tmp_path: Path):
    places = {"repository": str(Path(__file__).resolve().parents[2]), "folder": str(tmp_path / "chunks")}
    script = OTHER.format(**places, header=tuple(HEADER), chunk=CHUNK)
    with subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        assert other.stdout.readline().decode().strip() == "cache.pc2 [False, False, False]"
        store = _written(tmp_path, [1])
        assert store.path.name == "cache1.pc2"
        other.kill()
        other.wait()
    assert _store(tmp_path).path.name == "cache.pc2"
    store.close()


def test_what_another_bake_uses_stays_until_it_ends(tmp_path: Path):
    folder = tmp_path / "chunks"
    stores = [_written(tmp_path, [0, 1, 2]), _written(tmp_path, [0, 1])]
    stores[0].finish(tmp_path / "one.pc2")
    stores[0].clear()
    assert sorted(path.name for path in folder.iterdir()) == [
        "cache1.journal",
        "cache1.pc2",
        "user0.lock",
        "user1.lock",
    ]
    stores[1].put(2, "f2", CHUNKS[2])
    stores[1].finish(tmp_path / "two.pc2")
    stores[1].clear()
    assert not folder.exists()
    assert (tmp_path / "one.pc2").read_bytes() == (tmp_path / "two.pc2").read_bytes()
    chunks = [ChunkStore(folder).hold() for _ in range(2)]
    for store in chunks:
        store.put(0, "f0", CHUNKS[0])
    chunks[0].clear()
    assert np.array_equal(chunks[1].read(0, CHUNKS[0].shape), CHUNKS[0])
    chunks[1].close()
    another = ChunkStore(folder).hold()
    chunks[1].clear()
    assert np.array_equal(chunks[1].read(0, CHUNKS[0].shape), CHUNKS[0])
    another.clear()
    assert not folder.exists()


def test_a_full_disk_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    store = _written(tmp_path, [0, 1, 2])

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(point_cache_store.os, "fsync", full)
    with pytest.raises(WriteError, match=r"No space left for cache\.pc2"):
        store.finish(tmp_path / "one.pc2")
    assert not (tmp_path / "one.pc2").exists()
    if Path("/dev/full").exists():
        (tmp_path / "other" / "chunks").mkdir(parents=True)
        (tmp_path / "other" / "chunks" / "cache.pc2").symlink_to("/dev/full")
        with pytest.raises(WriteError, match="No space left"):
            _store(tmp_path / "other")


def test_a_cut_cache_is_refused(tmp_path: Path):
    whole = _whole(tmp_path / "cache", [0, 1, 2])
    for size in (0, 20, 32, len(whole) - 1):
        (tmp_path / "cut.pc2").write_bytes(whole[:size])
        with pytest.raises(point_cache.PointCacheError):
            point_cache.read(tmp_path / "cut.pc2")
