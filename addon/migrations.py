"""Steps that bring saved settings of older releases up to date; files keep the version that wrote them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import bpy

from .properties.character import DATA_VERSION

# Step n turns settings of version n + 1 into n + 2. Append only; each step has a fixture saved by its release.
STEPS: tuple[Callable[[bpy.types.Object], None], ...] = ()


def migrate(objects: Iterable[bpy.types.Object]) -> None:
    """Bring characters up to date; settings of a newer release are left as they are."""
    for ob in objects:
        saved = ob.turgor
        if ob.library is None and 0 < saved.version < DATA_VERSION:
            for step in STEPS[saved.version - 1 :]:
                step(ob)
            saved.version = DATA_VERSION
