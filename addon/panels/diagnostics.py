"""What is off with a modifier of ours: open while something is, each finding with the button that mends it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..properties.fixes import LABELS
from ..states import AnyState
from .text import draw_wrapped

if TYPE_CHECKING:
    from ..logic.finding import Finding

ICONS = {"ERROR": "ERROR", "WARNING": "ERROR", "INFO": "INFO"}


def draw_findings(layout: bpy.types.UILayout, context: bpy.types.Context, state: AnyState, kind: str) -> None:
    """A section of a panel of ours. kind: whose modifier, "VOLUME" or "SPINE"."""
    findings = state.findings
    worst = findings[0].severity if findings else ""
    is_off = worst in {"ERROR", "WARNING"}
    # Each has its own memory of being open: what comes up is seen, and what is only good to know stays folded.
    name = f"TURGOR_diagnostics_{kind.lower()}_{'off' if is_off else 'fine'}"
    header, body = layout.panel(name, default_closed=not is_off)
    header.alert = worst == "ERROR"
    title = iface_("Diagnostics")
    count = f" ({len(findings)})" if findings else ""
    header.label(text=title + count, translate=False, icon=ICONS.get(worst, "CHECKMARK"))
    if body is None:
        return
    if not findings:
        body.label(text="Nothing is off")
    for finding in findings:
        _draw(body, context, finding, kind)


def _draw(layout: bpy.types.UILayout, context: bpy.types.Context, finding: Finding, kind: str) -> None:
    box = layout.box().column()
    text = box.column()
    text.alert = finding.severity == "ERROR"
    draw_wrapped(text, context, finding.text, ICONS[finding.severity])
    if finding.fix:
        button = box.row()
        button.enabled = not finding.refusal
        fix = button.operator("object.turgor_volume_fix", text=LABELS[finding.fix])
        fix.kind, fix.fix, fix.subject, fix.refusal = kind, finding.fix, finding.subject, finding.refusal
