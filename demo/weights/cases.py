"""What breaks automatic weights, one character each, and what good weights of it are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .shapes import Points, Shape, ball, box, drawn, limb

Weights = NDArray[np.float64]
# (N, B) weights of all meshes' vertices, (N, 3) their places, bone -> column.
Law = Callable[[Weights, Points, Mapping[str, int]], bool]
Bones = Mapping[str, tuple[Sequence[float], Sequence[float]]]


@dataclass(frozen=True)
class Case:
    """Meshes and bones in world space. law: what must hold beyond weights on every vertex."""

    name: str
    meshes: Sequence[Shape]
    bones: Bones
    law: Law
    # Scale of the mesh objects, which their vertices undo.
    scale: Sequence[float] = (1.0, 1.0, 1.0)
    # The same body at a size that bone heat is made for: its motion is measured there.
    at_size_one: Case | None = None


def chain(*joints: Sequence[float], name: str = "Bone") -> Bones:
    """Bones from joint to joint."""
    return {f"{name}{i}": (joints[i], joints[i + 1]) for i in range(len(joints) - 1)}


ARM = chain((0, 0, 0), (2, 0, 0), (4, 0, 0))


def arm(caps: int = 2) -> Shape:
    """A limb of two bones."""
    return limb((0, 0, 0), (4, 0, 0), caps=caps)


def follows_arm(weights: Weights, places: Points, bones: Mapping[str, int], least: float = 0.8) -> bool:
    """Each end of the limb belongs to its bone."""
    first, second = (weights[side] for side in (places[:, 0] < 1.0, places[:, 0] > 3.0))
    return holds(first, bones["Bone0"], least) and holds(second, bones["Bone1"], least)


def holds(weights: Weights, column: int, least: float = 0.8) -> bool:
    """All of some vertices belong to one bone."""
    return bool((weights[:, column] > least).all())


def floating_cubes() -> Case:
    """Thirteen cubes along three bones."""
    cubes = [box((0.5 * i - 0.2, -0.2, -0.2), (0.5 * i + 0.2, 0.2, 0.2), (2, 2, 2)) for i in range(13)]
    joints = [(-0.2, 0, 0), (1.8, 0, 0), (4.2, 0, 0), (6.2, 0, 0)]

    def law(weights: Weights, places: Points, bones: Mapping[str, int]) -> bool:
        x = places[:, 0]
        ends = [(x > joints[i][0] + 0.6) & (x < joints[i + 1][0] - 0.6) for i in range(3)]
        return all(holds(weights[end], bones[f"Bone{i}"]) for i, end in enumerate(ends))

    return Case("thirteen floating cubes", [cubes[0].joined(*cubes[1:])], chain(*joints), law)


def hat() -> Case:
    """A hat that hovers over a head."""
    body = limb((0, 0, 0), (0, 0, 3), 0.4).joined(ball((0, 0, 3.9), 0.7))
    brim = limb((0, 0, 4.72), (0, 0, 5.4), 0.6, rings=9)
    start = len(body.points)
    return Case(
        "hat",
        [body.joined(brim)],
        chain((0, 0, 0), (0, 0, 1.5), (0, 0, 3), (0, 0, 4.5)),
        lambda weights, _, bones: holds(weights[start:], bones["Bone2"]),
    )


def buttons() -> Case:
    """Small flat shells in front of a belly."""
    body = limb((0, 0, 0), (0, 0, 4), 0.6)
    places = (0.6, 1.4, 2.6, 3.4)
    discs = [limb((0, -0.72, z), (0, -0.68, z), 0.08, rings=2, sides=8) for z in places]
    count, each = len(body.points), len(discs[0].points)

    def law(weights: Weights, _: Points, bones: Mapping[str, int]) -> bool:
        disc = weights[count:].reshape(len(places), each, -1)
        return all(holds(disc[i], bones["Bone0" if z < 2 else "Bone1"], 0.7) for i, z in enumerate(places))

    return Case("buttons", [body.joined(*discs)], chain((0, 0, 0), (0, 0, 2), (0, 0, 4)), law)


def clothes() -> Case:
    """A body and a shirt around it."""
    return Case("clothes, another mesh", [arm(), limb((0.5, 0, 0), (3.5, 0, 0), 0.6, caps=0)], ARM, follows_arm)


def crossing_limbs() -> Case:
    """Two limbs of one mesh that pass through each other, as folded arms do."""
    first, second = limb((0, 0, 0), (4, 0, 0), 0.3), limb((2, -2, 0.3), (2, 2, 0.3), 0.3)
    bones = {**chain((0, 0, 0), (4, 0, 0), name="First"), **chain((2, -2, 0.3), (2, 2, 0.3), name="Second")}

    def law(weights: Weights, places: Points, index: Mapping[str, int]) -> bool:
        count = len(first.points)
        far = np.linalg.norm(places - [2, 0, 0.15], axis=1) > 1.4
        one = np.arange(len(places)) < count
        return holds(weights[far & one], index["First0"]) and holds(weights[far & ~one], index["Second0"])

    return Case("overlapping limbs", [first.joined(second)], bones, law)


def mouth() -> Case:
    """A head with its mouth open, the tongue close to the palate."""
    outline = [(0, -1), (4, -1), (4, -0.5), (3, -0.5), (3, -0.1), (1.2, -0.1), (1.2, 0.1), (4, 0.1), (4, 1), (0, 1)]
    head = drawn(outline, 0.1, np.linspace(-0.6, 0.6, 7))
    bones = {
        **chain((0.4, 0, 0), (0.8, 0, 0.55), (3.8, 0, 0.55), name="Skull"),
        **chain((0.4, 0, -0.1), (0.8, 0, -0.8), (3.8, 0, -0.8), name="Jaw"),
    }

    def law(weights: Weights, places: Points, index: Mapping[str, int]) -> bool:
        jaw = weights[:, [index["Jaw0"], index["Jaw1"]]].sum(axis=1)
        x, z = places[:, 0], places[:, 2]
        tip, palate = (x > 2.5) & (x < 3.05) & (np.abs(z + 0.1) < 0.01), (x > 2.5) & (np.abs(z - 0.1) < 0.01)
        return bool((jaw[tip] > 0.9).all() and (jaw[palate] < 0.1).all())

    return Case("tongue in an open mouth", [head], bones, law)


def inner_wall() -> Shape:
    """A limb with a wall across its inside: edges with three faces."""
    shape = arm()
    ring = (3 + 16) * 20
    return Shape(shape.points, [*shape.faces, list(range(ring, ring + 20))])


def broken_faces() -> Shape:
    """A limb with collapsed, doubled and turned faces."""
    shape = arm()
    faces = [list(face)[::-1] if number % 7 == 0 else list(face) for number, face in enumerate(shape.faces)]
    return Shape(shape.points, [*faces, *faces[:30], [0, 0, 1], [5, 5, 5], [40, 60, 80], [7, 8, 7]])


def split_apart() -> Case:
    """A limb whose faces have points of their own: seams that must not open."""
    shape = arm().split()
    _, place = np.unique(shape.points.round(9), axis=0, return_inverse=True)

    def law(weights: Weights, places: Points, bones: Mapping[str, int]) -> bool:
        low, high = (np.full((place.max() + 1, weights.shape[1]), start) for start in (np.inf, -np.inf))
        np.minimum.at(low, place.ravel(), weights)
        np.maximum.at(high, place.ravel(), weights)
        return bool((high - low < 1e-3).all()) and follows_arm(weights, places, bones)

    return Case("faces split apart", [shape], ARM, law)


def two_characters() -> Case:
    """Two figures in one mesh, each with its bones."""
    second = arm().moved(lambda p: p + np.array([0.0, 1.4, 0.0]))
    first = arm()
    bones = {**ARM, **chain((0, 1.4, 0), (2, 1.4, 0), (4, 1.4, 0), name="Other")}

    def law(weights: Weights, _: Points, index: Mapping[str, int]) -> bool:
        mine = weights[:, [index["Bone0"], index["Bone1"]]].sum(axis=1)
        count = len(first.points)
        return bool((mine[:count] > 0.99).all() and (mine[count:] < 0.01).all())

    return Case("two characters in one mesh", [first.joined(second)], bones, law)


CLOSED = Case("closed", [arm()], ARM, follows_arm)


def scaled(name: str, factor: float) -> Case:
    """The limb in another unit of length."""

    def law(weights: Weights, places: Points, bones: Mapping[str, int]) -> bool:
        return follows_arm(weights, places / factor, bones)

    bones = {
        name: (factor * np.array(head, float), factor * np.array(tail, float)) for name, (head, tail) in ARM.items()
    }
    return Case(name, [arm().moved(lambda p: factor * p)], bones, law, at_size_one=CLOSED)


def stray() -> Shape:
    """A triangle somewhere."""
    return Shape(np.array([[1.0, 0.0, 9.0], [1.5, 0.0, 9.0], [1.0, 0.5, 9.0]]), [[0, 1, 2]])


CASES: tuple[Case, ...] = (
    CLOSED,
    Case("open at one end", [arm(caps=1)], ARM, follows_arm),
    floating_cubes(),
    hat(),
    buttons(),
    clothes(),
    Case("stray triangle", [arm().joined(stray())], ARM, lambda w, p, b: follows_arm(w[:-3], p[:-3], b)),
    crossing_limbs(),
    mouth(),
    Case("thin wall", [box((0, -0.5, -0.002), (4, 0.5, 0.002), (40, 10, 1))], ARM, follows_arm),
    Case("inverted normals", [arm().inverted()], ARM, follows_arm),
    Case("broken faces", [broken_faces()], ARM, follows_arm),
    scaled("a millionth in size", 1e-6),
    scaled("a million times the size", 1e6),
    # From afar no bone holds much more than the other.
    Case(
        "bones outside",
        [arm()],
        chain((0, 0, 1.2), (2, 0, 1.2), (4, 0, 1.2)),
        lambda weights, places, bones: follows_arm(weights, places, bones, 0.6),
    ),
    Case("unapplied scale", [arm()], ARM, follows_arm, scale=(4.0, 0.25, 1.0)),
    two_characters(),
    split_apart(),
    Case("wall inside", [inner_wall()], ARM, follows_arm),
)
