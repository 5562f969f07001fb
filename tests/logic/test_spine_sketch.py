"""What the overlay of a spine shows is where the engine puts it."""

from __future__ import annotations

import numpy as np
import pytest
import turgor

from addon.logic import flesh, spine_courses, spine_sketch

BONES = np.array([np.eye(4)] * 4)
BONES[:, 2, 3] = [0.0, 1.0, 2.0, 3.0]
TAIL = np.array([0.0, 0.0, 4.0])


def _body(count: int = 400) -> flesh.Flesh:
    random = np.random.default_rng(3)
    angles, heights = random.uniform(0, 2 * np.pi, count), random.uniform(0.2, 3.8, count)
    points = np.stack([0.4 * np.cos(angles), 0.4 * np.sin(angles), heights], axis=1).astype(np.float32)
    no_faces = np.zeros(1, np.int32), np.zeros(0, np.int32)
    return flesh.Flesh(points, *no_faces, np.zeros((0, count, 3), np.float32), np.ones(count), None)


def _bend(amount: float) -> tuple[flesh.Flesh, flesh.Bound, flesh.Pose]:
    body = _body()
    chain = spine_courses.chain_of(list(BONES), TAIL)
    at = spine_courses.stations(5, "joints", 0.5)
    rest = spine_courses.rest_spine(chain, at, "joints")
    heights = chain.joints[:, 2]
    bent = chain._replace(joints=np.stack([amount * (1 - np.cos(heights)), 0 * heights, heights], axis=1))
    bound = body.bind(0, lambda: rest, (0.0, 1.0), "radial", "stations", np.zeros(0, np.float32))
    spine = spine_courses.posed_spine(rest, bent, at)
    return body, bound, flesh.Pose(spine, np.zeros(spine.station_count), 0.0, True)


def test_small_chunks_keep_their_volume():
    _, bound, pose = _bend(0.4)
    found = spine_sketch.local_error(bound, pose)
    assert 0.0 < found.mean <= 1e-3
    assert found.most <= 5e-3


def test_lines_lie_on_the_spines():
    body, bound, pose = _bend(0.4)
    world = np.diag([2.0, 2.0, 2.0, 1.0])
    drawn = spine_sketch.draw(bound, pose, body.deform(bound, pose, False).offsets, world)
    assert pose.spine.closest(drawn.posed / 2.0).distances.max() <= 1e-6
    assert bound.rest.closest(drawn.rest / 2.0).distances.max() <= 1e-6
    assert len(drawn.outside) == 0
    assert len(drawn.rings) % 2 == len(drawn.normals) % 2 == 0
    assert all(np.isfinite(part).all() for part in drawn)


def test_flesh_outside_of_the_valid_space_is_shown():
    body, bound, pose = _bend(4.0)
    outcome = body.deform(bound, pose, False)
    drawn = spine_sketch.draw(bound, pose, outcome.offsets, np.eye(4))
    assert outcome.clamped_count > 0
    assert len(drawn.outside) >= outcome.clamped_count
    assert len(drawn.rings) > 0


@pytest.mark.parametrize("width", [0.1, 0.5, 0.95])
def test_bones_stay_straight_but_for_their_bends(width):
    """Along bones the spine lies on each bone where no bend reaches, and nowhere leaves the bones' hull."""
    chain = spine_courses.chain_of(list(BONES), TAIL)
    bent = chain._replace(joints=np.array([[0, 0, 0], [0, 0, 1], [0.8, 0, 1.6], [0.8, 0, 2.6], [0.8, 0.5, 3.4]], float))
    at = spine_courses.stations(5, "bones", width)
    spine = spine_courses.posed_spine(spine_courses.rest_spine(chain, at, "bones"), bent, at)
    middles = (bent.joints[:-1] + bent.joints[1:]) / 2
    assert spine.closest(middles).distances.max() <= 0.05 * width + 1e-9
    line = spine.evaluate(np.linspace(*spine.parameter_range, 300)).positions
    assert (line >= bent.joints.min(axis=0) - 1e-9).all()
    assert (line <= bent.joints.max(axis=0) + 1e-9).all()


def test_rolls_are_those_of_the_bones():
    chain = spine_courses.chain_of(list(BONES), TAIL)
    angles = np.array([0.1, 0.5, 2.0, 4.0, 4.0])
    turned = chain._replace(axes=np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1))
    at = spine_courses.stations(5, "joints", 0.5)
    rest = spine_courses.rest_spine(chain, at, "joints")
    spine = turgor.Spine(chain.joints, normal=chain.axes[0])
    assert np.abs(spine_courses.rolls(rest, spine, chain, turned, at) - angles).max() <= 1e-9
