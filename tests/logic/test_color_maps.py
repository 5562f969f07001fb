"""Colors of heat maps: even to the eye, with normal sight and without a kind of cone."""

from __future__ import annotations

import numpy as np
import pytest

from addon.logic import color_maps

MAPS = {"magnitude": color_maps.magnitude(), "signed": color_maps.signed()}
# What is seen without the cones for red, and without those for green: linear RGB to linear RGB, of full severity.
SIGHTS = {
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
}


def _seen(colors: np.ndarray, sight: str) -> np.ndarray:
    linear = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    linear = np.clip(linear @ np.array(SIGHTS[sight]).T, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


@pytest.mark.parametrize("name", MAPS)
def test_colors_are_of_the_screen(name):
    colors = MAPS[name]
    assert colors.shape == (color_maps.STEPS, 3)
    assert colors.min() >= 0.0
    assert colors.max() <= 1.0


@pytest.mark.parametrize("name", MAPS)
def test_equal_steps_look_equal(name):
    half = color_maps.STEPS // 2
    parts = [MAPS[name][:half], MAPS[name][half:]] if name == "signed" else [MAPS[name]]
    for part in parts:
        steps = np.linalg.norm(np.diff(color_maps.lab(part), axis=0), axis=1)
        assert steps.max() <= 1.05 * steps.min()


@pytest.mark.parametrize("sight", SIGHTS)
def test_the_color_blind_read_magnitudes_by_lightness(sight):
    lightness = color_maps.lab(_seen(MAPS["magnitude"], sight))[:, 0]
    assert (np.diff(lightness) > 0.0).all()
    assert lightness[-1] - lightness[0] > 0.5


@pytest.mark.parametrize("sight", SIGHTS)
def test_the_color_blind_tell_losses_from_gains(sight):
    colors = color_maps.lab(_seen(MAPS["signed"], sight))
    losses, gains = colors[: color_maps.STEPS // 2][::-1], colors[color_maps.STEPS // 2 :]
    for side in (losses, gains):
        assert (np.diff(side[:, 0]) < 0.0).all()
    apart = np.linalg.norm(losses - gains, axis=1)
    assert apart[-1] > 0.2
    assert (apart[16:] > 0.02).all()


def test_values_take_their_place():
    values = np.array([-2.0, -1.0, 0.0, 1.0, 2.0, np.nan])
    signed = color_maps.colors_of(values, 1.0, is_signed=True, opacity=0.5)
    assert (signed[0] == signed[1]).all()
    assert (signed[3] == signed[4]).all()
    assert np.ptp(signed[2, :3]) < 0.02
    assert signed[:, 3].tolist() == [0.5] * 5 + [0.0]
    magnitudes = color_maps.colors_of(values, 1.0, is_signed=False, opacity=1.0)
    assert np.allclose(magnitudes[2, :3], MAPS["magnitude"][0])
    assert np.allclose(magnitudes[3, :3], MAPS["magnitude"][-1])


def test_nothing_at_all_has_the_lowest_color():
    found = color_maps.colors_of(np.zeros(3), 0.0, is_signed=False, opacity=1.0)
    assert np.allclose(found[:, :3], MAPS["magnitude"][0])
