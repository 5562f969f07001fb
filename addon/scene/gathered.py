"""Several obstacles of one kind told as one: how many, the first names, and all of them for its button."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

from ..messages import Message, message

# So many are named.
MOST_NAMES = 3


def listed(names: Sequence[str]) -> str:
    """The first names, and that there are more."""
    return ", ".join(names[:MOST_NAMES]) + (", …" if len(names) > MOST_NAMES else "")


# `obstacles.Obstacle`, which this file does not know.
Obstacle = TypeVar("Obstacle")


def gathered(found: Iterable[Obstacle]) -> Obstacle | None:
    """The first obstacle, with all others of its id; None without any. Its subject then has one name per line."""
    every = list(found)
    if not every:
        return None
    first = every[0]
    alike = [each for each in every if (each.id, each.fix) == (first.id, first.fix)]
    names = list(dict.fromkeys(each.subject for each in alike if each.subject))
    text = _several(first.id, first.fix, names) if len(names) > 1 else None
    return first if text is None else first._replace(text=text, subject="\n".join(names))


def _several(name: str, fix: str, names: Sequence[str]) -> Message | None:
    count, first = len(names), listed(names)
    if name == "second_armature" and fix == "MOVE_AFTER":
        return message(
            "{count} Armature modifiers deform the body before Turgor Spine: {names}; move them below, or flesh their"
            " own bones",
            count=count,
            names=first,
        )
    if name == "second_armature":
        return message(
            "{count} Armature modifiers deform again after Turgor Volume: {names}; move Turgor Volume below them",
            count=count,
            names=first,
        )
    if name == "simulation":
        return message(
            "{count} modifiers simulate before Turgor Volume: {names}; move them after it", count=count, names=first
        )
    if name == "moving_modifier":
        return message(
            "{count} modifiers can change the mesh from frame to frame before ours: {names}; move them after Turgor",
            count=count,
            names=first,
        )
    if name == "shape_key_modifier":
        return message(
            "{count} modifiers before ours change shape keys: {names}; apply them, or move them after Turgor",
            count=count,
            names=first,
        )
    if name == "render_switch":
        return message(
            "{count} modifiers are on in the viewport or in renders only: {names}; renders show the mesh without"
            " Turgor",
            count=count,
            names=first,
        )
    if name == "render_levels":
        return message(
            "{count} modifiers have other levels in renders than in the viewport: {names}; make them equal, or renders"
            " show the mesh without Turgor",
            count=count,
            names=first,
        )
    return None
