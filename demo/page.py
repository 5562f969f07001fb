"""The report as a page for artists: one file, nothing to load."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from html import escape
from pathlib import Path
from string import Template

from .plot import volume_plot
from .report import ObjectReport, Report, Timings

# Rows of the table of shells.
SHELLS_SHOWN = 8

TEMPLATE = Path(__file__).with_name("page.html")
STYLE = Path(__file__).with_name("page.css")


@dataclass(frozen=True)
class PicturePair:
    """The same view without and with Turgor."""

    title: str
    text: str
    before: Path
    after: Path


def percent(value: float | None) -> str:
    """A relative error in words an artist reads: 5.8 %, or 0.000003 %."""
    if value is None:
        return "–"
    percentage = 100.0 * value
    if percentage >= 0.01:
        return f"{percentage:.3g} %"
    return f"{percentage:.1g} %" if percentage >= 1e-4 else f"{percentage:.7f}".rstrip("0").rstrip(".") + " %"


def milliseconds(value: float | None) -> str:
    """A time with three digits."""
    return "–" if value is None else f"{value:.3g} ms"


def picture(path: Path, alternative: str) -> str:
    """A PNG inside the page."""
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{escape(alternative)}" src="data:image/png;base64,{data}">'


def pair_section(pair: PicturePair) -> str:
    """Two pictures side by side."""
    return (
        f'<h2>{escape(pair.title)}</h2><p class="soft">{escape(pair.text)}</p><div class="pair">'
        f"<figure>{picture(pair.before, pair.title + ' without Turgor')}"
        '<figcaption><b class="before">Without</b>: Blender\'s Armature alone</figcaption></figure>'
        f"<figure>{picture(pair.after, pair.title + ' with Turgor')}"
        '<figcaption><b class="after">With Turgor</b>: same frame; line: outline <b class="before">without</b>'
        "</figcaption></figure></div>"
    )


def figure(number: str, text: str) -> str:
    """One large number with what it means."""
    return f'<div class="figure"><strong>{number}</strong><span class="soft">{text}</span></div>'


def headline_figures(hero: ObjectReport) -> str:
    """The numbers of the mesh in the pictures."""
    figures = [
        figure(percent(hero.max_relative_volume_error_before), "off at worst, Armature alone"),
        figure(percent(hero.max_relative_volume_error_after), "off at worst, with Turgor"),
    ]
    if hero.median_ms_per_frame and hero.armature_ms:
        figures.append(figure(milliseconds(hero.median_ms_per_frame.engine), "for the exact volume, each frame"))
        figures.append(figure(milliseconds(hero.armature_ms), "for Blender's own Armature modifier"))
    return "".join(figures)


def time_bar(timings: Timings, armature_ms: float) -> str:
    """Where the time of a live frame goes, to one scale with Blender's Armature modifier."""
    longest = max(timings.frame, armature_ms)
    parts = asdict(timings).items()
    spans = "".join(f'<span class="{name}" style="width:{100 * time / longest:.2f}%"></span>' for name, time in parts)
    words = ", ".join(f'<i class="{name}"></i>{name} {milliseconds(time)}' for name, time in parts)
    return (
        f'<p class="note">A live frame takes {milliseconds(timings.frame)}: {words}.</p><div class="bar">{spans}</div>'
        f'<div class="bar"><span class="armature" style="width:{100 * armature_ms / longest:.2f}%"></span></div>'
        f'<p class="note"><i class="armature"></i>Blender\'s Armature modifier on the same mesh: '
        f"{milliseconds(armature_ms)}.</p>"
    )


def object_section(item: ObjectReport) -> str:
    """The curves and times of one corrected mesh."""
    bar = time_bar(item.median_ms_per_frame, item.armature_ms) if item.median_ms_per_frame and item.armature_ms else ""
    return (
        f'<h3>{escape(item.object)}</h3><p class="soft">Change of volume over the animation: '
        '<b class="before">Armature alone</b>, <b class="after">with Turgor</b>.</p>'
        f"{volume_plot(item.moments)}{bar}{shell_table(item)}"
    )


