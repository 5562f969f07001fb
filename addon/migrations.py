"""Steps that bring saved settings of older releases up to date; files keep the version that wrote them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import bpy

from .properties.character import DATA_VERSION


def _blend_belly(ob: bpy.types.Object) -> None:
    """Belly folded by itself, now by its second set; Custom had the least displacement where shares were automatic."""
    for joint in ob.turgor.joints:
        if joint.preset == "BELLY":
            joint.blend_mode = "LOSS"
            joint.second.preset = "BELLY_FOLDED"
        elif joint.preset == "CUSTOM" and joint.use_auto_shares:
            joint.curve_source = "ISOTROPIC"


# Step n turns settings of version n + 1 into n + 2. Append only; each step has a fixture saved by its release.
STEPS: tuple[Callable[[bpy.types.Object], None], ...] = (_blend_belly,)


def migrate(objects: Iterable[bpy.types.Object]) -> None:
    """Bring characters up to date; settings of a newer release are left as they are.

    Those of linked ones change in this session only, each time anew: their own file keeps what it has.
    """
    for ob in objects:
        saved = ob.turgor
        if 0 < saved.version < DATA_VERSION:
            for step in STEPS[saved.version - 1 :]:
                step(ob)
            saved.version = DATA_VERSION
