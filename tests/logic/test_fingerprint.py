"""A fingerprint changes with every bit of what it names."""

from __future__ import annotations

import numpy as np

from addon.logic.fingerprint import fingerprint

ARRAY = np.arange(6, dtype=np.float32)


def test_equal_arrays_have_equal_fingerprints():
    assert fingerprint([ARRAY], "name") == fingerprint([ARRAY.copy()], "name")
    assert fingerprint([ARRAY.reshape(2, 3).T]) == fingerprint([np.ascontiguousarray(ARRAY.reshape(2, 3).T)])


def test_bits_shape_type_order_and_words_count():
    others = [
        fingerprint([ARRAY + 1]),
        fingerprint([ARRAY.reshape(2, 3)]),
        fingerprint([ARRAY.astype(np.float64)]),
        fingerprint([ARRAY[:3], ARRAY[3:]]),
        fingerprint([ARRAY], "word"),
        fingerprint([]),
    ]
    assert fingerprint([ARRAY]) not in others
    assert len(set(others)) == len(others)
