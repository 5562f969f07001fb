"""Automatic weights take memory by the mesh and its voxels alone, and those of bones far away have a limit.

Each hostile body is weighted in a process whose address space is limited: one that asks for more ends it.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import turgor
from bodies import Body, box, dense, limb_bones
from hypothesis import given
from hypothesis import strategies as st
from surfaces import tube

GIGABYTES = 2
BODY = box((0, -0.5, -0.5), (4, 0.5, 0.5), cuts=4)
RESOLUTION = 16

# Names of bodies and bones, each made by an expression: the process has no other modules of the tests.
HOSTILE = {
    "a bone away": "weights(bones(3) + far(1))",
    "all bones away": "weights(bones(3) + FAR)",
    "a long bone": "weights(bones(3), bones(3) + STEP + far(2))",
    "long bones from far to far": "weights(bones(3) - FAR, bones(3) + 2 * FAR)",
    "bones apart": "weights(np.outer(10.0 ** np.arange(0, 15), [1, 0, 0]))",
    "a low falloff": "weights(bones(3) + far(1), falloff=0.5)",
    "a low falloff of stiff bones apart": "weights(np.outer(10.0 ** np.arange(0, 15, 7), [1, 0, 0]), falloff=0.5,"
    " stiffness=[1e-3, 1, 1e3])",
    "a tiny body": "weights(bones(3), scale=1e-7)",
    "a body of no size": "weights(bones(3), scale=1e-300)",
    "a body far from bones and the middle of the world": "weights(bones(3), moved=1e12)",
    "two bodies of different size": "weights(bones(3), others=[(CUBE * 1e-9, OFFSETS, CORNERS)])",
    "two bodies apart": "weights(bones(3), others=[(CUBE + 1e9, OFFSETS, CORNERS)])",
    "a parent far away": "weights(bones(3) + far(0), parents=[-1, 0, 0])",
    "a mirror far away": "weights(bones(3), symmetry_plane=((1e12, 0, 0), (1, 0, 0)))",
    "a thousand bones": "weights(bones(1000) * [4e-3, 1, 1], parents=np.arange(-1, 999))",
    "a thousand long bones": "weights(bones(1000) - FAR, bones(1000) + FAR, parents=np.arange(-1, 999), resolution=16)",
    "a long body at the finest": "weights(bones(3), scale=(100, 1, 1), resolution=1024)",
    "a stray vertex": "weights(bones(3), others=[([[1e12, 0, 0]], [0], [])])",
    "a body many times": "weights(bones(3), others=[(CUBE, OFFSETS, CORNERS)] * 500)",
}
# What cannot be served is refused before it is tried.
REFUSED = {
    "a thick body at the finest": "weights(bones(3), resolution=1024)",
    "a crumpled sheet at the finest": "weights(bones(3), others=[crumpled(3000)], resolution=1024)",
}

PRELUDE = f"""
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, ({GIGABYTES} << 30,) * 2)
import numpy as np, turgor
CUBE = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
CORNERS = np.array([0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3], np.int32)
OFFSETS = np.arange(0, 25, 4, dtype=np.int32)
FAR = np.array([1e12, 0, 0])
STEP = np.array([0.4, 0, 0])

def bones(count):
    return np.outer(np.arange(count), [0.3, 0, 0]) + [0.1, 0.5, 0.5]

def far(bone):
    return np.outer(np.arange(3) == bone, FAR)

def crumpled(count):
    corners = np.arange(3 * count, dtype=np.int32)
    return np.random.default_rng(0).random((3 * count, 3)), np.arange(0, 3 * count + 1, 3, dtype=np.int32), corners

def weights(heads, tails=None, scale=1.0, moved=0.0, others=(), parents=None, **settings):
    tails = heads + STEP if tails is None else tails
    meshes = [(CUBE * scale + moved, OFFSETS, CORNERS), *others]
    found = turgor.automatic_weights(meshes, heads, tails, bone_parents=parents, **settings)
    sums = np.add.reduceat(found.weights, found.offsets[:-1])
    assert np.isfinite(found.weights).all() and np.allclose(sums, 1.0, atol=1e-6), sums
