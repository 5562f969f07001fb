"""Automatic weights: laws that hold for any body."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import turgor
from bodies import Body, arrays_of, bones, box, dense, drawn, limb_bones, mouth
from rigs import applied, random_rigid_motion
from surfaces import Surface, cube, open_tube, strip, tube

LIMB_BONES = 4


def limb(surface: Surface | None = None) -> Body:
    return Body([surface or tube(rings=41, sides=16)], *limb_bones(LIMB_BONES))


def torn(seed: int = 3) -> Surface:
    """A tube with holes, turned, doubled and collapsed faces, and points that no face uses."""
    rng = np.random.default_rng(seed)
    whole = tube(rings=31, sides=12).roughened(rng, 0.01)
    faces = [list(face) for face in whole.faces if rng.random() > 0.1]
    faces = [face[::-1] if rng.random() < 0.2 else face for face in faces]
    faces += faces[:20]
    faces += [[0, 0, 1], [5, 5, 5], [7, 8, 7]]
    return Surface(np.vstack([whole.positions, [[1.0, 3.0, 0.0], [9.0, 9.0, 9.0]]]), faces)


def two_sheets() -> Surface:
    """Two flat strips that cross, no inside."""
    flat = strip(12)
    return flat.joined(flat.moved(flat.positions[:, [0, 2, 1]] + [0.0, 0.5, -0.5]))


BODIES = {
    "closed": limb(),
    "open": limb(open_tube(rings=41, sides=16)),
    "inverted": limb(tube(rings=41, sides=16).reversed()),
    "split apart": limb(tube(rings=21, sides=12).split_apart()),
    "torn": limb(torn()),
    "flat": limb(strip(12)),
    "crossing sheets": limb(two_sheets()),
    "bones outside": Body([tube()], *bones([[0.0, 5.0, 0.0], [4.0, 5.0, 0.0], [4.0, 9.0, 0.0]])),
    "one bone": Body([tube()], *limb_bones(1)),
    "bone of no length": Body([tube()], *bones([[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [4.0, 0.0, 0.0]])),
    "same bone twice": Body([tube()], *bones([[0.0, 0, 0], [2.0, 0, 0]], [[0.0, 0, 0], [2.0, 0, 0], [4.0, 0, 0]])),
    "one cube": Body([cube()], *limb_bones(2, 1.0)),
    "loose points": Body([Surface(np.eye(3), [])], *limb_bones(2)),
    "no vertex": Body([Surface(np.zeros((0, 3)), [])], *limb_bones(2)),
    "all in one point": Body([Surface(np.ones((4, 3)), [[0, 1, 2], [1, 2, 3]])], *limb_bones(2)),
    "mouth": mouth(),
}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("max_influences", [1, 4, None])
def test_every_vertex_has_weights_that_sum_to_one(name: str, max_influences: int | None):
    body = BODIES[name]
    found = body.weights(max_influences=max_influences)
    counts = np.diff(found.offsets)
    assert len(counts) == len(body.positions)
    assert (counts >= 1).all()
    assert (counts <= (max_influences or len(body.heads))).all()
    assert (found.weights > 0.0).all()
    np.testing.assert_allclose(dense(found, len(body.heads)).sum(axis=1), 1.0, atol=1e-12)


@pytest.mark.parametrize("name", ["open", "inverted", "split apart"])
def test_how_the_surface_is_stored_hardly_matters(name: str):
    """The same limb, without its ends, inside out or with every face apart, gets the weights of the closed one."""
    body = BODIES[name]
    whole = limb(tube(rings=21, sides=12)) if name == "split apart" else limb()
    nearest = np.linalg.norm(body.positions[:, None] - whole.positions[None], axis=2).argmin(axis=1)
    inner = (body.positions[:, 0] > 0.5) & (body.positions[:, 0] < 3.5)
    np.testing.assert_allclose(body.matrix()[inner], whole.matrix()[nearest][inner], atol=0.02)


def test_weights_of_a_limb_follow_its_bones():
    body = limb()
    weights = body.matrix()
    x = body.positions[:, 0]
    for bone in range(LIMB_BONES):
        middle = np.abs(x - (bone + 0.5)) < 0.11
        assert (weights[middle].argmax(axis=1) == bone).all()
        # Along the limb a bone's weight rises to its middle and falls after it.
        means = np.array([weights[x == value, bone].mean() for value in np.unique(x)])
        top = means.argmax()
        assert (np.diff(means[: top + 1]) > -1e-3).all()
        assert (np.diff(means[top:]) < 1e-3).all()


def test_weights_change_little_between_neighbours():
    """Steps along the limb are a few times the step of an ideal ramp, whatever the voxels do."""
    body = limb(tube(rings=161, sides=24))
    for resolution in (64, 128, None):
        weights = body.matrix(resolution=resolution)[: 161 * 24].reshape(161, 24, -1)
        assert np.abs(np.diff(weights, axis=0)).max() < 0.08
        assert np.abs(np.diff(weights, axis=1)).max() < 0.04


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_unit_of_length_does_not_matter(scale: float):
    for body in (limb(), mouth()):
        np.testing.assert_allclose(body.moved(lambda p: p * scale).matrix(), body.matrix(), atol=1e-6)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_mirrored_bodies_have_mirrored_weights(axis: int):
    flip = np.ones(3)
    flip[axis] = -1.0
    for body in (limb(), limb(torn()), mouth()):
        mirrored = body.moved(lambda p: p * flip)
        np.testing.assert_allclose(mirrored.matrix(), body.matrix(), atol=1e-6)


def test_moved_bodies_have_the_same_weights_to_voxel_accuracy():
    rng = np.random.default_rng(5)
    for body in (limb(), mouth()):
        weights = body.matrix(resolution=128, max_influences=None)
        for _ in range(3):
            move = random_rigid_motion(rng)
            moved = body.moved(lambda p, move=move: applied(move, p))
            error = np.abs(moved.matrix(resolution=128, max_influences=None) - weights)
            assert error.max() < 0.15
            assert error.mean() < 0.01


def test_weights_converge_with_the_voxels():
    """Errors are below a bound that falls as the voxels do."""
    for body in (limb(tube(rings=41, sides=24)), mouth()):
        reference = body.matrix(resolution=192, max_influences=None)
        for resolution in (24, 48, 96):
            error = np.abs(body.matrix(resolution=resolution, max_influences=None) - reference).mean()
            assert error < 0.03 / resolution


def test_skin_of_a_trunk_belongs_to_the_trunk_between_its_legs():
    """A barrel on two legs: the skin under its middle is nearer to their bones than to its own."""
    outline = [(-1.0, -1.0), (-0.4, -1.0), (-0.4, 0.0), (0.4, 0.0), (0.4, -1.0), (1.0, -1.0), (1.0, 1.8), (-1.0, 1.8)]
    body = Body(
        [drawn(outline, np.linspace(-0.9, 0.9, 19))],
        *bones(
            [[-1.0, 0.9, 0.0], [1.0, 0.9, 0.0]],
            [[-0.7, 0.2, 0.0], [-0.7, -1.0, 0.0]],
            [[0.7, 0.2, 0.0], [0.7, -1.0, 0.0]],
        ),
    )
    weights = body.matrix()
    x, y, z = body.positions.T
    under = (np.abs(x) < 0.01) & (np.abs(y) < 1e-9) & (np.abs(z) < 0.75)
    assert under.any()
    assert (weights[under, 0] > 1.5 * weights[under, 1:].max(axis=1)).all()
    assert (weights[y < -0.7, 0] < 0.1).all()


def digest() -> str:
    """What the subprocess prints."""
    import hashlib

    found = [body.weights() for body in (limb(), mouth(), limb(torn()))]
    return hashlib.sha256(
        b"".join(f.offsets.tobytes() + f.bones.tobytes() + f.weights.tobytes() for f in found)
    ).hexdigest()


def test_number_of_threads_does_not_matter():
    def in_threads(count: int) -> str:
        environment = {**os.environ, "RAYON_NUM_THREADS": str(count)}
        command = [sys.executable, "-c", "import test_weights_by_distance as t; print(t.digest())"]
        here = Path(__file__).parent
        return subprocess.run(command, cwd=here, env=environment, check=True, capture_output=True, text=True).stdout

    assert in_threads(1) == in_threads(2) == in_threads(5)


def test_tongue_belongs_to_the_jaw():
    """Its tip is nearer to the skull's bone than to the jaw's by the straight way, and touches the palate nearly."""
    body = mouth()
    weights = body.matrix()
    x, y = body.positions[:, 0], body.positions[:, 1]
    tip = (x > 2.8) & (x < 3.05) & (np.abs(y + 0.08) < 1e-9)
    palate = (x > 2.5) & (np.abs(y - 0.08) < 1e-9)
    skull, jaw = weights[:, [0, 1]].sum(axis=1), weights[:, [2, 3]].sum(axis=1)
    assert tip.any()
    assert (jaw[tip] > 0.95).all()
    assert (skull[palate] > 0.95).all()


@pytest.mark.parametrize("turn", [0.0, 0.3, np.pi / 4])
def test_gap_of_two_voxels_separates(turn: float):
    """Two slabs side by side, each with its bone: no weight crosses the gap."""
    size = 4.0 / 100
    lower = box([0.0, -1.0, 0.0], [4.0, -1.05 * size, 1.0], 10)
    upper = box([0.0, 1.05 * size, 0.0], [4.0, 1.0, 1.0], 10)
    ends = bones([[0.5, -0.5, 0.5], [3.5, -0.5, 0.5]], [[0.5, 0.5, 0.5], [3.5, 0.5, 0.5]])
    turned = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    body = Body([lower.joined(upper)], *ends).moved(lambda p: p @ turned.T)
    longest = np.ptp(body.positions, axis=0).max()
    weights = body.matrix(resolution=int(np.ceil(longest / size)))
    below = np.arange(len(body.positions)) < len(lower.positions)
    assert (weights[below, 0] == 1.0).all()
    assert (weights[~below, 1] == 1.0).all()


def test_shells_that_no_bone_reaches_are_reported_and_follow_the_nearest():
    button = box([1.0, 0.8, -0.1], [1.2, 0.9, 0.1], 3)
    far = box([30.0, 0.0, 0.0], [31.0, 1.0, 1.0], 2)
    limb_surface = tube(rings=41, sides=16)
    body = Body([limb_surface.joined(button).joined(far)], *limb_bones(LIMB_BONES))
    found = body.weights()
    count = len(limb_surface.positions)
    assert not found.is_fallback[:count].any()
    assert found.is_fallback[count:].all()
    weights = dense(found, LIMB_BONES)
    near = np.linalg.norm(limb_surface.positions - [1.1, 0.5, 0.0], axis=1).argmin()
    np.testing.assert_allclose(weights[count : count + len(button.positions)].mean(axis=0), weights[near], atol=0.1)
    assert (weights[count + len(button.positions) :].argmax(axis=1) == LIMB_BONES - 1).all()


def test_stray_shells_far_away_take_no_voxels_from_the_body():
    stray = Surface(np.array([[900.0, 0.0, 0.0], [901.0, 0.0, 0.0], [900.0, 1.0, 0.0]]), [[0, 1, 2]])
    body = Body([tube(rings=41, sides=16).joined(stray)], *limb_bones(LIMB_BONES))
    np.testing.assert_allclose(body.matrix()[:-3], limb().matrix(), atol=1e-6)


def test_points_of_clothes_take_from_the_body():
    shirt = open_tube(rings=41, sides=16, radius=0.6)
    body = Body([tube(rings=41, sides=16), shirt], *limb_bones(LIMB_BONES))
    for is_solid in ([True, True], [True, False]):
        found = body.weights(is_solid=is_solid)
        assert not found.is_fallback.any()
        assert found.vertex_starts.tolist() == [0, len(body.meshes[0].positions), len(body.positions)]
        weights = dense(found, LIMB_BONES)
        skin, cloth = np.split(weights, [found.vertex_starts[1]])
        assert np.abs(skin[: len(cloth)] - cloth).max() < 0.15


def test_locked_bones_keep_their_weights_and_the_rest_share_what_is_left():
    body = limb()
    rng = np.random.default_rng(2)
    count = len(body.positions)
    kept = np.zeros((count, LIMB_BONES))
    kept[:, 1] = np.where(rng.random(count) < 0.5, rng.random(count), 0.0)
    kept[:, 2] = 0.3
    kept[:5, 1] = 1.0
    rows = (np.arange(0, count * 4 + 1, 4), np.tile(np.arange(4), count), kept.ravel())
    locked = np.array([False, True, False, False])
    weights = body.matrix(is_locked=locked, locked_weights=rows)
    assert np.array_equal(weights[:, 1], kept[:, 1])
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-12)
    left = 1.0 - kept[:, 1]
    others = Body(body.meshes, np.delete(body.heads, 1, 0), np.delete(body.tails, 1, 0)).matrix(max_influences=None)
    free = body.matrix(is_locked=locked, locked_weights=rows, max_influences=None)
    np.testing.assert_allclose(np.delete(free, 1, axis=1), others * left[:, None], atol=1e-6)


def test_symmetry_is_exact_on_a_rough_body():
    """Both halves of a body whose points are mirrored but whose faces and bones differ get the same weights."""
    half = tube(rings=21, sides=12)
    shifted = half.moved(half.positions + np.array([0.3, 0.0, 0.0]))
    other = Surface(
        shifted.positions * [-1.0, 1.0, 1.0], [np.roll(face[::-1], 1).tolist() for face in shifted.faces[:-9]]
    )
    body = Body(
        [shifted.joined(other)],
        *bones([[0.3, 0, 0], [2.0, 0, 0], [4.3, 0.1, 0]], [[-0.3, 0, 0], [-2.0, 0, 0], [-4.3, 0.1, 0]]),
    )
    weights = body.matrix(symmetry_plane=([0, 0, 0], [2.0, 0, 0]))
    count = len(half.positions)
    assert np.array_equal(weights[:count], weights[count:][:, [2, 3, 0, 1]])
    told = body.matrix(symmetry_plane=([0, 0, 0], [2.0, 0, 0]), mirrored_bones=[2, 3, 0, 1])
    assert np.array_equal(told, weights)


def test_stiff_bones_hold_more():
    body = limb()
    plain, stiff = body.matrix(), body.matrix(stiffness=[1.0, 2.0, 1.0, 1.0])
    assert (stiff[:, 1] >= plain[:, 1] - 1e-3).all()
    assert stiff[:, 1].sum() > 1.2 * plain[:, 1].sum()
    np.testing.assert_allclose(body.matrix(stiffness=[3.0] * 4), plain, atol=1e-6)


def test_higher_falloff_is_sharper():
    body = limb()
    largest = [body.matrix(falloff=falloff).max(axis=1).mean() for falloff in (1.0, 2.0, 4.0, 8.0)]
    assert (np.diff(largest) > 0.0).all()


def test_progress_rises_to_one():
    parts: list[float] = []
    limb().weights(progress=parts.append)
    assert parts[0] == 0.0
    assert parts[-1] == 1.0
    assert (np.diff(parts) >= 0.0).all()
    assert len(parts) > 5


def test_progress_can_cancel_at_any_time():
    parts: list[float] = []
    limb().weights(progress=parts.append)
    for stop in range(len(parts)):
        left = iter(range(stop))
        with pytest.raises(turgor.CancelledError):
            limb().weights(progress=lambda _, left=left: next(left, None) is not None)


def test_errors_of_progress_come_out():
    def fail(part: float) -> bool:
        raise KeyError(part)

    with pytest.raises(KeyError):
        limb().weights(progress=fail)


MESH = arrays_of(tube())
HEADS, TAILS = limb_bones(2)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"resolution": 4}, "resolution is 4, need 8..1024"),
        ({"falloff": np.nan}, "falloff"),
        ({"smoothing": -1.0}, "smoothing"),
        ({"max_influences": 0}, "max_influences is 0, need 1 or more"),
        ({"stiffness": [1.0]}, "stiffness: found 1 values, need 2"),
        ({"stiffness": [1.0, 0.0]}, "stiffness is 0"),
        ({"is_solid": []}, "is_solid: found 0 values, need 1"),
        ({"is_locked": [True, True]}, "no bone to give weights to"),
        ({"locked_weights": ([0], [], [])}, "weight_offsets: found 1 values"),
        ({"symmetry_plane": ([0, 0, 0], [0, 0, 0])}, "normal of some length"),
        ({"symmetry_plane": ([0, 0, 0], [1, 0, 0]), "mirrored_bones": [0, 2]}, "mirrored_bones: entry 1 is 2"),
        ({"symmetry_plane": 3}, "symmetry_plane: need"),
    ],
)
def test_bad_settings_are_refused(settings: dict, message: str):
    with pytest.raises(turgor.TurgorError, match=message):
        turgor.automatic_weights([MESH], HEADS, TAILS, **settings)


def test_bad_meshes_and_bones_are_refused():
    broken = MESH[0].copy()
    broken[3, 1] = np.nan
    for meshes, heads, tails in (
        ([(broken, *MESH[1:])], HEADS, TAILS),
        ([MESH], HEADS[:1], TAILS),
        ([MESH], np.full_like(HEADS, np.inf), TAILS),
        ([MESH], HEADS[:0], TAILS[:0]),
    ):
        with pytest.raises(turgor.TurgorError):
            turgor.automatic_weights(meshes, heads, tails)
    with pytest.raises(turgor.TurgorError, match="need \\(positions, face_offsets, face_corners\\) each"):
        turgor.automatic_weights([MESH[0]], HEADS, TAILS)  # pyright: ignore[reportArgumentType]


def test_cutting_bones_in_two_hardly_changes_what_they_hold():
    whole = limb()
    parts = Body(whole.meshes, *limb_bones(2 * LIMB_BONES))
    halves = parts.matrix(max_influences=None)
    np.testing.assert_allclose(halves[:, ::2] + halves[:, 1::2], whole.matrix(max_influences=None), atol=0.03)


def test_transitions_cost_less_than_those_of_bone_heat():
    """The product does not depend on how wide a transition is: 3/16 for bone heat's, an exponential one.

    Turning a joint of a straight limb costs volume in proportion to the integral of w (1 - w) along it, and stretch to
    that of the slope squared.
    """
    rings, radius = 161, 0.5
    body = Body([tube(rings=rings, sides=24)], *limb_bones(2))
    x = np.linspace(0.0, 4.0, rings)
    w = body.matrix()[: rings * 24, 1].reshape(rings, 24).mean(axis=1)
    inner = (x > 0.5) & (x < 3.5)
    step = x[1] - x[0]
    volume = (w * (1.0 - w))[inner].sum() * step / radius
    stretch = (np.gradient(w, step) ** 2)[inner].sum() * step * radius
    assert volume < 0.36
    assert stretch < 0.525
    assert volume * stretch < 3 / 16


def test_skin_belongs_to_the_bone_that_it_wraps():
    """A limb stands out of a trunk, its bone starts inside: the trunk's side about it is the trunk's all the same."""
    trunk = box([-0.6, -2.0, -0.6], [0.6, 2.0, 0.6], 12)
    arm = box([0.5, -0.25, -0.25], [3.0, 0.25, 0.25], 12)
    ends = bones([[0.0, -2.0, 0.0], [0.0, 2.0, 0.0]], [[0.3, 0.0, 0.0], [3.0, 0.0, 0.0]])
    body = Body([trunk.joined(arm)], *ends)
    weights = body.matrix()
    x, y, _ = body.positions.T
    side = (np.abs(x - 0.6) < 1e-9) & (np.abs(y) > 0.6) & (np.arange(len(x)) < len(trunk.positions))
    assert (weights[side, 0] > 0.75).all()
    assert (weights[x > 1.2, 1] > 0.95).all()


def test_a_wall_inside_does_not_move_the_border_between_bones():
    """Faces across the flesh say nothing of which way is in: both halves of a limb stay alike."""
    rings, sides = 33, 20
    plain = tube(rings=rings, sides=sides)
    middle = rings // 2 * sides
    walled = Surface(plain.positions, [*plain.faces, list(range(middle, middle + sides))])
    w = Body([walled], *limb_bones(2)).matrix()[: rings * sides, 1].reshape(rings, sides)
    np.testing.assert_allclose(w + w[::-1], 1.0, atol=0.01)


def test_clothes_hardly_change_the_weights_of_the_skin_below():
    skin = tube(rings=41, sides=16)
    for is_solid in (True, False):
        shirt = Body([skin, open_tube(rings=41, sides=16, radius=0.6)], *limb_bones(LIMB_BONES))
        dressed = shirt.matrix(is_solid=[True, is_solid])[: len(skin.positions)]
        np.testing.assert_allclose(dressed, limb().matrix(), atol=0.02)


@pytest.mark.parametrize("corner", [(0.34, 0.33, 0.33), (0.48, 0.48, 0.04), (0.96, 0.02, 0.02), (0.8, 0.19, 0.01)])
def test_thin_triangles_on_the_same_surface_change_little(corner: tuple[float, float, float]):
    """Every triangle of a beam is cut into three about a point close to a side or a corner."""
    beam = box([0.0, -0.5, -0.5], [4.0, 0.5, 0.5], 16)
    triangles = [[face[i] for i in part] for face in beam.faces for part in ((0, 1, 2), (0, 2, 3))]
    added = [
        np.array(corner) @ beam.positions[np.roll(triangle, -number % 3)] for number, triangle in enumerate(triangles)
    ]
    count = len(beam.positions)
    cut = [
        [triangle[i], triangle[(i + 1) % 3], count + number]
        for number, triangle in enumerate(triangles)
        for i in range(3)
    ]
    ends = limb_bones(2)
    plain = Body([Surface(beam.positions, triangles)], *ends).matrix()
    found = Body([Surface(np.vstack([beam.positions, added]), cut)], *ends).matrix()
    np.testing.assert_allclose(found[:count], plain, atol=0.03)
