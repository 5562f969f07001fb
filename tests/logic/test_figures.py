"""Figures of frames and of whole motions."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

figures = importlib.import_module("addon.logic.figures")


def test_a_joint_without_extent_folds_nothing():
    found = figures.fold_losses(np.array([[0.0, -0.2]]), np.array([0.0, 2.0]), np.eye(4)[None])
    assert found.tolist() == [[0.0, pytest.approx(0.25)]]


def test_folding_does_not_depend_on_the_scale_of_the_rig():
    losses, lengths = np.array([[0.3, 0.1], [0.2, 0.4]]), np.array([1.5, 0.7])
    plain = figures.fold_losses(losses, lengths, np.stack([np.eye(4)] * 2))
    scaled = figures.fold_losses(losses, lengths * 100.0, np.stack([np.diag([0.01, 0.01, 0.01, 1.0])] * 2))
    assert np.allclose(plain, scaled)
