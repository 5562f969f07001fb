"""Numbers as an artist reads them."""

from __future__ import annotations


def percent(value: float) -> str:
    """A relative error: 5.79 %, or 0.0003 %."""
    percentage = 100.0 * value
    digits = f"{percentage:.3g}" if abs(percentage) >= 0.01 or percentage == 0.0 else f"{percentage:.4f}"
    return f"{digits}\N{NO-BREAK SPACE}%"


def signed(value: float) -> str:
    """A change: +5.79 %, or −0.0003 %; 0 where no digit is left."""
    if abs(value) < 5e-7:
        return "0"
    return ("+" if value >= 0.0 else "−") + percent(abs(value))
