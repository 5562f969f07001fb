"""Volume that added offsets take goes back where it was lost."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import turgor
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from rigs import Rig, applied, limb, random_rigid_motion, rotation, translation
from surfaces import Surface, open_tube, tube
from test_determinism import digest_in_threads, large_limb
from test_exactness import EXACT
from test_nasty_meshes import MESHES

seeds = st.integers(0, 2**32 - 1)
RADIUS = 0.5
LENGTH = 8.0
SLABS = 24
# Offsets are in single precision, and so is the correction.
SINGLE = 1e-6

Points = NDArray[np.float64]


def long_tube(rings: int = 97, sides: int = 16) -> Surface:
    return tube(rings, sides, LENGTH, RADIUS)


def boneless(surface: Surface) -> turgor.VolumeSkin:
    count = len(surface.positions)
    still = turgor.Skinning(turgor.Skeleton([], np.zeros((0, 4, 4))), np.zeros(count + 1, np.int32), [], [])
    return turgor.VolumeSkin(surface.mesh(), still)


def deformed(skin: turgor.VolumeSkin, places: Points, **options: Any) -> turgor.Frame:
    """What becomes of a skin without bones that another deformer has put there."""
    added = (places - skin.mesh.rest_positions).astype("f4")
    return skin.deform(np.zeros((0, 4, 4)), added_offsets=added, **options)


def squeezed(positions: Points, at: float, factor: float, width: float = 0.7) -> Points:
    """Across, about a place along x."""
    places = positions.copy()
    places[:, 2] *= 1.0 - (1.0 - factor) * np.exp(-(((positions[:, 0] - at) / width) ** 2))
    return places


def slab_volumes(positions: Points, rings: int = 97, sides: int = 16) -> Points:
    """Volumes between every fourth ring, their ends fans to the rings' means."""
    ring = positions.reshape(rings, sides, 3)

    def fan(i: int, o: Points) -> float:
        corners = ring[i] - o
        return float(np.sum(np.cross(corners, np.roll(corners, -1, 0)) @ corners.mean(0)) / 6.0)

    volumes = []
    step = (rings - 1) // SLABS
    for first in range(0, rings - 1, step):
        o = ring[first : first + step + 1].reshape(-1, 3).mean(0)
        sides_of = 0.0
        for i in range(first, first + step):
            a, b = ring[i] - o, ring[i + 1] - o
            corners = np.stack([a, np.roll(a, -1, 0), np.roll(b, -1, 0), b], 1)
            area = np.cross(corners, np.roll(corners, -1, 1)).sum(1)
            sides_of += float(np.sum(area * corners.mean(1)) / 6.0)
        volumes.append(sides_of - fan(first, o) + fan(first + step, o))
    return np.abs(np.array(volumes))


def slab_errors(positions: Points, rest: Points) -> Points:
    return slab_volumes(positions) / slab_volumes(rest) - 1.0


def assert_exact(surface: Surface, positions: Points, exact: float = 10 * EXACT) -> None:
    wanted = surface.mesh().component_volumes(surface.positions)
    assert surface.mesh().component_volumes(positions) == pytest.approx(wanted, rel=exact, abs=0.0)


@given(st.floats(2.0, 6.0), st.floats(0.5, 0.8))
def test_a_squeeze_is_given_back_where_it_was(at: float, factor: float):
    """Two radii from where the squeeze ends nothing is left of it; given back by the whole skin, all of it would."""
    surface = long_tube()
    places = squeezed(surface.positions, at, factor)
    frame = deformed(boneless(surface), places)
    assert_exact(surface, frame.positions)
    before, after = (np.abs(slab_errors(p, surface.positions)) for p in (places, frame.positions))
    assert after.max() <= 0.35 * before.max()
    middles = (np.arange(SLABS) + 0.5) * LENGTH / SLABS
    assert after[np.abs(middles - at) > 1.4 + 2.0 * RADIUS].max() <= 0.01 * before.max()


def test_what_one_place_gains_another_does_not_have_to_lose():
    """No volume is missing in all, and yet both are put right."""
    surface = long_tube()
    places = squeezed(squeezed(surface.positions, 2.0, 0.6), 6.0, 1.41)
    frame = deformed(boneless(surface), places)
    assert_exact(surface, frame.positions)
    before, after = (np.abs(slab_errors(p, surface.positions)) for p in (places, frame.positions))
    assert after.max() <= 0.3 * before.max()


