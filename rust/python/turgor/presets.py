"""The six ready-made corrections of a joint [RHC09, section 5; MATH 4]."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ._native import Joint

PresetName = Literal["isotropic", "rubber", "muscle", "folds", "belly", "flesh"]
Shares = tuple[float, float, float] | tuple[float, float, float, float] | Literal["auto"]
Profile = NDArray[np.float64]

# Samples per curve over x in [-1, 1]: linear interpolation errs by 1e-4 of the bell's height.
SAMPLE_COUNT = 129
# Width of the bells and distance of the muscle's centre from the joint, in joint lengths.
BELL_WIDTH = 0.25
MUSCLE_CENTRE = 0.35
FOLD_FREQUENCY = 3.0
BELLY_WIDTHS = (0.35, 0.3, 0.3)
# A joint is four to five radii of its limb long: three radii along it, most of it nine tenths of one inside.
FLESH_WIDTHS = (0.75, 0.2)
FLESH_CENTRE = 0.2

_X: Profile = np.linspace(-1.0, 1.0, SAMPLE_COUNT, dtype=np.float64)


def bell(width: float = BELL_WIDTH, centre: float = 0.0) -> Profile:
    """exp(-(x - centre)²/width²) over x in [-1, 1], (SAMPLE_COUNT,), fading to zero at both ends."""
    return np.exp(-(((_X - centre) / width) ** 2)) * (1.0 - _X**8)


def _round() -> Profile:
    """(1 - x²/8σ²)⁸: along each axis the round bell of a joint without curves; their product is near to it."""
    return np.power(np.maximum(1.0 - np.square(_X / BELL_WIDTH) / 8.0, 0.0), 8.0)


def _inside() -> Profile:
    return np.maximum(_X, 0.0)


def _waves(frequency: float) -> Profile:
    return np.square(np.sin(np.pi * frequency * _X))


DEFAULT_SHARES: dict[PresetName, tuple[float, float, float] | Literal["auto"]] = {
    "isotropic": "auto",
    "rubber": (0.0, 1.0, 0.0),
    "muscle": (0.1, 0.1, 0.8),
    "folds": (0.0, 0.5, 0.5),
    "belly": (0.1, 0.1, 0.8),
    "flesh": (0.0, 0.7, 0.3),
}


def profiles(preset: PresetName) -> tuple[Profile, Profile, Profile]:
    """The three curves of a preset, along the parent, along the axis of the bend, towards its inside."""
    if preset == "isotropic":
        return _round(), _round(), _round()
    if preset == "rubber":
        return bell(), bell(), bell()
    if preset == "muscle":
        return bell(centre=-MUSCLE_CENTRE), bell(), bell() * _inside()
    if preset == "folds":
        return bell() * _waves(FOLD_FREQUENCY), bell(), bell()
    if preset == "belly":
        x, y, z = (bell(width) for width in BELLY_WIDTHS)
        return x, y, z * _inside()
    if preset == "flesh":
        along, inwards = FLESH_WIDTHS
        return bell(along), 1.0 - _X**8, bell(inwards, FLESH_CENTRE)
    raise ValueError(f"preset: found {preset!r}, need one of {', '.join(DEFAULT_SHARES)}")


def folded_profiles(preset: PresetName) -> tuple[Profile, Profile, Profile] | None:
    """The curves that a preset turns into as its joint loses volume; None where it keeps its own."""
    x, y, z = profiles(preset)
    return (x * _waves(FOLD_FREQUENCY), y, z) if preset == "belly" else None


def joint(
    preset: PresetName,
    bone: int,
    *,
    shares: Shares | None = None,
    strength: float = 1.0,
    size: float = 1.0,
    flex: float = 0.0,
    flesh: float = 0.0,
    outside: float | None = None,
    spread_twist: float = 1.0,
    crease: float = 1.0,
) -> Joint:
    """The joint of a preset by name; shares None: those of the preset; the rest as `Joint` takes it."""
    curves = None if preset == "isotropic" else profiles(preset)
    return Joint(
        bone,
        DEFAULT_SHARES[preset] if shares is None else shares,
        curves,
        folded_profiles=folded_profiles(preset),
        strength=strength,
        size=size,
        flex=flex,
        flesh=flesh,
        outside=outside,
        spread_twist=spread_twist,
        crease=crease,
    )


def isotropic(bone: int, *, strength: float = 1.0, size: float = 1.0) -> Joint:
    """Even swelling around the joint, by the least displacement."""
    return joint("isotropic", bone, strength=strength, size=size)


def rubber(bone: int, *, strength: float = 1.0, size: float = 1.0) -> Joint:
    """Bulges sideways, along the axis of the bend."""
    return joint("rubber", bone, strength=strength, size=size)


def muscle(bone: int, *, strength: float = 1.0, size: float = 1.0) -> Joint:
    """Swells on the parent's side, on the inside of the bend: a biceps."""
    return joint("muscle", bone, strength=strength, size=size)


def folds(bone: int, *, strength: float = 1.0, size: float = 1.0) -> Joint:
    """Wrinkles across the parent's direction."""
    return joint("folds", bone, strength=strength, size=size)


def belly(bone: int, *, strength: float = 1.0, size: float = 1.0) -> Joint:
    """One bulge at the inside of the bend while little is lost, folds as more is."""
    return joint("belly", bone, strength=strength, size=size)


def flesh(bone: int, *, strength: float = 1.0, size: float = 1.0) -> Joint:
    """Across the limb, wide along it, to the inside of the bend: what flesh does."""
    return joint("flesh", bone, strength=strength, size=size)
