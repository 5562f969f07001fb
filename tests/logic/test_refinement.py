"""Refinement: nothing where nothing is asked for, more where less is asked for, no cracks, and the same surface."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from patchworks import (
    NO_CREASES,
    TUBE_RADIUS,
    Patchwork,
    bend_at_edges,
    distance_to_torus,
    edge_balance,
    patchwork,
    seeds,
    torus,
    volume,
)

from addon.logic import refined_levels
from addon.logic.polygons import Faces
from addon.logic.refinement import Refinement, Surface, refine

levels = st.integers(1, 3)


def chosen(made: Patchwork, seed: int, most: int, part: float = 0.3) -> Refinement:
    rng = np.random.default_rng(seed)
    count = len(made.faces.counts)
    asked = np.where(rng.random(count) < part, rng.integers(1, most + 1, count), 0)
    return refine(made.surface, refined_levels.balanced(made.faces, asked, made.points))


def places(positions: np.ndarray) -> np.ndarray:
    _, first, same = np.unique(positions.round(9), axis=0, return_index=True, return_inverse=True)
    return first[same.ravel()]


@given(seeds, levels)
def test_watertight_stays_watertight(seed: int, most: int):
    made = patchwork(seed)
    found = chosen(made, seed, most)
    positions = found.vertices(made.positions)
    assert set(edge_balance(made.faces, made.points).values()) == {0}
    balance = edge_balance(found.faces, places(positions))
    assert set(balance.values()) == {0}
    assert not any(a == b for a, b in balance)
    # The seam has left some vertices without faces.
    loose = set(range(len(made.positions))) - set(made.faces.corners.tolist())
    assert set(found.faces.corners.tolist()) | loose == set(range(found.vertex_count)) == set(range(len(positions)))


@given(seeds, levels)
def test_new_faces_have_few_corners(seed: int, most: int):
    """Quads all over where levels are, triangles and quads beside them, none of more."""
    made = patchwork(seed)
    found = chosen(made, seed, most)
    counts, parents = found.faces.counts, found.parents
    assert (counts[found.is_new] <= 4).all()
    # Where all faces around have the same level.
    low, high = np.full(len(made.positions), 9), np.zeros(len(made.positions), int)
    of_corners = found.levels[made.faces.of_corners]
    np.minimum.at(low, made.points[made.faces.corners], of_corners)
    np.maximum.at(high, made.points[made.faces.corners], of_corners)
    is_same = -made.faces.most(-(low == high)[made.points[made.faces.corners]].astype(int)) == 1
    assert (counts[(is_same & (found.levels > 0))[parents]] == 4).all()


@given(seeds, levels)
def test_flat_faces_keep_their_surface(seed: int, most: int):
    """Each face's children cover it once: the same area, the same side, and no other place."""
    made = patchwork(seed, roughness=0.0)
    found = chosen(made, seed, most)
    positions = found.vertices(made.positions)
    assert volume(positions, found.faces) == pytest.approx(volume(made.positions, made.faces), rel=1e-13)

    def areas(points: np.ndarray, faces: Faces) -> np.ndarray:
        around = points[faces.corners]
        return 0.5 * faces.means(np.cross(around, around[faces.following])) * faces.counts[:, None]

    sums = np.zeros((len(made.faces.counts), 3))
    np.add.at(sums, found.parents, areas(positions, found.faces))
    np.testing.assert_allclose(sums, areas(made.positions, made.faces), atol=1e-13)
    # None is turned over: sizes add up too.
    sizes = np.zeros(len(sums))
    np.add.at(sizes, found.parents, np.linalg.norm(areas(positions, found.faces), axis=1))
    np.testing.assert_allclose(sizes, np.linalg.norm(sums, axis=1), rtol=1e-12)


@given(seeds, levels)
def test_quads_split_all_over_keep_their_bilinear_surface(seed: int, most: int):
    """Even where no quad is flat: the volume is the same to rounding."""
    rng = np.random.default_rng(seed)
    cube = patchwork(seed).positions[-8:]
    made = Patchwork(
        cube + rng.uniform(-0.3, 0.3, cube.shape),
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
    )
    found = refine(made.surface, np.full(6, most))
    assert len(found.faces.counts) == 6 * 4**most
    assert volume(found.vertices(made.positions), found.faces) == pytest.approx(
        volume(made.positions, made.faces), rel=1e-13
    )


