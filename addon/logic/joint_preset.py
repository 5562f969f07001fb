"""The settings and curves of one joint as text: what a preset file and an asset hold.

The text is one Python literal: readable, and nothing of what other people share is ever run.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from pprint import pformat
from typing import NamedTuple

from ..messages import message, of_error
from .literal_text import LiteralError, value_of

# Version of the text.
FORMAT = 1
FIRST_LINE = "# A joint preset of Turgor."

Point = tuple[float, float, str]  # place and height in 0..1, handle type


class PresetError(ValueError):
    """The text is no joint preset; says what was found."""


class Curve(NamedTuple):
    """One profile curve as drawn."""

    is_symmetric: bool
    points: tuple[Point, ...]


class Profiles(NamedTuple):
    """One set: its preset, and where that is Custom its three curves: along the bone, across, into the bend."""

    preset: str
    curve_source: str
    use_auto_shares: bool
    shares: tuple[float, float, float]
    curves: tuple[Curve, ...]


class JointPreset(NamedTuple):
    """All of a joint but whose it is."""

    strength: float
    size: float
    flex: float
    blend_mode: str
    blend: float
    fold_loss: float
    flesh: float
    use_auto_outside: bool
    outside: float
    spread_twist: float
    crease: float
    first: Profiles
    second: Profiles


def to_text(preset: JointPreset) -> str:
    """Reads back as an equal preset."""
    fields = {"turgor_joint": FORMAT, **preset._asdict()}
    for name in ("first", "second"):
        profiles: Profiles = fields[name]
        curves = [curve._asdict() for curve in profiles.curves]
        fields[name] = {**profiles._asdict(), "curves": curves}
    return f"{FIRST_LINE}\n{pformat(fields, sort_dicts=False, width=100)}\n"


def from_text(text: str) -> JointPreset:
    """Raises PresetError."""
    try:
        fields = value_of(text)
    except LiteralError as error:
        raise PresetError(message("Not a joint preset of Turgor: {error}", error=of_error(error))) from error
    if not isinstance(fields, dict) or "turgor_joint" not in fields:
        raise PresetError("Not a joint preset of Turgor: it has no turgor_joint")
    found = fields["turgor_joint"]
    if found != FORMAT:
        found = repr(found)[:40]
        raise PresetError(
            message("The preset is of format {found}, this Turgor reads {known}", found=found, known=FORMAT)
        )
    return JointPreset(
        _number(fields, "strength", 0.0),
        _number(fields, "size", 0.0),
        _number({"flex": 0.0, **fields}, "flex", 0.0),
        _word(fields, "blend_mode"),
        _number(fields, "blend", 0.0, 1.0),
        _number(fields, "fold_loss", 0.0),
        # Presets of before have none of these, nor flex.
        _number({"flesh": 1.0, **fields}, "flesh", 0.0, 1.0),
        bool(fields.get("use_auto_outside", True)),
        _number({"outside": 1.0, **fields}, "outside", 0.0, 1.0),
        _number({"spread_twist": 1.0, **fields}, "spread_twist", 0.0, 1.0),
        _number({"crease": 0.7, **fields}, "crease", 0.0, 1.0),
        _profiles(fields, "first"),
        _profiles(fields, "second"),
    )


def _profiles(fields: Mapping[str, object], name: str) -> Profiles:
    found = fields.get(name)
    if not isinstance(found, dict):
        raise _wrong(name, found)
    curves = found.get("curves")
    if not isinstance(curves, list) or len(curves) not in (0, 3):
        raise _wrong(f"{name} curves", curves)
    shares = found.get("shares")
    if not isinstance(shares, list | tuple) or len(shares) != 3:
        raise _wrong(f"{name} shares", shares)
    parts = [_number({"share": share}, "share", 0.0, 1.0) for share in shares]
    return Profiles(
        _word(found, "preset"),
        _word(found, "curve_source"),
        bool(found.get("use_auto_shares", True)),
        (parts[0], parts[1], parts[2]),
        tuple(_curve(curve) for curve in curves),
    )


def _curve(found: object) -> Curve:
    if not isinstance(found, dict) or not isinstance(found.get("points"), list | tuple):
        raise _wrong("curve", found)
    points = tuple(_point(point) for point in found["points"])
    if len(points) < 2:
        raise _wrong("points of a curve", points)
    return Curve(bool(found.get("is_symmetric", False)), points)


def _point(found: object) -> Point:
    if not isinstance(found, list | tuple) or len(found) != 3:
        raise _wrong("point of a curve", found)
    place = dict(zip("xyh", found, strict=True))
    return _number(place, "x", 0.0, 1.0), _number(place, "y", 0.0, 1.0), _word(place, "h")


def _number(fields: Mapping[str, object], name: str, least: float, most: float = float("inf")) -> float:
    found = fields.get(name)
    if isinstance(found, bool) or not isinstance(found, int | float):
        raise _wrong(name, found)
    if not (isfinite(found) and least <= found <= most):
        raise _wrong(name, found)
    return float(found)


def _word(fields: Mapping[str, object], name: str) -> str:
    found = fields.get(name)
    if not isinstance(found, str):
        raise _wrong(name, found)
    return found


def _wrong(name: str, found: object) -> PresetError:
    return PresetError(message("The preset's {name} cannot be {found}", name=name, found=repr(found)[:40]))
