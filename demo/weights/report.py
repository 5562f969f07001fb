"""All figures of one run: the contents of report.json, and of the tables."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from .motion import Strain
from .trial import BLENDER, TURGOR, WAYS, Result

# A tenth of a per cent: what is less is as good as nothing.
LEAST_STRAIN = 1e-3
FIGURES = ("volume_mean", "volume_worst", "edges_mean", "edges_worst")


@dataclass(frozen=True)
class Trial:
    """One body, weighted both ways. results: what cases ask for, None for characters.

    strains: Blender's of the body at size one, where there is such a one.
    """

    name: str
    vertex_count: int
    strains: Mapping[str, Strain]
    results: Mapping[str, Result] | None = None
    picture: Path | None = None

    @property
    def is_comparable(self) -> bool:
        """Whether bone heat works here, and something can turn."""
        works = self.results is None or self.results[BLENDER].is_good
        return works and self.strains[BLENDER].pose_count > 0

    def ratio(self, figure: str) -> float:
        """Turgor's over Blender's."""
        mine, heat = (max(getattr(self.strains[way], figure), LEAST_STRAIN) for way in (TURGOR, BLENDER))
        return mine / heat


@dataclass
class Report:
    """times in seconds, memory in bytes."""

    blender: str
    turgor: str
    cases: list[Trial] = field(default_factory=list)
    characters: list[Trial] = field(default_factory=list)
    times: dict[str, dict[str, float]] = field(default_factory=dict)
    memory: dict[str, dict[str, int]] = field(default_factory=dict)

    @property
    def compared(self) -> list[Trial]:
        """What both ways can be measured on."""
        return [trial for trial in (*self.characters, *self.cases) if trial.is_comparable]

    def overall(self, figure: str) -> dict[str, float]:
        """Of the ratios of all bodies."""
        ratios = [trial.ratio(figure) for trial in self.compared]
        return {"median": float(np.median(ratios)), "geometric mean": float(np.exp(np.mean(np.log(ratios))))}

    def good_count(self, way: str) -> int:
        """Cases in which every vertex has weights and what the case asks for holds."""
        return sum(trial.results is not None and trial.results[way].is_good for trial in self.cases)

    def case_rows(self) -> Iterator[tuple[str, ...]]:
        """Heads first."""
        yield ("", "vertices", *(f"{way}: {what}" for way in WAYS for what in ("without", "sum − 1", "verdict")))
        for trial in self.cases:
            results = trial.results or {}
            yield (
                trial.name,
                f"{trial.vertex_count:,}",
                *(
                    text
                    for result in (results[way] for way in WAYS)
                    for text in (
                        f"{result.unweighted_count:,}",
                        f"{result.sum_error:.0e}",
                        "good" if result.is_good else "fails",
                    )
                ),
            )

    def strain_rows(self) -> Iterator[tuple[str, ...]]:
        """Heads first; per cent, Blender's then Turgor's."""
        words = ("volume, mean", "volume, worst", "edges, mean", "edges, worst")
        yield ("%", "poses", *(f"{word}: {way}" for word in words for way in WAYS))
        for trial in self.compared:
            figures = (100.0 * getattr(trial.strains[way], figure) for figure in FIGURES for way in WAYS)
            yield (trial.name, f"{trial.strains[BLENDER].pose_count}", *(f"{figure:.2f}" for figure in figures))
        for kind in ("median", "geometric mean"):
            ratios = (text for figure in FIGURES for text in ("", f"× {self.overall(figure)[kind]:.2f}"))
            yield (f"{kind} of ratios", "", *ratios)

    def time_rows(self) -> Iterator[tuple[str, ...]]:
        """Heads first."""
        yield ("", *(f"{way}, s" for way in WAYS), "ratio")
        for name, seconds in self.times.items():
            ratio = seconds[TURGOR] / seconds[BLENDER]
            yield (name, *(f"{seconds[way]:.2f}" for way in WAYS), f"{ratio:.2f}")

    def memory_rows(self) -> Iterator[tuple[str, ...]]:
        """Heads first; of the engine's own process."""
        yield ("", "before, MB", "at most, MB")
        for name, peaks in self.memory.items():
            yield (name, *(f"{peaks[when] / 1e6:.0f}" for when in ("before", "after")))

    def text(self) -> str:
        """The tables in columns."""
        good = ", ".join(f"{way} {self.good_count(way)}" for way in WAYS)
        tables = [
            columns(list(rows)) for rows in (self.case_rows(), self.strain_rows(), self.time_rows(), self.memory_rows())
        ]
        return "\n\n".join([tables[0], f"good: {good} of {len(self.cases)}", *tables[1:]])

    def write(self, path: Path) -> None:
        """Saves all figures as JSON."""
        content = {
            "blender": self.blender,
            "turgor": self.turgor,
            "cases": {
                trial.name: {
                    way: asdict(result) | {"is_good": result.is_good} for way, result in (trial.results or {}).items()
                }
                for trial in self.cases
            },
            "characters": {
                trial.name: {way: asdict(strain) for way, strain in trial.strains.items()} for trial in self.characters
            },
            "ratios": {trial.name: {figure: trial.ratio(figure) for figure in FIGURES} for trial in self.compared},
            "overall": {figure: self.overall(figure) for figure in FIGURES},
            "times": {
                name: seconds | {"ratio": seconds[TURGOR] / seconds[BLENDER]} for name, seconds in self.times.items()
            },
            "memory": self.memory,
        }
        path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def columns(rows: Sequence[Sequence[str]]) -> str:
    """The first column to the left, the others to the right, heads broken at their colon."""
    heads = [head.split(": ") if ": " in head else ["", head] for head in rows[0]]
    lines = [*zip(*heads, strict=True), *rows[1:]]
    widths = [max(len(line[column]) for line in lines) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join([line[0].ljust(widths[0]), *map(str.rjust, line[1:], widths[1:])]).rstrip() for line in lines
    )
