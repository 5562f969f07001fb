"""Refining the mesh of a character: `Object.turgor.refine`, for the panel and its preview."""

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

METHODS = (
    ("LINEAR", "Linear", "New vertices lie on the surface as it is: the rest shape stays the same"),
    (
        "SMOOTH",
        "Smooth",
        "New vertices lie on a smooth surface through those that are there; where a Subdivision Surface modifier makes"
        " that surface, it stays",
    ),
)
MOST_LEVELS = 4


def settings() -> dict[str, Any]:
    """Declarations that the operator shares."""
    return {
        "threshold": FloatProperty(
            name="Threshold",
            description="Least weight of a joint that loses volume, from which on faces are refined",
            default=0.2,
            min=0.0,
            max=1.0,
            subtype="FACTOR",
            options=set(),
        ),
        "levels": IntProperty(
            name="Levels",
            description="How often faces are split into four; the most where automatic",
            default=2,
            min=1,
            max=MOST_LEVELS,
            options=set(),
        ),
        "use_automatic": BoolProperty(
            name="Automatic",
            description="Split each face only as often as the profile curves of its joints need to be seen:"
            " folds more than bulges",
            default=True,
            options=set(),
        ),
        "method": EnumProperty(
            name="Method",
            description="Where new vertices lie",
            items=METHODS,
            options=set(),
        ),
    }


def ignore_preview(ob: bpy.types.Object) -> None:
    """Nothing is previewed while the extension is off."""


class TurgorRefine(bpy.types.PropertyGroup):
    """What the panel shows."""

    __annotations__ = {
        **settings(),
        "show_preview": BoolProperty(
            name="Preview",
            description="Color the faces that would be refined over the scene's frames, or its preview range, and draw"
            " the new edges",
            update=lambda saved, context: TurgorRefine.on_preview(saved.id_data),
            options=set(),
        ),
    }

    # What happens when it is switched; replaced while the extension runs.
    on_preview = staticmethod(ignore_preview)
