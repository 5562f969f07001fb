"""Percentages as the panels write them."""

from __future__ import annotations


def signed_percent(value: float, digits: int) -> str:
    """With its sign; zero is never negative."""
    return f"{round(value, digits) + 0.0:+.{digits}f} %"
