"""What Blender's exporters write: the selection, for a while."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy


@contextmanager
def only(objects: Sequence[bpy.types.Object]) -> Iterator[None]:
    """Only these are selected and shown within. The frame, the selection and what is hidden are as before afterwards.

    Raises ValueError for an object that is not in the view layer.
    """
    view_layer, scene = bpy.context.view_layer, bpy.context.scene
    outside = [ob.name for ob in objects if ob.name not in view_layer.objects]
    if outside:
        raise ValueError(f"{', '.join(outside)} is not in the view layer: turn its collection on")
    frame, subframe, active = scene.frame_current, scene.frame_subframe, view_layer.objects.active
    selected = [ob.name for ob in view_layer.objects if ob.select_get()]
    hidden = [(ob.name, ob.hide_get(), ob.hide_viewport) for ob in objects]
    try:
        for ob in objects:
            ob.hide_viewport = False
            ob.hide_set(False)
        for ob in view_layer.objects:
            ob.select_set(ob in objects)
        view_layer.objects.active = objects[0]
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)
        for ob in view_layer.objects:
            ob.select_set(ob.name in selected)
        view_layer.objects.active = active
        for name, is_hidden, is_off in hidden:
            ob = view_layer.objects.get(name)
            if ob is not None:
                ob.hide_set(is_hidden)
                ob.hide_viewport = is_off
