"""What an experiment found: tables, plots, pictures, and the claims it must hold."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .chart import Chart


@dataclass(frozen=True)
class Claim:
    """A figure and the bounds that it must keep."""

    what: str
    value: float
    most: float | None = None
    least: float | None = None

    @property
    def holds(self) -> bool:
        """True when the figure is within its bounds."""
        return (self.most is None or self.value <= self.most) and (self.least is None or self.value >= self.least)

    def bound(self) -> str:
        """What is asked, in words."""
        return f"at most {self.most:.3g}" if self.most is not None else f"at least {self.least:.3g}"


@dataclass(frozen=True)
class Table:
    """Heads and cells, as text."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]

    def text(self) -> str:
        """In columns: the first to the left, the others to the right."""
        lines = [self.heads, *self.rows]
        widths = [max(len(line[column]) for line in lines) for column in range(len(self.heads))]
        return "\n".join(
            "  ".join([line[0].ljust(widths[0]), *(map(str.rjust, line[1:], widths[1:]))]).rstrip() for line in lines
        )


@dataclass(frozen=True)
class Picture:
    """A rendered PNG; its caption is HTML."""

    path: Path
    caption: str


@dataclass(frozen=True)
class Experiment:
    """One figure or table of the paper. figures: its numbers under plain names, for report.json."""

    name: str
    title: str
    text: str
    tables: Sequence[Table]
    claims: Sequence[Claim]
    figures: dict[str, Any]
    charts: Sequence[Chart] = ()
    pictures: list[list[Picture]] = field(default_factory=list)

    def printed(self) -> str:
        """All that it says, as text."""
        captions = [without_tags(picture.caption) for row in self.pictures for picture in row]
        verdicts = [
            f"{'holds' if claim.holds else 'FAILS'}: {claim.what}: {claim.value:.3g}, asked {claim.bound()}"
            for claim in self.claims
        ]
        parts = [f"\n{self.title.upper()}", self.text, *(table.text() for table in self.tables), *captions, *verdicts]
        return "\n".join(parts)


def without_tags(html: str) -> str:
    """Its words."""
    return re.sub(r"<[^>]*>", "", html)
