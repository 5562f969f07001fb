"""Whatever happens to the files of a killed bake: what is resumed has the bytes of a bake that nothing disturbed."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.logic import point_cache
from addon.logic.chunk_store import ChunkStore
from addon.logic.point_cache_store import PointCacheStore

POINTS, SAMPLES, CHUNK = 6, 13, 3
# Few values, so that parts may be equal and sums too.
POSITIONS = np.random.default_rng(4).integers(0, 4, (SAMPLES, POINTS, 3)).astype(np.float32)
CHUNKS = [POSITIONS[first : first + CHUNK] for first in range(0, SAMPLES, CHUNK)]
HEADER = point_cache.Header(POINTS, 1.0, 1.0, SAMPLES)
SAMPLE_BYTES = 12 * POINTS
Damage = Callable[[bytearray], bytes]


@st.composite
def exchanges(draw, size: int) -> Damage:
    """Two parts of this many bytes change places, aligned to the words of the file's end."""
    one, other = draw(st.integers(0, 200)), draw(st.integers(0, 200))

    def damage(content: bytearray) -> bytes:
        count = len(content) // size
        if count < 2:
            return bytes(content)
        # Positions end where the file ends, or 4 bytes before.
        for end in (len(content), len(content) - 4):
            a, b = (end - size * (1 + each % (count - 1)) for each in (one, other))
            if min(a, b) >= 0:
                content[a : a + size], content[b : b + size] = content[b : b + size], content[a : a + size]
        return bytes(content)

    return damage


@st.composite
def flips(draw) -> Damage:
    """Some bits are turned."""
    places = draw(st.lists(st.integers(0, 1 << 20), min_size=1, max_size=60))

    def damage(content: bytearray) -> bytes:
        for place in places:
            if content:
                content[place // 8 % len(content)] ^= 1 << place % 8
        return bytes(content)

    return damage


@st.composite
def blanks(draw) -> Damage:
    """A part was never written."""
    start, length = draw(st.integers(0, 900)), draw(st.integers(1, 400))

    def damage(content: bytearray) -> bytes:
        part = slice(min(start, len(content)), min(start + length, len(content)))
        content[part] = bytes(part.stop - part.start)
        return bytes(content)

    return damage


damages = st.one_of(
    flips(),
    blanks(),
    *(exchanges(size) for size in (4, 8, 12, SAMPLE_BYTES, CHUNK * SAMPLE_BYTES)),
    st.integers(0, 1000).map(lambda size: lambda content: bytes(content[:size])),
    st.binary(max_size=200).map(lambda junk: lambda content: bytes(content) + junk),
    st.binary(max_size=200).map(lambda junk: lambda content: junk + bytes(content)),
    st.binary(min_size=32, max_size=32).map(lambda start: lambda content: start + bytes(content[32:])),
    st.just(lambda _: b""),
)


def _resumed(store: ChunkStore | PointCacheStore) -> list[np.ndarray]:
    """All chunks, the missing ones computed."""
    for number, chunk in enumerate(CHUNKS):
        if not store.may_have(number) or store.find(number, f"f{number}", chunk.shape) is None:
            store.put(number, f"f{number}", chunk)
    return [np.array(store.read(number, chunk.shape)) for number, chunk in enumerate(CHUNKS)]


def _files(folder: Path) -> Iterator[Path]:
    return (path for path in sorted(folder.iterdir()) if path.suffix in {".npy", ".pc2", ".journal"})


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Folders of bakes that were killed with all chunks there but one."""
    base = tmp_path_factory.mktemp("killed")
    for store in (ChunkStore(base / "npy"), PointCacheStore(base / "pc2", HEADER, CHUNK)):
        for number, chunk in enumerate(CHUNKS[:-1]):
            store.put(number, f"f{number}", chunk)
        store.close()
    return {"npy": base / "npy", "pc2": base / "pc2"}


def _check(folder: Path, kind: str) -> None:
    if kind == "npy":
        found = _resumed(ChunkStore(folder))
        assert all(each.tobytes() == chunk.tobytes() for each, chunk in zip(found, CHUNKS, strict=True))
        return
    store = PointCacheStore(folder, HEADER, CHUNK)
    _resumed(store)
    store.finish(folder / "done")
    assert (folder / "done").read_bytes() == HEADER.packed() + POSITIONS.tobytes()
    store.close()


@settings(max_examples=400)
@given(st.sampled_from(["npy", "pc2"]), st.lists(st.tuples(st.integers(0, 9), damages), min_size=1, max_size=3))
def test_damaged_files_are_never_taken_for_whole(killed, kind: str, done: list[tuple[int, Damage]]):
    with TemporaryDirectory() as temporary:
        folder = Path(temporary) / "chunks"
        shutil.copytree(killed[kind], folder)
        paths = list(_files(folder))
        for number, damage in done:
            path = paths[number % len(paths)]
            path.write_bytes(damage(bytearray(path.read_bytes())))
        _check(folder, kind)


@settings(max_examples=60)
@given(st.sampled_from(["npy", "pc2"]), st.permutations(range(len(CHUNKS) - 1)))
def test_chunks_in_another_order_are_not_taken_for_each_other(killed, kind: str, order: list[int]):
    """Files that changed names, or places in the cache together with their lines of the journal."""
    with TemporaryDirectory() as temporary:
        folder = Path(temporary) / "chunks"
        shutil.copytree(killed[kind], folder)
        if kind == "npy":
            paths = list(_files(folder))
            contents = [path.read_bytes() for path in paths]
            for path, number in zip(paths, order, strict=True):
                path.write_bytes(contents[number])
        else:
            size, path = CHUNK * SAMPLE_BYTES, folder / "cache.pc2"
            content = path.read_bytes()
            parts = [content[32 + size * number : 32 + size * (number + 1)] for number in order]
            path.write_bytes(content[:32] + b"".join(parts))
            layout, *lines = (folder / "cache.journal").read_text().splitlines()
            sums = [line.split()[2] for line in lines]
            lines = [f"{number} f{number} {sums[other]}" for number, other in enumerate(order)]
            (folder / "cache.journal").write_text("\n".join([layout, *lines, ""]))
        _check(folder, kind)


def test_undamaged_chunks_are_resumed(killed, tmp_path: Path):
    for kind, folder in killed.items():
        shutil.copytree(folder, tmp_path / kind)
    for store in (ChunkStore(tmp_path / "npy"), PointCacheStore(tmp_path / "pc2", HEADER, CHUNK)):
        _resumed(store)
        assert store.found_count == len(CHUNKS) - 1


hostile = st.one_of(
    st.binary(max_size=300),
    st.tuples(
        st.sampled_from([b"POINTCACHE2\0", b"POINTCACHE1\0"]),
        st.tuples(*[st.one_of(st.integers(-3, 9), st.integers(-(2**31), 2**31 - 1))] * 3).map(
            lambda three: np.array(three, "<i4").tobytes()
        ),
        st.binary(max_size=400),
    ).map(lambda parts: parts[0] + parts[1][:8] + parts[2][:8].ljust(8, b"\0") + parts[1][8:] + parts[2]),
)


@settings(max_examples=300)
@given(hostile)
def test_any_file_is_a_cache_or_refused(content: bytes):
    with TemporaryDirectory() as temporary:
        path = Path(temporary) / "some.pc2"
        path.write_bytes(content)
        try:
            header, samples = point_cache.read(path)
        except point_cache.PointCacheError:
            return
        assert samples.shape == (header.sample_count, header.point_count, 3)
        assert np.isfinite([header.first_frame, header.step]).all()