def test_a_squeeze_of_a_bent_limb_leaves_its_joint_alone():
    rig = limb(bone_count=2, rings=97, sides=16)
    rig = Rig(
        rig.surface.moved(rig.surface.positions * [2.0, 1.0, 1.0]),
        rig.parents,
        rig.rest_matrices,
        rig.bones,
        rig.weights,
    )
    rest = np.array([np.eye(4), translation([4.0, 0.0, 0.0])])
    rig = Rig(rig.surface, rig.parents, rest, rig.bones, rig.weights)
    skin = rig.body()
    turn = translation([4.0, 0.0, 0.0]) @ rotation([0.0, 0.0, 1.0], 1.2) @ translation([-4.0, 0.0, 0.0])
    pose = np.array([np.eye(4), turn])
    plain = skin.deform(pose)
    places = squeezed(rig.surface.positions, 1.5, 0.6)
    skinned = rig.skinning().deform(places, pose)
    frame = skin.deform(pose, added_offsets=(skinned - plain.skinned).astype("f4"))
    assert_exact(rig.surface, frame.positions)
    squeeze, joint = rig.surface.positions[:, 0] < 2.5, np.abs(rig.surface.positions[:, 0] - 4.0) < 0.7
    moved = np.linalg.norm(frame.positions - plain.positions, axis=1)
    assert moved[joint].max() <= 0.02 * moved[squeeze].max()
    errors = [np.abs(slab_errors(p, rig.surface.positions))[1:8].max() for p in (skinned, frame.positions)]
    assert errors[1] <= 0.5 * errors[0]


@given(seeds)
def test_moving_rigidly_lends_nothing(seed: int):
    surface = long_tube()
    move = random_rigid_motion(np.random.default_rng(seed))
    frame = deformed(boneless(surface), applied(move, surface.positions))
    assert np.abs(frame.offsets).max() <= 10 * SINGLE * RADIUS


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_a_part_that_moves_as_a_whole_lends_nothing(shift: float, turn: float):
    """Skin is moved only where the part is torn from the rest, as far as cells see."""
    surface = long_tube()
    x = surface.positions[:, 0]
    smooth = np.clip((x - 3.5) / 1.0, 0.0, 1.0)[:, None]
    smooth = smooth * smooth * (3.0 - 2.0 * smooth)
    whole = applied(translation([0.0, 0.2 * shift, 0.0]) @ rotation([1.0, 0.0, 0.0], turn), surface.positions)
    places = surface.positions + smooth * (whole - surface.positions)
    frame = deformed(boneless(surface), places)
    assert_exact(surface, frame.positions)
    far = np.abs(x - 4.0) > 0.5 + 4.0 * RADIUS
    offsets = np.linalg.norm(frame.offsets, axis=1)
    assert offsets[far].max() <= 0.01 * offsets.max() + 10 * SINGLE


@settings(max_examples=15)
@given(seeds, st.booleans())
def test_the_order_of_vertices_and_faces_does_not_matter(seed: int, is_rough: bool):
    rng = np.random.default_rng(seed)
    surface = long_tube(49, 12)
    if is_rough:
        surface = surface.roughened(rng, 0.02)
    places = squeezed(surface.positions, 3.0, 0.6)
    order = rng.permutation(len(places))
    place_of = np.argsort(order)
    faces = [[int(place_of[corner]) for corner in surface.faces[face]] for face in rng.permutation(len(surface.faces))]
    shuffled = Surface(surface.positions[order], [np.roll(face, rng.integers(0, len(face))).tolist() for face in faces])
    plain = deformed(boneless(surface), places)
    other = deformed(boneless(shuffled), places[order])
    assert np.abs(other.positions - plain.positions[order]).max() <= 10 * SINGLE


@settings(max_examples=15)
@given(seeds)
def test_a_mirrored_body_is_corrected_as_its_image(seed: int):
    rng = np.random.default_rng(seed)
    surface = long_tube(49, 12)
    places = squeezed(surface.positions, 3.0, 0.6) + 0.1 * np.sin(surface.positions @ rng.normal(size=(3, 3)))
    mirror = np.array([-1.0, 1.0, 1.0])
    image = surface.moved(surface.positions * mirror).reversed()
    plain, other = deformed(boneless(surface), places), deformed(boneless(image), places * mirror)
    assert np.abs(other.positions * mirror - plain.positions).max() <= 10 * SINGLE


@settings(max_examples=15)
@given(seeds)
def test_a_little_more_moves_the_skin_a_little_more(seed: int):
    rng = np.random.default_rng(seed)
    surface = long_tube(49, 12)
    skin = boneless(surface)
    places = squeezed(surface.positions, 3.0, 0.6)
    direction = np.sin(surface.positions @ rng.normal(size=(3, 3)) + rng.uniform(0.0, 6.0, 3))
    plain = deformed(skin, places).positions
    for step in (1e-2, 1e-3, 1e-4):
        assert np.abs(deformed(skin, places + step * direction).positions - plain).max() <= 10.0 * step


