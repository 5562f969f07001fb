"""Weights where solids pass through each other: whose flesh is whose."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import turgor
from bodies import Body, Points, bones
from rigs import applied, random_rotation, rotation, translation
from surfaces import Surface, open_tube, tube

RADIUS = 0.4


def limb(joints: int, place: Points, length: float = 4.0) -> Body:
    """A closed limb, placed, with bones from joint to joint through its middle."""
    xs = np.linspace(0.0, length, joints + 1)
    body = Body([tube(rings=33, sides=12, length=length, radius=RADIUS)], *bones([[x, 0.0, 0.0] for x in xs]))
    return body.moved(lambda p: applied(place, p))


def together(*bodies: Body) -> Body:
    """In one mesh."""
    surface = bodies[0].meshes[0]
    for body in bodies[1:]:
        surface = surface.joined(body.meshes[0])
    return Body([surface], np.vstack([b.heads for b in bodies]), np.vstack([b.tails for b in bodies]))


def crossing(seed: int) -> tuple[Body, Body]:
    """Two limbs that pass through each other anywhere, at any angle from 40 degrees."""
    rng = np.random.default_rng(seed)
    first, second = (int(count) for count in rng.integers(1, 6, 2))
    turn = rotation([0.0, 0.0, 1.0], rng.uniform(0.7, np.pi / 2)) @ rotation([1.0, 0.0, 0.0], rng.uniform(0.0, 6.0))
    met, meets = ([x, 0.0, 0.0] for x in rng.uniform(1.3, 2.7, 2))
    aside = [0.0, *rng.uniform(-0.5, 0.5, 2)]
    place = translation(np.add(met, aside)) @ turn @ translation(-np.array(meets))
    whole = random_rotation(rng, np.pi)
    return limb(first, whole), limb(second, whole @ place)


@pytest.mark.parametrize("seed", range(8))
def test_a_limb_pushed_through_another_changes_no_weights(seed: int):
    limbs = crossing(seed)
    both = together(*limbs)
    weights = both.matrix(resolution=96, max_influences=None)
    count, bone_count = len(limbs[0].positions), len(limbs[0].heads)
    assert (weights[:count, bone_count:] == 0.0).all()
    assert (weights[count:, :bone_count] == 0.0).all()
    own = (weights[:count, :bone_count], weights[count:, bone_count:])
    for body, found in zip(limbs, own, strict=True):
        error = np.abs(found - body.matrix(resolution=96, max_influences=None))
        assert error.max() < 0.1
        assert error.mean() < 0.003


def test_order_of_shells_faces_and_bones_does_not_matter():
    first, second = crossing(3)
    rng = np.random.default_rng(0)
    here, there = together(first, second), together(second, first)
    count, bone_count = len(first.positions), len(first.heads)
    swapped = np.roll(np.roll(there.matrix(resolution=64), count, axis=0), bone_count, axis=1)
    np.testing.assert_allclose(swapped, here.matrix(resolution=64), atol=1e-5)
    surface, order = here.meshes[0], rng.permutation(len(here.heads))
    faces = [surface.faces[i] for i in rng.permutation(len(surface.faces))]
    shuffled = Body([Surface(surface.positions, faces)], here.heads[order], here.tails[order])
    np.testing.assert_allclose(shuffled.matrix(resolution=64), here.matrix(resolution=64)[:, order], atol=1e-5)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_unit_of_length_does_not_matter(scale: float):
    both = together(*crossing(5))
    scaled = both.moved(lambda p: p * scale)
    np.testing.assert_allclose(scaled.matrix(resolution=64), both.matrix(resolution=64), atol=1e-6)


def test_mirrored_bodies_have_mirrored_weights():
    both = together(*crossing(6))
    for axis in range(3):
        flip = np.where(np.arange(3) == axis, -1.0, 1.0)
        mirrored = both.moved(lambda p, flip=flip: p * flip)
        np.testing.assert_allclose(mirrored.matrix(resolution=64), both.matrix(resolution=64), atol=1e-5)


ARM = translation([3.0, 0.3, 0.0]) @ rotation([0.0, 0.0, 1.0], np.pi / 2)
TRUNK_BONES = 2


def arm_in_trunk(gap: float = 0.0) -> Body:
    """An arm that was modelled on its own and stuck into the side of a trunk.

    Bones: two of the trunk, one from there towards the shoulder, two of the arm, which begin `gap` farther.
    """
    trunk, arm = tube(rings=41, sides=24, radius=0.8), tube(rings=31, sides=16, length=3.0, radius=0.3)
    arm = arm.moved(applied(ARM, arm.positions))
    shoulder = [3.0, 0.5 + gap, 0.0]
    return Body(
        [trunk.joined(arm)],
        *bones(
            [[0.0, 0, 0], [2.0, 0, 0], [4.0, 0, 0]],
            [[3.0, 0, 0], [3.0, 0.5, 0]],
            [shoulder, [3.0, 1.9, 0], [3.0, 3.2, 0]],
        ),
    )


PARENTS = [-1, 0, 1, 2, 3]


@pytest.mark.parametrize("gap", [0.0, 0.1, 0.2])
def test_bones_that_lead_from_shell_to_shell_join_them(gap: float):
    """The skin of the trunk follows the arm at the shoulder, and the arm's root the trunk."""
    body = arm_in_trunk(gap)
    weights = body.matrix(resolution=96, bone_parents=PARENTS)
    count = 41 * 24
    trunk, arm = weights[:count], weights[count:]
    assert trunk[:, TRUNK_BONES + 1].max() > 0.5
    assert arm[:, : TRUNK_BONES + 1].sum(axis=1).max() > 0.5
    far = body.positions[count:, 1] > 1.4
    assert (arm[far][:, : TRUNK_BONES + 1] < 1e-2).all()


