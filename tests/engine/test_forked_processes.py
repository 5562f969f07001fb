"""Processes that a pipeline forks after the engine was used: they go on with it as if nothing had been."""

from __future__ import annotations

import multiprocessing
import sys
from collections.abc import Callable
from multiprocessing.connection import Connection

import numpy as np
import pytest
import turgor
from bodies import Body, limb_bones
from rigs import limb
from spines import helix, line
from surfaces import tube

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="no process is forked there"),
    pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning"),
]
# For work of a fraction of a second; a process that hangs is stopped then.
PATIENCE = 60.0


def frames() -> bytes:
    """Bound here, and skinned both ways."""
    rig = limb(rings=101)
    pose = rig.random_pose(np.random.default_rng(3), 0.7)
    body = rig.body()
    return body.deform(pose).positions.tobytes() + body.deform_many(np.stack([pose, pose])).tobytes()


def weights() -> bytes:
    """Voxels, distances, heat."""
    found = Body([tube(rings=33, sides=12)], *limb_bones(3)).weights()
    return found.weights.tobytes() + found.bones.tobytes()


def fleshing() -> bytes:
    """Along a spine."""
    points = tube(rings=33, sides=12, length=5.0).positions
    return turgor.Fleshing(turgor.Spine(line()), points).deform(turgor.Spine(helix())).tobytes()


@pytest.mark.parametrize("work", [frames, weights, fleshing], ids=lambda work: work.__name__)
def test_a_fork_computes_the_same(work: Callable[[], bytes]):
    assert of_fork(work) == work() == of_fork(lambda: of_fork(work))


def test_a_fork_goes_on_with_what_was_bound_before():
    rig = limb(rings=101)
    pose = rig.random_pose(np.random.default_rng(3), 0.7)
    body = rig.body()
    expected = body.deform(pose).positions.tobytes()
    assert of_fork(lambda: body.deform(pose).positions.tobytes()) == expected


def of_fork(work: Callable[[], bytes]) -> bytes:
    """What `work` makes in a process of its own."""
    fork = multiprocessing.get_context("fork")
    here, there = fork.Pipe(duplex=False)

    def send(to: Connection) -> None:
        to.send_bytes(work())

    process = fork.Process(target=send, args=(there,))
    process.start()
    there.close()
    try:
        assert here.poll(PATIENCE), "the process hangs"
        return here.recv_bytes()
    finally:
        process.kill()
        process.join()