"""


def run(expression: str) -> subprocess.CompletedProcess[str]:
    engine = Path(turgor.__file__).parents[1]
    lines = f"import sys; sys.path.insert(0, {str(engine)!r})\n{PRELUDE}\n{expression}\n"
    environment = {"RAYON_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True, env=environment, check=False)


needs_limits = pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the address space of a process")


@needs_limits
@pytest.mark.parametrize("name", HOSTILE)
def test_memory_is_bounded_by_the_mesh(name: str):
    done = run(HOSTILE[name])
    assert done.returncode == 0, done.stderr[-2000:]


@needs_limits
@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_fit_is_refused_before_it_is_tried(name: str):
    done = run(f"""
try:
    {REFUSED[name]}
except turgor.TurgorError as error:
    assert "resolution 1024 makes more voxels than fit into memory" in str(error), error
else:
    raise AssertionError("was not refused")
""")
    assert done.returncode == 0, done.stderr[-2000:]


def weights_at(distance: float, direction: np.ndarray, which: str) -> np.ndarray:
    """(N, 3) weights of a body on bones of which some are away, or reach as far."""
    heads, tails = limb_bones(3)
    heads, tails = heads.copy(), tails.copy()
    away = distance * direction
    if which == "one away":
        heads[2] += away
        tails[2] += away
    elif which == "all away":
        heads += away
        tails += away
    elif which == "one long":
        tails[2] += away
    else:
        heads += away
        tails += away * [[1.0], [1.1], [1.0]]
    return Body([BODY], heads, tails).matrix(resolution=RESOLUTION, max_influences=None)


directions = st.builds(
    lambda x, y: np.array([np.cos(x) * np.cos(y), np.sin(x) * np.cos(y), np.sin(y)]),
    st.floats(0.0, 6.28),
    st.floats(-1.5, 1.5),
)
which_bones = st.sampled_from(["one away", "all away", "one long", "apart"])


@given(directions, which_bones)
def test_weights_of_bones_far_away_have_a_limit(direction: np.ndarray, which: str):
    limit = weights_at(1e14, direction, which)
    errors = [np.abs(weights_at(distance, direction, which) - limit).max() for distance in (1e4, 1e6, 1e9, 1e12)]
    # What is left of the ends of bones falls with their distance; lengths are rounded to single precision.
    for distance, error in zip((1e4, 1e6, 1e9, 1e12), errors, strict=True):
        assert error < 100.0 / distance + 1e-5, (distance, error)


@given(directions, which_bones, st.floats(0.7, 14.0))
def test_no_jump_on_the_way_there(direction: np.ndarray, which: str, exponent: float):
    near, far = 10.0**exponent, 10.0**exponent * (1.0 + 1e-5)
    jump = np.abs(weights_at(near, direction, which) - weights_at(far, direction, which)).max()
    assert jump < 2e-3


@given(st.floats(-12.0, 12.0), st.floats(-12.0, 12.0))
def test_the_unit_of_length_does_not_matter(body: float, bones: float):
    """A tiny body under usual bones is a usual one under bones that are far, and far apart."""
    body, bones = 10.0**body, 10.0**bones
    surface = tube(rings=9, sides=8)
    heads, tails = limb_bones(2)

    def weights(unit: float) -> np.ndarray:
        mesh = (surface.positions * body * unit, surface.face_offsets, surface.face_corners)
        ends = heads * bones * unit, tails * bones * unit
        return dense(turgor.automatic_weights([mesh], *ends, resolution=RESOLUTION, max_influences=None), 2)

    np.testing.assert_allclose(weights(1.0), weights(2.0**-9), atol=1e-6)
