"""All experiments of one run: the contents of report.json."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from .experiment import Experiment


@dataclass(frozen=True)
class Report:
    """Experiments in one Blender, in the order of the page."""

    blender: str
    turgor: str
    processors: int
    experiments: Sequence[Experiment]

    def experiment(self, name: str) -> Experiment:
        """One of them."""
        return next(experiment for experiment in self.experiments if experiment.name == name)

    @property
    def broken(self) -> list[str]:
        """Claims that do not hold."""
        return [claim.what for experiment in self.experiments for claim in experiment.claims if not claim.holds]

    def write(self, path: Path) -> None:
        """Saves figures and claims as JSON; numbers that are not finite are an error, not a value."""
        content = {
            "blender": self.blender,
            "turgor": self.turgor,
            "processors": self.processors,
            "experiments": {experiment.name: experiment.figures for experiment in self.experiments},
            "claims": [
                asdict(claim) | {"holds": claim.holds} for experiment in self.experiments for claim in experiment.claims
            ],
        }
        path.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