@given(seeds, levels)
def test_new_vertices_lie_on_the_old_surface(seed: int, most: int):
    """On the bilinear patch of each quad, flat or not, also where it is only cut beside others that are split."""
    made = patchwork(seed, roughness=0.2)
    found = chosen(made, seed, most)
    is_quad = made.faces.counts == 4
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    within = np.arange(len(made.faces.corners)) - made.faces.offsets[made.faces.of_corners]
    u, v = found.corners(square[within % 4]).T
    parents = found.parents[found.faces.of_corners]
    chosen_corners = is_quad[parents]
    u, v, parents = (row[chosen_corners] for row in (u, v, parents))
    a, b, c, d = (made.positions[made.faces.corners[made.faces.offsets[parents] + corner]].T for corner in range(4))
    patch = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    places = found.vertices(made.positions)[found.faces.corners[chosen_corners]]
    np.testing.assert_allclose(places, patch.T, atol=1e-13)


@given(seeds)
def test_nothing_asked_for_is_nothing_done(seed: int):
    made = patchwork(seed)
    gamma = np.random.default_rng(seed).random(len(made.positions))
    asked = refined_levels.wanted_levels(
        made.faces, made.positions, gamma, np.zeros(len(gamma)), np.inf, 3, is_automatic=False
    )
    found = refine(made.surface, refined_levels.balanced(made.faces, asked, made.points))
    assert found.face_count == 0
    assert found.faces is made.faces
    assert np.array_equal(found.vertices(made.positions), made.positions)
    assert np.array_equal(found.smoothed(made.positions, keeps_vertices=False), made.positions)


@given(seeds, st.floats(0.0, 1.0), st.floats(0.0, 1.0), levels, st.booleans())
def test_a_lower_threshold_refines_more(seed: int, one: float, other: float, most: int, is_automatic: bool):
    made = patchwork(seed)
    rng = np.random.default_rng(seed)
    gamma, lengths = rng.random(len(made.positions)) ** 3, rng.uniform(0.05, 2.0, len(made.positions))
    low, high = (
        refined_levels.balanced(
            made.faces,
            refined_levels.wanted_levels(
                made.faces, made.positions, gamma, lengths, threshold, most, is_automatic=is_automatic
            ),
            made.points,
        )
        for threshold in sorted((one, other))
    )
    assert (low >= high).all()


@given(seeds)
def test_automatic_levels_make_edges_as_short_as_asked(seed: int):
    made = patchwork(seed, roughness=0.0, has_seam=False)
    gamma, lengths = np.ones(len(made.positions)), np.full(len(made.positions), 0.3)
    asked = refined_levels.wanted_levels(made.faces, made.positions, gamma, lengths, 0.5, 4, is_automatic=True)
    ends = made.positions[made.faces.corners], made.positions[made.faces.corners[made.faces.following]]
    longest = made.faces.most(np.linalg.norm(ends[1] - ends[0], axis=1))
    assert (longest / 2.0**asked <= 0.3 + 1e-9).all()
    assert (longest / 2.0 ** (asked - 1) > 0.3)[asked > 0].all()


@given(seeds, levels)
def test_values_lie_between_what_they_come_from(seed: int, most: int):
    """What is linear in the place stays so, what sums to one does; old vertices keep theirs to the last bit."""
    made = patchwork(seed)
    found = chosen(made, seed, most)
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet(np.ones(3), len(made.positions))
    new = found.vertices(weights)
    assert np.array_equal(new[: len(weights)], weights)
    np.testing.assert_allclose(new.sum(axis=1), 1.0, atol=1e-14)
    assert (new >= 0.0).all()
    of_corners = found.corners(made.positions[made.faces.corners])
    np.testing.assert_allclose(of_corners, found.vertices(made.positions)[found.faces.corners], atol=1e-14)


@given(seeds, levels)
def test_corners_on_both_sides_of_a_seam_stay_apart(seed: int, most: int):
    """What a face says at its corners is what its children say, whatever its neighbours do."""
    made = patchwork(seed, has_seam=False)
    found = chosen(made, seed, most)
    own = np.random.default_rng(seed).random(len(made.faces.counts))
    values = found.corners(own[made.faces.of_corners])
    np.testing.assert_allclose(values, own[found.parents][found.faces.of_corners], atol=1e-15)


