"""The experiments as a page for artists, in the design of the other demonstration: one file, nothing to load."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template

from ..page import STYLE, figure, milliseconds, picture
from .bend import CURVE
from .cube_sizes import LIMIT_SIZE
from .experiment import Experiment, Picture, Table, without_tags
from .report import Report
from .words import percent

TEMPLATE = Path(__file__).with_name("page.html")


def table_html(table: Table) -> str:
    """Words to the left, numbers to the right."""
    head = "".join(f"<th>{escape(text)}</th>" for text in table.heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in table.rows)
    return f'<div class="scroll"><table><tr>{head}</tr>{body}</table></div>'


def row_html(pictures: Sequence[Picture]) -> str:
    """Pictures side by side."""
    figures = "".join(
        f"<figure>{picture(item.path, without_tags(item.caption))}<figcaption>{item.caption}</figcaption></figure>"
        for item in pictures
    )
    return f'<div class="row" style="--columns:{len(pictures)}">{figures}</div>'


def section(experiment: Experiment) -> str:
    """Its words, pictures, plots and tables."""
    return (
        f"<h2>{escape(experiment.title)}</h2><p>{escape(experiment.text)}</p>"
        + "".join(row_html(row) for row in experiment.pictures)
        + "".join(chart.svg() for chart in experiment.charts)
        + "".join(table_html(table) for table in experiment.tables)
    )


def claims_html(experiments: Sequence[Experiment]) -> str:
    """Every claim with its figure and what was asked."""
    return table_html(
        Table(
            ["Figure", "Measured", "Asked", ""],
            [
                [claim.what, f"{claim.value:.3g}", claim.bound(), "holds" if claim.holds else "FAILS"]
                for experiment in experiments
                for claim in experiment.claims
            ],
        )
    )


def headline_figures(report: Report) -> str:
    """The numbers to remember."""
    cubes, speed = report.experiment("cubes").figures, report.experiment("speed").figures
    at = cubes["sizes"].index(LIMIT_SIZE)
    return "".join(
        [
            figure(percent(cubes["mean"][CURVE][at]), "is what the Curve modifier changes small cubes by"),
            figure(percent(cubes["mean"]["radial"][at]), "is what fleshing changes the same cubes by"),
            figure(milliseconds(speed["frame_ms"]["radial"]), f"for fleshing {speed['vertices']:,} points, each frame"),
            figure(milliseconds(speed["frame_ms"][CURVE]), "for Blender's Curve modifier on the same points"),
        ]
    )


def page(report: Report) -> str:
    """The whole page."""
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        style=STYLE.read_text(encoding="utf-8"),
        headline="Every piece of flesh keeps its volume",
        summary="A body that bends along a curve should neither swell nor shrink: not as a whole, not anywhere inside. "
        '<b class="before">Blender\'s Curve modifier</b> does both. <b class="after">Fleshing</b> keeps every piece, '
        "in three kinds: radial gives way evenly, normal towards and away from the bend, binormal across it.",
        figures=headline_figures(report),
        experiments="".join(section(experiment) for experiment in report.experiments),
        claims=claims_html(report.experiments),
        footer=f"Turgor {escape(report.turgor)} in Blender {escape(report.blender)}, {report.processors} processors",
    )
