"""Volume over time as an inline SVG."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import groupby
from math import ceil, floor, log10

from .report import Moment

WIDTH, HEIGHT = 960, 260
# Per cent: below it lies rounding, which is not to be looked at closer.
LEAST_SPAN = 0.1
LEFT, RIGHT, TOP, BOTTOM = 64, 12, 16, 34


def tick_step(span: float) -> float:
    """A round step that cuts `span` into three to seven parts."""
    power = 10.0 ** floor(log10(span / 3.0))
    return next(power * factor for factor in (1, 2, 5, 10) if span / (power * factor) <= 7.0)


class Axes:
    """Moments to pixels: evenly along x, per cent of the target volume along y."""

    def __init__(self, moments: Sequence[Moment]) -> None:
        changes = [change for moment in moments for change in percentages(moment)]
        low, high = min(0.0, *changes), max(0.0, *changes)
        self.step = tick_step(max(high - low, LEAST_SPAN))
        # A twentieth of a step may stand out: rounding above zero needs no room of its own.
        self.low = floor(low / self.step + 0.05) * self.step
        self.high = ceil(high / self.step - 0.05) * self.step
        if self.high == self.low:
            self.high += self.step
        self.count = len(moments)

    def x(self, index: float) -> float:
        """Pixel of the moment at `index`."""
        return LEFT + (WIDTH - LEFT - RIGHT) * index / max(1, self.count - 1)

    def y(self, percent: float) -> float:
        """Pixel of a change of volume."""
        return TOP + (HEIGHT - TOP - BOTTOM) * (self.high - percent) / (self.high - self.low)

    def ticks(self) -> list[float]:
        """Values with a grid line, zero among them."""
        first = round(self.low / self.step)
        last = round(self.high / self.step)
        return [index * self.step for index in range(first, last + 1)]


def percentages(moment: Moment) -> tuple[float, float]:
    """Change of volume before and after, per cent."""
    return 100.0 * (moment.relative_volume_before - 1.0), 100.0 * (moment.relative_volume_after - 1.0)


def volume_plot(moments: Sequence[Moment]) -> str:
    """Both curves over all takes, a line between takes."""
    axes = Axes(moments)
    parts = [grid_line(axes, tick) for tick in axes.ticks()]
    start = 0
    for take, group in groupby(moments, key=lambda moment: moment.take):
        members = list(group)
        parts.append(take_part(axes, take, start, len(members)))
        for kind, style in enumerate(("before", "after")):
            points = " ".join(
                f"{axes.x(start + index):.1f},{axes.y(percentages(moment)[kind]):.1f}"
                for index, moment in enumerate(members)
            )
            parts.append(f'<polyline class="curve {style}" points="{points}"/>')
        start += len(members)
    label = "Change of volume over time, without and with Turgor"
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{label}">{"".join(parts)}</svg>'


def grid_line(axes: Axes, tick: float) -> str:
    """A horizontal line with its value."""
    y = axes.y(tick)
    style = "zero" if tick == 0.0 else "grid"
    text = f"{tick:+.3g} %" if tick else "0"
    return (
        f'<line class="{style}" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>'
        f'<text class="tick" x="{LEFT - 8}" y="{y + 4:.1f}">{text}</text>'
    )


def take_part(axes: Axes, take: str, start: int, count: int) -> str:
    """The name of a take under its curves, where there is room, and a line at its start."""
    left, right = axes.x(start), axes.x(start + count - 1)
    line = f'<line class="grid" x1="{left:.1f}" x2="{left:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>'
    if right - left < 7 * len(take):
        return line
    middle = (left + right) / 2
    return line + f'<text class="take" x="{middle:.1f}" y="{HEIGHT - 10}">{escape(take)}</text>'
