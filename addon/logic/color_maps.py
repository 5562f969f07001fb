"""Colors of numbers: even to the eye, rising or falling in lightness, so that they also serve the color-blind.

Made by formula in OKLab, where distances are as the eye sees them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

# Colors of one map, and of the way they are chosen from.
STEPS, FINE_STEPS = 256, 8192
# Lightness, chroma and hue (degrees) at both ends: a dark violet blue, over green, to a bright yellow.
LOW = (0.30, 0.13, 295.0)
HIGH = (0.93, 0.17, 100.0)
# Losses are blue, gains are orange, nothing is white.
LOSS_HUE, GAIN_HUE = 258.0, 48.0
SIGNED_LIGHTNESS, SIGNED_CHROMA = 0.47, 0.16
NEUTRAL_LIGHTNESS = 0.97

_LMS_FROM_LAB = np.array(
    [[1.0, 0.3963377774, 0.2158037573], [1.0, -0.1055613458, -0.0638541728], [1.0, -0.0894841775, -1.2914855480]]
)
_LINEAR_FROM_LMS = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)


@cache
def magnitude() -> NDArray[np.float32]:
    """(STEPS, 3) sRGB from nothing to most."""
    at = np.linspace(0.0, 1.0, FINE_STEPS)[:, None]
    lightness, chroma, hue = (np.array(LOW) + at * (np.array(HIGH) - np.array(LOW))).T
    return _evenly(_colors(lightness, chroma, hue), STEPS)


@cache
def signed() -> NDArray[np.float32]:
    """(STEPS, 3) sRGB from the largest loss over none to the largest gain."""
    return np.concatenate([_from_neutral(LOSS_HUE)[::-1], _from_neutral(GAIN_HUE)])


def colors_of(values: NDArray[np.float64], most: float, *, is_signed: bool, opacity: float) -> NDArray[np.float32]:
    """(N, 4) sRGB and alpha of (N,) values from 0, or from -most, to most; those that are not finite are clear."""
    is_known = np.isfinite(values)
    part = np.where(is_known, values, 0.0) / most if most > 0.0 else np.zeros(len(values))
    if is_signed:
        part = 0.5 + 0.5 * part
    steps = np.clip(part * (STEPS - 1) + 0.5, 0, STEPS - 1).astype(np.intp)
    found = np.empty((len(values), 4), np.float32)
    found[:, :3] = (signed() if is_signed else magnitude())[steps]
    found[:, 3] = np.where(is_known, opacity, 0.0)
    return found


def lab(colors: NDArray[np.float32]) -> NDArray[np.float64]:
    """(N, 3) OKLab of sRGB."""
    linear = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    lms = np.cbrt(np.maximum(linear.astype(np.float64) @ np.linalg.inv(_LINEAR_FROM_LMS).T, 0.0))
    return lms @ np.linalg.inv(_LMS_FROM_LAB).T


def _from_neutral(hue: float) -> NDArray[np.float32]:
    """(STEPS / 2, 3)"""
    at = np.linspace(0.0, 1.0, FINE_STEPS)
    lightness = NEUTRAL_LIGHTNESS + at * (SIGNED_LIGHTNESS - NEUTRAL_LIGHTNESS)
    return _evenly(_colors(lightness, SIGNED_CHROMA * at, np.full(len(at), hue)), STEPS // 2)


def _evenly(colors: NDArray[np.float32], count: int) -> NDArray[np.float32]:
    """(count, 3) the same way through the colors in steps of one size."""
    steps = np.linalg.norm(np.diff(lab(colors), axis=0), axis=1)
    lengths = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, lengths[-1], count)
    return np.stack([np.interp(at, lengths, channel) for channel in colors.T], axis=1).astype(np.float32)


def _colors(
    lightness: NDArray[np.float64], chroma: NDArray[np.float64], hue: NDArray[np.float64]
) -> NDArray[np.float32]:
    """(N, 3) sRGB; what no screen shows loses chroma, never lightness."""
    inside, outside = np.zeros_like(chroma), chroma.copy()
    outside_fits = _fits(_linear(lightness, outside, hue))
    for _ in range(24):
        middle = 0.5 * (inside + outside)
        fits = _fits(_linear(lightness, middle, hue))
        inside, outside = np.where(fits, middle, inside), np.where(fits, outside, middle)
    linear = np.clip(_linear(lightness, np.where(outside_fits, chroma, inside), hue), 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055).astype(np.float32)


def _linear(
    lightness: NDArray[np.float64], chroma: NDArray[np.float64], hue: NDArray[np.float64]
) -> NDArray[np.float64]:
    angle = np.radians(hue)
    parts = np.stack([lightness, chroma * np.cos(angle), chroma * np.sin(angle)], axis=1)
    return (parts @ _LMS_FROM_LAB.T) ** 3 @ _LINEAR_FROM_LMS.T


def _fits(linear: NDArray[np.float64]) -> NDArray[np.bool_]:
    return ((linear >= 0.0) & (linear <= 1.0)).all(axis=1)
