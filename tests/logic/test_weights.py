"""Vertex groups become blend weights of bones."""

from __future__ import annotations

import numpy as np

from addon.logic.weights import bone_weights, vertex_mask

OFFSETS = np.array([0, 2, 2, 5], np.int32)
GROUPS = np.array([1, 0, 2, 1, 0], np.int32)
WEIGHTS = np.array([0.25, 0.75, 1.0, 0.5, 0.125], np.float32)


def test_groups_that_name_no_bone_are_left_out_and_order_is_kept():
    found = bone_weights(OFFSETS, GROUPS, WEIGHTS, ["Hip", "Mask", "Knee"], {"Hip": 4, "Knee": 7})
    assert found.offsets.tolist() == [0, 1, 1, 3]
    assert found.bones.tolist() == [4, 7, 4]
    assert found.weights.tolist() == [0.75, 1.0, 0.125]


def test_weights_of_a_deleted_group_are_left_out():
    found = bone_weights(OFFSETS, GROUPS, WEIGHTS, ["Hip"], {"Hip": 0})
    assert found.offsets.tolist() == [0, 1, 1, 2]


def test_mask_and_its_inverse_sum_to_one():
    mask = vertex_mask(OFFSETS, GROUPS, WEIGHTS, 1, is_inverted=False)
    assert mask.tolist() == [0.25, 0.0, 0.5]
    assert (mask + vertex_mask(OFFSETS, GROUPS, WEIGHTS, 1, is_inverted=True) == 1.0).all()
