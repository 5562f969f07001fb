"""What the law costs: frames of one body without and with it, in turns."""

from __future__ import annotations

from time import thread_time
from typing import Literal, NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

# A tube along x, four units long, about as round and fine as a limb of a character.
LENGTH, RADIUS = 4.0, 0.25
BODIES = {
    "14,000 vertices, 8 bones": (350, 40, 8),
    "100,000 vertices, 8 bones": (1000, 100, 8),
    "14,000 vertices, 24 bones": (350, 40, 24),
}
POSES = {
    "all bent by 40°": (0.7, 0.0),
    "all twisted by 40°": (0.0, 0.7),
    "bent and twisted": (0.5, 0.5),
    "one bent by 90°": None,
}


class Way(NamedTuple):
    """What all joints and the body are given."""

    preset: turgor.presets.PresetName
    flesh: float
    crease: float
    fields: Literal["plain", "even"]


PLAIN = Way("isotropic", 0.0, 0.0, "plain")
WAYS = {
    "law": Way("isotropic", 1.0, 1.0, "plain"),
    "even fields": Way("isotropic", 0.0, 0.0, "even"),
    "as added": Way("flesh", 1.0, 0.7, "even"),
}


def _turn(axis: int, angle: float) -> NDArray[np.float64]:
    matrix = np.eye(4)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[[a, a, b, b], [a, b, a, b]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
    return matrix


def _tube(rings: int, sides: int) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    x = np.repeat(np.linspace(0.0, LENGTH, rings), sides)
    angle = np.tile(np.arange(sides) * (2.0 * np.pi / sides), rings)
    points = np.c_[x, RADIUS * np.cos(angle), RADIUS * np.sin(angle)]
    at = np.arange(rings * sides).reshape(rings, sides)
    after = np.roll(at, -1, 1)
    quads = np.stack([at[:-1], at[1:], after[1:], after[:-1]], -1).reshape(-1, 4)
    corners = np.concatenate([quads.ravel(), at[0], at[-1, ::-1]]).astype(np.int32)
    offsets = np.concatenate([np.arange(len(quads) + 1) * 4, [len(quads) * 4 + sides, len(quads) * 4 + 2 * sides]])
    return points, offsets.astype(np.int32), corners


def _body(rings: int, sides: int, bones: int, way: Way) -> tuple[turgor.VolumeSkin, NDArray[np.float64]]:
    points, offsets, corners = _tube(rings, sides)
    step = LENGTH / bones
    heads = np.zeros((bones, 3))
    heads[:, 0] = np.arange(bones) * step
    rest = np.tile(np.eye(4), (bones, 1, 1))
    rest[:, :3, 3] = heads
    distance = (points[:, :1] - heads[:, 0] - step / 2) / step
    weights = np.clip(1.0 - np.maximum(np.abs(distance) - 0.25, 0.0) / 0.5, 0.0, 1.0)
    weights /= weights.sum(1, keepdims=True)
    rows, used = np.nonzero(weights > 1e-6)
    first = np.searchsorted(rows, np.arange(len(points) + 1)).astype(np.int32)
    skeleton = turgor.Skeleton(np.arange(-1, bones - 1, dtype=np.int32), rest)
    skinning = turgor.Skinning(skeleton, first, used.astype(np.int32), weights[rows, used])
    joints = [turgor.presets.joint(way.preset, bone, flesh=way.flesh, crease=way.crease) for bone in range(bones)]
    return turgor.VolumeSkin(turgor.Mesh(points, offsets, corners), skinning, joints, fields=way.fields), rest


def _pose(rest: NDArray[np.float64], turn: tuple[float, float] | None) -> NDArray[np.float64]:
    posed = rest.copy()
    for bone in range(1, len(rest)):
        bend, twist = turn or ((np.pi / 2 if bone == len(rest) // 2 else 0.0), 0.0)
        local = np.linalg.inv(rest[bone - 1]) @ rest[bone] @ _turn(2, bend) @ _turn(0, twist)
        posed[bone] = posed[bone - 1] @ local
    return posed @ np.linalg.inv(rest)


def run(turns: int) -> None:
    """Prints milliseconds per frame without the law, the least of so many, and what else takes as a ratio to it."""
    print(f"\n{'one thread':28}{'pose':22}{'ms':>9}" + "".join(f"{name:>12}" for name in WAYS))
    for name, (rings, sides, bones) in BODIES.items():
        made = [_body(rings, sides, bones, way) for way in (PLAIN, *WAYS.values())]
        offsets = np.empty((rings * sides, 3), np.float32)
        for pose_name, turn in POSES.items():
            pose = _pose(made[0][1], turn)
            times = [float("inf")] * len(made)
            for _ in range(turns):
                for place, (body, _) in enumerate(made):
                    start = thread_time()
                    body.deform_into(offsets, pose)
                    times[place] = min(times[place], thread_time() - start)
            figures = "".join(f"{of_way / times[0]:12.2f}" for of_way in times[1:])
            print(f"{name:28}{pose_name:22}{1e3 * times[0]:9.3f}{figures}", flush=True)
