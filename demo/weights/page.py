"""The tables and pictures as a page for artists, in the design of the other demonstrations."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from pathlib import Path
from string import Template

from ..page import STYLE, figure, html_table, picture
from .report import FIGURES, Report
from .trial import BLENDER, TURGOR

TEMPLATE = Path(__file__).with_name("page.html")


def page(report: Report) -> str:
    """The whole page."""
    volume, edges = (report.overall(figure)["median"] for figure in (FIGURES[0], FIGURES[2]))
    count = len(report.cases)
    figures = [
        figure(f"{report.good_count(BLENDER)} of {count}", "difficult bodies are weighted well by bone heat"),
        figure(f"{report.good_count(TURGOR)} of {count}", "of the same by Turgor"),
        figure(f"× {volume:.2f}", "volume lost against bone heat, where that works; median of bodies"),
        figure(f"× {edges:.2f}", "stretch of edges against bone heat; median of bodies"),
    ]
    shown = [trial for trial in report.cases if trial.picture is not None]
    pictures = "".join(
        f"<figure>{picture(trial.picture, trial.name)}<figcaption>{escape(trial.name)}</figcaption></figure>"
        for trial in shown
        if trial.picture is not None
    )
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        style=STYLE.read_text(encoding="utf-8"),
        figures="".join(figures),
        cases=_table(report.case_rows()),
        strains=_table(report.strain_rows()),
        times=_table(report.time_rows()),
        memory=_table(report.memory_rows()),
        pictures=pictures,
        footer=f"Turgor {escape(report.turgor)} in Blender {escape(report.blender)}",
    )


def _table(rows: Iterable[tuple[str, ...]]) -> str:
    heads, *cells = ([escape(text) for text in row] for row in rows)
    return html_table([head.replace(": ", "<br>") for head in heads], cells)