@given(seeds, levels)
def test_faces_that_ask_for_nothing_are_cut_only_where_neighbours_are_split(seed: int, most: int):
    made = patchwork(seed)
    found = chosen(made, seed, most, part=0.1)
    is_touched = np.zeros(len(made.positions), bool)
    is_touched[made.points[made.faces.corners[found.levels[made.faces.of_corners] > 0]]] = True
    for face in np.flatnonzero(found.levels == 0):
        corners = made.faces.corners[made.faces.offsets[face] : made.faces.offsets[face + 1]]
        if not is_touched[made.points[corners]].any():
            (child,) = np.flatnonzero(found.parents == face)
            start, stop = found.faces.offsets[child : child + 2]
            assert np.array_equal(found.faces.corners[start:stop], corners)


@given(seeds, levels, st.booleans())
def test_seams_do_not_open_when_smoothed(seed: int, most: int, keeps_vertices: bool):
    made = patchwork(seed)
    found = chosen(made, seed, most)
    smooth = found.smoothed(made.positions, keeps_vertices=keeps_vertices)
    assert set(edge_balance(found.faces, places(smooth)).values()) == {0}


@given(seeds, levels)
def test_smooth_goes_through_all_vertices(seed: int, most: int):
    """Split or not: what was there stays to the last bit, as does what is made of it later."""
    made = patchwork(seed)
    found = chosen(made, seed, most)
    smooth = found.smoothed(made.positions, keeps_vertices=True)
    assert np.array_equal(smooth[: len(made.positions)], made.positions)
    count = len(made.positions) + len(found.splits[0].edge_ends) + len(found.splits[0].centred) if found.splits else 0
    fewer = Refinement(
        found.surface,
        found.levels,
        found.splits[:1],
        found.points[:1],
        found.parents,
        found.is_new,
        found.corner_origins,
    )
    assert np.array_equal(smooth[:count], fewer.smoothed(made.positions, keeps_vertices=True)[:count])


@given(seeds, levels)
def test_the_border_of_what_is_refined_does_not_show_when_smooth(seed: int, most: int):
    """On a torus: all vertices are as near to it, also at the border, and no edge is sharper than there were."""
    made = torus(rings=16, sides=10)
    found = chosen(made, seed, most, part=0.1)
    smooth = found.smoothed(made.positions, keeps_vertices=True)
    # Chords of ten sides miss 5 % of the radius.
    assert np.abs(distance_to_torus(smooth)).max() < 0.01 * TUBE_RADIUS
    assert bend_at_edges(smooth, found.faces).max() < bend_at_edges(made.positions, made.faces).max() + 1e-9


@given(seeds, levels)
def test_only_faces_with_levels_move_when_smoothed(seed: int, most: int):
    made = patchwork(seed)
    found = chosen(made, seed, most, part=0.1)
    moves = np.zeros(len(made.positions), bool)
    moves[made.points[made.faces.corners[found.levels[made.faces.of_corners] > 0]]] = True
    still = ~moves[made.points]
    smooth = found.smoothed(made.positions, keeps_vertices=False)
    assert np.array_equal(smooth[: len(still)][still], made.positions[still])


@given(seeds, levels, st.booleans())
def test_a_part_is_smoothed_as_the_whole_would_be(seed: int, most: int, keeps_vertices: bool):
    """Vertices of faces of n levels are where n levels of the whole mesh have them."""
    made = patchwork(seed, has_seam=False)
    found = chosen(made, seed, most, part=0.2)
    smooth = found.smoothed(made.positions, keeps_vertices=keeps_vertices)
    of_corners = found.levels[found.parents][found.faces.of_corners]
    lowest, highest = np.full(found.vertex_count, 9), np.zeros(found.vertex_count, int)
    np.minimum.at(lowest, found.faces.corners, of_corners)
    np.maximum.at(highest, found.faces.corners, of_corners)
    count = len(made.positions)
    for level, split in enumerate(found.splits, 1):
        count += len(split.edge_ends) + len(split.centred)
        inner = (np.arange(found.vertex_count) < count) & (lowest == level) & (highest == level)
        whole = refine(made.surface, np.full(len(found.levels), level))
        everywhere = whole.smoothed(made.positions, keeps_vertices=keeps_vertices)
        distances = np.linalg.norm(smooth[inner][:, None] - everywhere, axis=2)
        assert distances.min(axis=1, initial=9.0).max(initial=0.0) < 1e-12


def test_loose_vertices_and_no_faces_at_all():
    empty = Faces(np.zeros(1, np.int32), np.zeros(0, np.int32))
    found = refine(Surface(empty, np.arange(5), NO_CREASES), np.zeros(0, np.int32))
    positions = np.arange(15.0).reshape(5, 3)
    assert np.array_equal(found.vertices(positions), positions)
    assert not len(refined_levels.balanced(empty, np.zeros(0, np.int32), np.arange(5)))
