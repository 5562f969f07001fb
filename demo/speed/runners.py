"""The characters that are timed, each made in an empty file."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import bpy
import numpy as np

from blend_fixtures import elephant
from blend_fixtures.character import Bone, Character, make_character, make_mesh
from blend_fixtures.posing import key_poses

from ..live import must_turn_on

# Rings, and points of each.
SMALL, LARGE = (151, 44), (400, 250)
LARGE_TUBE = "large tube"
LENGTH, RADIUS = 4.0, 0.5
INFLUENCES = 4
# Degrees, summed over the bones of a tube.
ANGLES = (100.0, 60.0, 70.0)


class Runner(NamedTuple):
    """A character, whether its Armature blends dual quaternions, and the preset of all joints that are listed."""

    name: str
    build: Callable[[], Character]
    is_dual: bool = False
    preset: str | None = None


def runners() -> list[Runner]:
    """Tubes and elephants of about 6.6 and 100 thousand vertices."""
    return [
        Runner("small tube", lambda: tube(*SMALL, 17)),
        Runner("small tube", lambda: tube(*SMALL, 17), is_dual=True),
        Runner(LARGE_TUBE, lambda: tube(*LARGE, 17)),
        Runner(LARGE_TUBE, lambda: tube(*LARGE, 17), is_dual=True),
        Runner(LARGE_TUBE, lambda: tube(*LARGE, 200)),
        Runner("elephant", elephant.build),
        Runner("elephant, Muscle", elephant.build, preset="MUSCLE"),
        Runner("elephant, twice subdivided", dense_elephant),
    ]


def turn_on_as(runner: Runner, body: bpy.types.Object) -> None:
    """Turgor right after the Armature."""
    body.modifiers["Armature"].use_deform_preserve_volume = runner.is_dual
    must_turn_on(body, runner.name)
    if runner.preset is not None:
        for joint in body.turgor.joints:
            joint.preset = runner.preset


def tube(ring_count: int, side_count: int, bone_count: int) -> Character:
    """A closed tube along z on a chain of bones; four of them hold each point."""
    z = np.linspace(0.0, LENGTH, ring_count)
    angle = np.linspace(0.0, 2.0 * np.pi, side_count, endpoint=False)
    circle = RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rings = np.concatenate([np.tile(circle, (ring_count, 1)), np.repeat(z, side_count)[:, None]], axis=1)
    points = np.concatenate([rings, [[0.0, 0.0, 0.0], [0.0, 0.0, LENGTH]]])

    here = np.arange(side_count)
    there, up = (here + 1) % side_count, side_count * np.arange(ring_count - 1)[:, None]
    quads = np.stack([up + here, up + there, up + there + side_count, up + here + side_count], axis=-1).reshape(-1, 4)
    first, last = len(rings), len(rings) + 1
    caps = [[first, b, a] for a, b in zip(here, there, strict=True)]
    caps += [[last, a, b] for a, b in zip(here + up[-1] + side_count, there + up[-1] + side_count, strict=True)]

    names = [f"bone_{number:03d}" for number in range(bone_count)]
    heads = [(0.0, 0.0, LENGTH * number / bone_count) for number in range(bone_count + 1)]
    bones = [Bone(name, heads[i], heads[i + 1], names[i - 1] if i else None) for i, name in enumerate(names)]
    character = make_character("tube", make_mesh("tube", points, [*quads, *caps]), bones, chain_weights(points, bones))
    pose = {name: tuple(angle / bone_count for angle in ANGLES) for name in names}
    opposite = {name: tuple(-angle for angle in angles) for name, angles in pose.items()}
    key_poses(character.armature, {1: opposite, 40: pose})
    return character


def chain_weights(points: np.ndarray, bones: list[Bone]) -> np.ndarray:
    """(N, bone count): a bell about the middle of each bone, the nearest few."""
    middles = np.array([(bone.head[2] + bone.tail[2]) / 2.0 for bone in bones])
    weights = np.exp(-(((points[:, 2:] - middles) * len(bones) / (0.7 * LENGTH)) ** 2))
    weights[weights < np.sort(weights, axis=1)[:, -INFLUENCES, None]] = 0.0
    weights /= weights.sum(axis=1, keepdims=True)
    weights[weights < 0.003] = 0.0
    return weights / weights.sum(axis=1, keepdims=True)


def dense_elephant() -> Character:
    """The elephant with sixteen faces for each."""
    character = elephant.build()
    modifier = character.body.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 2
    character.body.modifiers.move(len(character.body.modifiers) - 1, 0)
    with bpy.context.temp_override(object=character.body, active_object=character.body):
        bpy.ops.object.modifier_apply(modifier=modifier.name)
    return character
