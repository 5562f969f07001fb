"""Curves of numbers as an inline SVG, on even or logarithmic axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from math import ceil, floor, log10

from ..plot import tick_step

WIDTH, HEIGHT = 960, 320
LEFT, RIGHT, TOP, BOTTOM = 78, 30, 16, 34
# Room under the ticks for the name of the x axis.
NAME_HEIGHT = 20

# One colour for each way of bending, on all charts.
COLOURS = {
    "Curve modifier": "var(--before)",
    "radial": "var(--after)",
    "normal": "#c9972f",
    "binormal": "#7b8f57",
}


@dataclass(frozen=True)
class Line:
    """One curve. way: a name in `COLOURS`; label: what stands at its right end."""

    way: str
    x: Sequence[float]
    y: Sequence[float]
    label: str = ""


@dataclass(frozen=True)
class Chart:
    """Curves over common axes; is_log: both axes are logarithmic, one tick per x of the first line."""

    title: str
    x_name: str
    y_name: str
    lines: Sequence[Line]
    is_log: bool = False
    x_unit: str = ""
    x_step: float | None = None

    def svg(self) -> str:
        """The picture with a legend under it, HTML."""
        axes = Axes(self)
        parts = [*axes.grid()]
        for line in self.lines:
            points = " ".join(f"{axes.x(x):.1f},{axes.y(y):.1f}" for x, y in zip(line.x, line.y, strict=True))
            style = f'style="stroke:{COLOURS[line.way]}"'
            parts.append(f'<polyline class="curve" {style} points="{points}"/>')
            if self.is_log:
                parts += [
                    f'<circle r="4" cx="{axes.x(x):.1f}" cy="{axes.y(y):.1f}" fill="{COLOURS[line.way]}"/>'
                    for x, y in zip(line.x, line.y, strict=True)
                ]
            if line.label:
                x, y = axes.x(line.x[-1]) - 6, axes.y(line.y[-1]) + (-8 if line.y[-1] > -1e-3 else 24)
                parts.append(f'<text class="tick" x="{x:.1f}" y="{y:.1f}">{escape(line.label)}</text>')
        middle = (LEFT + WIDTH - RIGHT) / 2
        parts.append(f'<text class="take" x="{middle:.1f}" y="{HEIGHT - 8}">{escape(self.x_name)}</text>')
        ways = dict.fromkeys(line.way for line in self.lines)
        legend = "".join(f'<span><i style="background:{COLOURS[way]}"></i>{way}</span> ' for way in ways)
        return (
            f'<p class="note">{escape(self.y_name)} {legend}</p>'
            f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(self.title)}">{"".join(parts)}</svg>'
        )


class Axes:
    """Numbers to pixels. y: relative values, ticks in per cent."""

    def __init__(self, chart: Chart) -> None:
        self.is_log = chart.is_log
        self.chart = chart
        xs = [x for line in chart.lines for x in line.x]
        ys = [y for line in chart.lines for y in line.y]
        self.low_x, self.high_x = self.scaled(min(xs)), self.scaled(max(xs))
        if self.is_log:
            self.y_ticks = [10.0**power for power in range(floor(log10(min(ys))), ceil(log10(max(ys))) + 1)]
            self.x_ticks = list(chart.lines[0].x)
        else:
            step = tick_step(100.0 * (max(ys) - min(0.0, *ys))) / 100.0
            self.y_ticks = [step * tick for tick in range(floor(min(0.0, *ys) / step), ceil(max(ys) / step) + 1)]
            x_step = chart.x_step or tick_step(max(xs) - min(xs))
            self.x_ticks = [min(xs) + x_step * tick for tick in range(int((max(xs) - min(xs)) / x_step + 1e-9) + 1)]
        self.low_y, self.high_y = self.scaled(self.y_ticks[0]), self.scaled(self.y_ticks[-1])

    def scaled(self, value: float) -> float:
        """On the axis."""
        return log10(value) if self.is_log else value

    def x(self, value: float) -> float:
        """Pixel of a value."""
        room = 40 if self.is_log else 0
        span = WIDTH - LEFT - RIGHT - 2 * room
        return LEFT + room + span * (self.scaled(value) - self.low_x) / (self.high_x - self.low_x)

    def y(self, value: float) -> float:
        """Pixel of a value."""
        height = HEIGHT - TOP - BOTTOM - NAME_HEIGHT
        return TOP + height * (self.high_y - self.scaled(value)) / (self.high_y - self.low_y)

    def grid(self) -> list[str]:
        """Lines and numbers of both axes."""
        bottom = HEIGHT - BOTTOM - NAME_HEIGHT
        parts = []
        for tick in self.y_ticks:
            y = self.y(tick)
            text = f"{100.0 * tick:g} %" if self.is_log else f"{100.0 * tick:+.3g} %"
            is_zero = abs(tick) < 1e-12
            style = "zero" if is_zero else "grid"
            parts.append(
                f'<line class="{style}" x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>'
                f'<text class="tick" x="{LEFT - 8}" y="{y + 4:.1f}">{"0" if is_zero else text}</text>'
            )
        for tick in self.x_ticks:
            x = self.x(tick)
            parts.append(
                f'<line class="grid" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{bottom}"/>'
                f'<text class="take" x="{x:.1f}" y="{bottom + 18}">{tick:,.4g}{self.chart.x_unit}</text>'
            )
        return parts
