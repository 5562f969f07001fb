"""Every character has one name on disk, on any system, and it follows from the character alone."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from addon.logic.file_names import DIGEST_BYTES, MOST_CHARACTERS, file_stem, with_ending

ENDINGS = ("_absolute.json", "_point_cache.txt", ".pc2", ".chunks", "_reduced.json.1234567.part")
DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}
LIKE_EACH_OTHER = [
    "A b", "A_b", "A/b", "A\\b", "a_b", "A_B", "Tube", "tube", "TUBE", "Tube.001", "Tube.002", "Tube.1",
    "Tube.", "Tube ", "Straße", "STRASSE", "é", "e\u0301", "É", "\u212a", "K", "k", "Con", "con", "CON",
    "aux.txt", "Aux.001", "..", ".", "", "a" * 48, "A" + "a" * 47, "A" + "a" * 48, "a" * 63, "-rf",
    "Tube-0123456789ab", "ö😀名", "nul\\x", "line\nbreak", "\ud800",
]  # fmt: skip
names = st.one_of(st.text(max_size=63), st.sampled_from(LIKE_EACH_OTHER), st.text("aAbB_. -é\u0301ß1", max_size=6))
libraries = st.sampled_from(["", "//a.blend", "//b.blend", "//B.blend", "//x/a.blend"])
objects = st.tuples(names, libraries)


def on_disk(name: str) -> str:
    """What a disk that ignores case and composition makes of it."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFD", name).casefold())


@settings(max_examples=400)
@given(objects, objects)
@example(("Body", ""), ("body", ""))
def test_two_characters_never_share_a_file(one: tuple[str, str], other: tuple[str, str]):
    assert (on_disk(file_stem(*one)) == on_disk(file_stem(*other))) == (one == other)


def test_names_that_look_alike_differ():
    every = [(name, library) for name in LIKE_EACH_OTHER for library in ("", "//a.blend", "//b.blend")]
    assert len({on_disk(file_stem(*each)) for each in every}) == len(every)


@settings(max_examples=200)
@given(objects)
def test_every_system_takes_the_names(one: tuple[str, str]):
    stem = file_stem(*one)
    for name in (stem + ending for ending in ENDINGS):
        assert re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", name)
        assert len(name) <= MOST_CHARACTERS + 2 * DIGEST_BYTES + 40
        assert name.split(".")[0].lower() not in DEVICES
        assert not name.endswith((".", " "))


@pytest.mark.parametrize("name", ["Tube", "Body", "Tube.001", "Left_arm2", "X"])
def test_plain_names_stay(name: str):
    assert file_stem(name) == name


def test_names_are_the_same_for_ever():
    """A bake that was begun by an older Turgor, or on another machine, is found."""
    assert file_stem("body") == "body-2f977c97f059"
    assert file_stem("Ärmel links", "//lib\\chars.blend") == "Armel_links-9ff9e7f59335"
    assert file_stem("Ärmel links", "//lib/chars.blend") == "Armel_links-9ff9e7f59335"


def test_endings_are_appended_to_names_with_numbers():
    known = frozenset({".glb", ".fbx"})
    assert with_ending(Path("a/Tube.001"), ".glb", known) == Path("a/Tube.001.glb")
    assert with_ending(Path("a/Tube.FBX"), ".glb", known) == Path("a/Tube.glb")
    assert with_ending(Path("a/Tube"), ".glb", known) == Path("a/Tube.glb")
