"""All that Turgor Volume draws over a viewport; returns at once where no character wants anything."""

from __future__ import annotations

from typing import Any

import bpy

from .. import runtime
from ..properties.saved import volume_settings
from . import graph, heat, joint_axes, readout, refined, text
from .characters import shown

_handles: list[Any] = []


def draw_in_space() -> None:
    """Draw heat maps, previews and axes of all characters of the viewport, in world space over the mesh."""
    heat.keep_only(runtime.session.characters)
    refined.keep_only(runtime.session.characters)
    if not runtime.session.characters:
        return
    context = bpy.context
    for ob, _ in shown(context):
        display = volume_settings(ob).display
        if heat.is_wanted(ob):
            heat.draw(context, ob)
        else:
            heat.free(ob)
        if refined.is_wanted(ob):
            refined.draw(context, ob)
        else:
            refined.free(ob)
        if display.show_axes:
            joint_axes.draw(context, ob)


def draw_on_top() -> None:
    """Draw texts, legends and the graph of all characters of the viewport, in pixels of the region."""
    if not runtime.session.characters:
        return
    context = bpy.context
    x = y = None
    graphed = None
    for ob, character in shown(context):
        display = volume_settings(ob).display
        if display.show_graph and (graphed is None or ob == context.object):
            graphed = ob, character
        if display.show_joint_readout:
            readout.draw_joints(context, ob, character)
        if display.show_axes:
            joint_axes.draw_names(context, ob)
        if not display.show_readout and not heat.is_wanted(ob):
            continue
        if y is None:
            x, y = text.first_line(context, text.visible_rect(context))
        if display.show_readout:
            y = readout.draw(ob, character, x, y)
        y = heat.draw_legend(context, ob, x, y)
    # One graph has place: of the active character, or of the first.
    if graphed is not None:
        graph.draw(context, *graphed)


def register() -> None:
    if not bpy.app.background:
        for callback, event in ((draw_in_space, "POST_VIEW"), (draw_on_top, "POST_PIXEL")):
            _handles.append(bpy.types.SpaceView3D.draw_handler_add(callback, (), "WINDOW", event))


def unregister() -> None:
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    heat.keep_only(set())
    refined.keep_only(set())
