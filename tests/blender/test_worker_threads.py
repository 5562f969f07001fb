"""Many characters in one evaluation, which Blender spreads over its threads."""

from __future__ import annotations

import bpy
from measure import relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import LAST_FRAME, add_turgor, bend, place, rig, tube_mesh

CHARACTER_COUNT = 8


def test_characters_evaluated_together_stay_exact(route):
    characters = []
    for index in range(CHARACTER_COUNT):
        armature = rig(f"Rig{index}")
        characters.append(place(f"Tube{index}", tube_mesh(f"Tube{index}", rings=61, segments=32), armature))
        bend(armature, 0.5 + 0.1 * index)
    bpy.context.scene.frame_set(1)
    rest = [volume(ob) for ob in characters]
    add_turgor(*characters)
    for frame in range(1, LAST_FRAME + 1):
        bpy.context.scene.frame_set(frame)
        errors = [relative_error(ob, target) for ob, target in zip(characters, rest, strict=True)]
        assert max(errors) < VOLUME_TOLERANCE