def test_parents_matter_only_where_shells_overlap():
    whole = limb(4, np.eye(4))
    assert np.array_equal(whole.matrix(bone_parents=[-1, 0, 1, 2]), whole.matrix())


def test_weights_are_continuous_while_a_bone_goes_through_the_skin_of_another_limb():
    """A hand in a thigh: where its last bone ends, short of its own skin or out of it, makes no jump."""
    hand = limb(2, translation([2.0, 0.0, 0.0]) @ rotation([0.0, 0.0, 1.0], np.pi / 2) @ translation([-4.2, 0.0, 0.0]))
    both = together(limb(3, np.eye(4)), hand)
    count = 33 * 12

    def weights(tip: float):
        tails = both.tails.copy()
        tails[-1] = [2.0, tip, 0.0]
        return Body(both.meshes, both.heads, tails).matrix(resolution=64)

    found = [weights(tip) for tip in np.arange(-0.6, 0.4, 0.05)]
    assert all((each[:count, 3:] == 0.0).all() for each in found)
    assert max(np.abs(b - a).max() for a, b in pairwise(found)) < 0.1


def test_shells_without_bones_take_from_what_they_touch():
    """A belt around one of two limbs that cross, and a robe around both."""
    first, second = limb(2, np.eye(4)), limb(2, translation([2, -2, 0.3]) @ rotation([0.0, 0.0, 1.0], np.pi / 2))
    limbs = together(first, second)
    belt = open_tube(rings=5, sides=12, length=0.3, radius=0.5)
    count = len(limbs.positions)
    belted = Body(
        [limbs.meshes[0].joined(belt.moved(belt.positions + np.array([0.5, 0.0, 0.0])))], limbs.heads, limbs.tails
    )
    weights = belted.matrix(resolution=96)
    assert (weights[count:, 0] > 0.95).all()
    assert np.abs(weights[:count] - limbs.matrix(resolution=96)).max() < 0.1
    robe = tube(rings=9, sides=12, length=6.0, radius=3.0)
    robed = Body([limbs.meshes[0].joined(robe.moved(robe.positions - [1.0, 0, 0]))], limbs.heads, limbs.tails)
    found = robed.weights(resolution=64)
    assert not found.is_fallback.any()


@pytest.mark.parametrize("parents", [[0, 9], [-2, 0], [0]])
def test_bad_parents_are_refused(parents: list[int]):
    with pytest.raises(turgor.TurgorError, match="bone_parents"):
        limb(2, np.eye(4)).weights(bone_parents=parents)