@pytest.mark.parametrize("size", [1e-9, 1e-4, 1e4, 1e9])
def test_the_unit_of_length_does_not_matter(size: float):
    surface = long_tube(49, 12)
    places = squeezed(surface.positions, 3.0, 0.6)
    plain = deformed(boneless(surface), places).positions
    scaled = surface.moved(surface.positions * size)
    frame = deformed(boneless(scaled), places * size)
    assert np.abs(frame.positions / size - plain).max() <= 10 * SINGLE
    assert_exact(scaled, frame.positions)


@given(seeds)
def test_every_shell_gives_back_its_own(seed: int):
    """Open ones too; a shell to which nothing is done stays, though it lies inside of the other."""
    rng = np.random.default_rng(seed)
    outer, inner = open_tube(49, 12, LENGTH, RADIUS), tube(49, 8, LENGTH, 0.2)
    surface = outer.joined(inner)
    places = surface.positions.copy()
    count = len(outer.positions)
    places[:count] = squeezed(outer.positions, rng.uniform(2.0, 6.0), rng.uniform(0.5, 0.8))
    frame = deformed(boneless(surface), places)
    assert_exact(surface, frame.positions)
    assert np.abs(frame.offsets[count:]).max() <= SINGLE
    assert np.abs(frame.offsets[:count]).max() > 0.01


@settings(max_examples=60, deadline=None)
@given(seeds, st.sampled_from(sorted(MESHES)), st.sampled_from([1e-3, 0.1, 10.0]))
def test_nothing_breaks_on_anything(seed: int, name: str, amount: float):
    rng = np.random.default_rng(seed)
    surface = MESHES[name]
    skin = boneless(surface)
    size = float(np.ptp(surface.positions, axis=0).max(initial=0.0)) if len(surface.positions) else 1.0
    places = surface.positions + amount * size * rng.normal(size=surface.positions.shape)
    frame = deformed(skin, places, repair_folds=bool(rng.random() < 0.3))
    assert np.isfinite(frame.positions).all()
    flat = deformed(skin, places * [1.0, 1.0, 0.0])
    assert np.isfinite(flat.positions).all()


@given(seeds)
def test_what_is_pinned_stays(seed: int):
    rng = np.random.default_rng(seed)
    surface = long_tube(49, 12)
    mask = np.where(rng.random(len(surface.positions)) < 0.3, 0.0, rng.random(len(surface.positions))).astype("f4")
    frame = deformed(boneless(surface).with_mask(mask), squeezed(surface.positions, 3.0, 0.6))
    assert not frame.offsets[mask == 0.0].any()
    assert_exact(surface, frame.positions)


def test_thin_parts_side_by_side_do_not_lend_each_other():
    """Fingers nearer to each other than they are thick, one body: a tube bent double."""
    sides, rings = 12, 121
    straight = tube(rings, sides, 12.0, 0.3)
    x, across = straight.positions[:, 0], straight.positions[:, 1:]
    bend = 0.4
    angle = np.clip((x - 5.0) / 2.0, 0.0, 1.0) * np.pi
    along = np.where(x < 5.0, x, np.where(x > 7.0, 12.0 - x, 5.0 + bend * np.sin(angle)))
    aside = bend * (1.0 - np.cos(angle))
    normal = np.stack([-np.sin(angle), np.cos(angle)], 1)
    positions = np.stack([along, aside, np.zeros_like(x)], 1)
    positions[:, :2] += normal * across[:, :1]
    positions[:, 2] = across[:, 1]
    surface = straight.moved(positions)
    # The gap between both legs is a third of their thickness; one of them is squeezed.
    places = positions.copy()
    leg = np.exp(-(((x - 2.5) / 0.6) ** 2))
    places[:, 2] *= 1.0 - 0.4 * leg
    frame = deformed(boneless(surface), places)
    assert_exact(surface, frame.positions)
    moved = np.linalg.norm(frame.offsets, axis=1)
    assert moved[x > 7.5].max() <= 0.02 * moved[x < 4.5].max()


def digest_of_added_offsets() -> str:
    """What the subprocess prints: the digest of poses with offsets and bodies of their own."""
    import hashlib

    rig = large_limb()
    rng = np.random.default_rng(5)
    digest = hashlib.sha256()
    skin = rig.body()
    for _ in range(3):
        waves = rng.normal(size=(3, 3))
        added = (0.1 * np.sin(rig.surface.positions @ waves)).astype("f4")
        body = (rig.surface.positions * rng.uniform(0.8, 1.2, 3)).astype("f4")
        digest.update(
            skin.deform(rig.random_pose(rng, 0.5), added_offsets=added, rest_positions=body).positions.tobytes()
        )
    return digest.hexdigest()


def test_number_of_threads_does_not_matter():
    of = "test_local_losses.digest_of_added_offsets"
    assert digest_in_threads(1, of) == digest_in_threads(2, of) == digest_in_threads(3, of)