def shell_table(item: ObjectReport) -> str:
    """The corrected shells that are off most, and how much of that is the precision of Blender's own numbers."""
    corrected = [shell for shell in item.components if shell.is_corrected]
    if len(corrected) < 2:
        return ""
    worst = sorted(corrected, key=lambda shell: -(shell.max_relative_volume_error_after or 0.0))[:SHELLS_SHOWN]
    rows = [
        (
            f"{shell.vertices:,}",
            f"{abs(shell.rest_volume):.3g}",
            percent(shell.max_relative_volume_error_before),
            percent(shell.max_relative_volume_error_after),
            percent(shell.armature_float32_error),
            percent(shell.float32_floor),
        )
        for shell in worst
    ]
    shown = "Each shell" if len(worst) == len(corrected) else f"The {len(worst)} shells furthest off"
    return (
        f'<p class="note">{shown}. Blender computes and stores positions in single precision: the last two columns are '
        "the errors that its Armature modifier and mere storage make of an exact shape. They weigh most on small "
        "shells.</p>"
        + html_table(("Vertices", "Volume", "Off without", "Off with", "Armature's rounding", "Storage alone"), rows)
    )


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Heads and cells are HTML."""
    head = "".join(f"<th>{text}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td>{text}</td>" for text in row) + "</tr>" for row in rows)
    return f'<div class="scroll"><table class="numbers"><tr>{head}</tr>{body}</table></div>'


def verdict(item: ObjectReport) -> str:
    """What happened to a mesh, in a sentence."""
    if not item.is_corrected:
        return escape(item.problem or "left as skinned")
    left = [shell for shell in item.components if not shell.is_corrected]
    if not left:
        return "keeps its volume"
    kinds = sorted({shell.status.replace("_", " ") for shell in left})
    return f"keeps its volume; {len(left)} of {len(item.components)} shells left as skinned ({', '.join(kinds)})"


def table(objects: Sequence[ObjectReport]) -> str:
    """One row per mesh."""
    rows = "".join(
        f'<tr><td>{escape(item.object)}</td><td class="words">{verdict(item)}</td><td>{item.vertices:,}</td>'
        f"<td>{item.bones}</td><td>{item.frames}</td><td>{percent(item.max_relative_volume_error_before)}</td>"
        f"<td>{percent(item.max_relative_volume_error_after)}</td><td>{milliseconds(item.armature_ms)}</td>"
        f"<td>{milliseconds(item.median_ms_per_frame and item.median_ms_per_frame.engine)}</td></tr>"
        for item in objects
    )
    heads = ("Vertices", "Bones", "Frames", "Off without", "Off with", "Armature", "Engine")
    return (
        '<table><tr><th>Mesh</th><th style="text-align:left">Result</th>'
        + "".join(f"<th>{head}</th>" for head in heads)
        + f"</tr>{rows}</table>"
    )


def opening(character: str, hero: ObjectReport | None) -> tuple[str, str]:
    """Headline and first paragraph; hero: the mesh of the pictures."""
    name = character[:1].upper() + character[1:]
    if hero is None:
        return f"{escape(name)}: nothing to correct", "No mesh of this file could be corrected: see below."
    before = percent(hero.max_relative_volume_error_before)
    after = percent(hero.max_relative_volume_error_after)
    return f"{escape(name)} keeps its volume", (
        f'Bent by its armature alone, <b>{escape(hero.object)}</b> is off by <b class="before">{before}</b> at worst. '
        f'With Turgor in the modifier stack it is off by <b class="after">{after}</b>, over {hero.frames} frames.'
    )


def page(report: Report, hero: ObjectReport | None, pairs: Sequence[PicturePair]) -> str:
    """The whole page; hero: the mesh of the pictures."""
    file = report.objects[0].file if report.objects else "nothing"
    character = Path(file).stem.replace("_", " ")
    headline, summary = opening(character, hero)
    plots = "".join(object_section(item) for item in report.objects if item.is_corrected)
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        style=STYLE.read_text(encoding="utf-8"),
        character=escape(character),
        headline=headline,
        summary=summary,
        figures=headline_figures(hero) if hero else "",
        pictures="".join(pair_section(pair) for pair in pairs),
        objects=f"<h2>Volume over time</h2>{plots}" if plots else "",
        table=table(report.objects),
        footer=f"Turgor {escape(report.turgor)} in Blender {escape(report.blender)}, {report.processors} processors, "
        f"file {escape(file)}",
    )
