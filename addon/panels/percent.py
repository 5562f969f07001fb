"""Percentages as the panels write them."""

from __future__ import annotations


def signed_percent(value: float, digits: int) -> str:
    """With a sign, but for what rounds to zero."""
    rounded = round(value, digits)
    return f"{rounded:+.{digits}f} %" if rounded else f"{0.0:.{digits}f} %"
