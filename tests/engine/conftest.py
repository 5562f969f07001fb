"""Hypothesis: the same examples on every machine, no clock."""

from hypothesis import settings

settings.register_profile("turgor", derandomize=True, deadline=None, max_examples=25)
settings.load_profile("turgor")
