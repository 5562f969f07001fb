"""The rooms of the engine: who stands on whom (docs/ARCHITECTURE.md), and no circles between files."""

from __future__ import annotations

import pytest
from rust_modules import circles, uses
from sources import REPOSITORY

CORE = REPOSITORY / "rust/core/src"
# From the ground up: a room uses only those before it. Single files of the crate stand above all.
ROOMS = (
    "error",
    "numeric",
    "parallel",
    "surface",
    "cores",
    "skinning",
    "volume_losses",
    "fields",
    "folds",
    "spine",
    "weights",
)
ABOVE = {"report", "binding", "frame", "volume_skin", "workspaces", "many_poses"}
# Rooms that know nothing of skinned bodies, and that nothing of those knows.
APART = {"spine", "weights"}
USED = uses(CORE)


def test_every_room_has_its_place():
    assert {module[0] for module in USED if module} == {*ROOMS, *ABOVE}


def test_no_modules_use_each_other_in_a_circle():
    assert circles(USED) == []


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_stands_on_those_below(room: str):
    used = {other[0] for module, others in USED.items() if module[:1] == (room,) for other in others if other}
    assert used - {room} <= set(ROOMS[: ROOMS.index(room)]) - APART


def test_nothing_of_skinned_bodies_uses_spines_or_automatic_weights():
    users = {module[0] for module, others in USED.items() for other in others if module and other and other[0] in APART}
    assert users <= APART


def test_circles_are_found():
    a, b, c = ("a",), ("b", "inner"), ("c",)
    assert circles({a: {b}, b: {c}, c: {a}}) == [[a, b, c]]
    assert circles({a: {b}, b: {c}, c: set()}) == []
