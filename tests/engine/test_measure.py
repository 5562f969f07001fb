"""Figures of many poses at once are those of each alone."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Mode, Rig, chain, limb, random_rigid_motion
from surfaces import tube

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
solvers = st.sampled_from(["simultaneous", "sequential"])

PER_FRAME = (
    "skinned_volumes",
    "target_volumes",
    "corrected_volumes",
    "joint_losses",
    "joint_regained",
    "joint_is_capped",
)


def assert_same_bits(measures: turgor.Measures, reports: list[turgor.Report]):
    for name in PER_FRAME:
        expected = np.array([getattr(report, name) for report in reports])
        found = getattr(measures, name)
        assert found.dtype == expected.dtype
        assert np.array_equal(found, expected)
    assert np.array_equal(measures.max_displacements, [report.max_displacement for report in reports])


def two_shells() -> Rig:
    """An arm with a bone inside: a tube in a tube."""
    inner = tube(17, 8)
    return chain(tube(33, 12).joined(inner.moved(inner.positions * [1.0, 0.5, 0.5])), 3)


@given(seeds, modes, solvers, st.integers(0, 9))
def test_many_at_once_are_the_same_bits_as_one_by_one(seed: int, mode: Mode, solver, frame_count: int):
    rng = np.random.default_rng(seed)
    rig = two_shells()
    body = rig.body(mode, [turgor.presets.belly(bone) for bone in range(3)], solver=solver)
    poses = np.array([rig.random_pose(rng, 0.9, scale=0.1) for _ in range(frame_count)]).reshape(-1, 3, 4, 4)
    measures = body.measure(poses)
    assert measures.joint_losses.shape == (frame_count, 3)
    assert measures.corrected_volumes.shape == (frame_count, 2)
    if frame_count:
        assert_same_bits(measures, [body.deform(pose).report for pose in poses])


@given(seeds)
def test_order_of_frames_is_order_of_figures(seed: int):
    rng = np.random.default_rng(seed)
    rig = limb(bone_count=5)
    body = rig.body()
    poses = np.array([rig.random_pose(rng, 0.8) for _ in range(12)])
    order = rng.permutation(12)
    straight, shuffled = body.measure(poses), body.measure(poses[order])
    for name in (*PER_FRAME, "max_displacements"):
        assert np.array_equal(getattr(straight, name)[order], getattr(shuffled, name))


@given(seeds, st.lists(st.booleans(), min_size=4, max_size=4))
def test_arrays_are_per_frame_or_the_same_for_all(seed: int, is_per_frame: list[bool]):
    rng = np.random.default_rng(seed)
    rig = limb()
    swollen = (rig.surface.positions * [0.0, 0.3, 0.3])[None]
    body = turgor.VolumeSkin(rig.surface.mesh(), rig.skinning(), shape_deltas=swollen)
    count = 5
    poses = np.array([rig.random_pose(rng, 0.8) for _ in range(count)])
    given_arrays = {
        "object_from_armature": np.array([random_rigid_motion(rng) for _ in range(count)]),
        "shape_values": rng.uniform(-0.5, 1.0, (count, 1)),
        "strengths": rng.uniform(0.0, 2.0, (count, rig.bone_count)),
        "target_scale": rng.uniform(0.8, 1.2, count),
    }
    for (name, values), varies in zip(list(given_arrays.items()), is_per_frame, strict=True):
        if not varies:
            given_arrays[name] = np.broadcast_to(values[0], values.shape)
    arguments: dict[str, Any] = {
        name: values if varies else values[0]
        for (name, values), varies in zip(given_arrays.items(), is_per_frame, strict=True)
    }
    reports = [
        body.deform(pose, **{name: values[frame] for name, values in given_arrays.items()}).report
        for frame, pose in enumerate(poses)
    ]
    assert_same_bits(body.measure(poses, **arguments), reports)


def digest_in_threads(count: int) -> str:
    environment = {**os.environ, "RAYON_NUM_THREADS": str(count)}
    command = [sys.executable, "-c", "import test_measure as t; print(t.figures_of_a_large_limb())"]
    here = Path(__file__).parent
    return subprocess.run(command, cwd=here, env=environment, check=True, capture_output=True, text=True).stdout


def figures_of_a_large_limb() -> str:
    """What the subprocess prints: enough vertices that a frame is cut between threads, too."""
    rig = chain(tube(rings=401, sides=24, length=12.0), 12, length=12.0)
    rng = np.random.default_rng(5)
    measures = rig.body().measure(np.array([rig.random_pose(rng, 0.7) for _ in range(7)]))
    return " ".join(getattr(measures, name).tobytes().hex() for name in (*PER_FRAME, "max_displacements"))


def test_number_of_threads_does_not_matter():
    assert digest_in_threads(1) == digest_in_threads(2) == digest_in_threads(5)


def test_calls_at_the_same_time_do_not_matter():
    rig = limb(bone_count=5)
    body = rig.body()
    rng = np.random.default_rng(7)
    poses = np.array([rig.random_pose(rng, 0.8) for _ in range(30)])
    reports = [body.deform(pose).report for pose in poses]
    with ThreadPoolExecutor(4) as pool:
        for measures in pool.map(lambda _: body.measure(poses), range(8)):
            assert_same_bits(measures, reports)


class TestRefused:
    """What does not fit is told with the frame it is in."""

    rig = limb()
    poses = np.array(list(map(rig.bent, (0.1, 0.2, 0.3, 0.4))))

    def test_first_pose_that_is_not_finite_is_named(self):
        poses = self.poses.copy()
        poses[[2, 3], 1, 0, 0] = np.nan
        with pytest.raises(turgor.TurgorError, match="frame 2: "):
            self.rig.body().measure(poses)

    def test_another_skeleton(self):
        with pytest.raises(turgor.TurgorError, match="frame 0: pose has 2 bones but was bound with 3"):
            self.rig.body().measure(self.poses[:, :2])

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (
                {"object_from_armature": np.zeros((3, 4, 4))},
                r"object_from_armature: need float64 \(4, 4\) or \(4, 4, 4\)",
            ),
            ({"object_from_armature": []}, "object_from_armature: need float64"),
            ({"strengths": np.ones((3, 3))}, r"strengths: need float64 \(B,\) or \(4, B\), got float64 \(3, 3\)"),
            ({"shape_values": np.ones((2, 1))}, r"shape_values: need float64 \(K,\) or \(4, K\)"),
            ({"target_scale": np.ones(3)}, r"target_scale: need float64 one number or \(4,\)"),
            ({"target_scale": 0.0}, "frame 0: target_scale is 0"),
            ({"strengths": np.ones((4, 2))}, "frame 0: strengths: found 2 values, need 3"),
        ],
    )
    def test_wrong_shapes(self, arguments, message: str):
        with pytest.raises(turgor.TurgorError, match=message):
            self.rig.body().measure(self.poses, **arguments)

    def test_one_pose_is_not_many(self):
        with pytest.raises(turgor.TurgorError, match=r"pose_matrices: need float64 \(F, B, 4, 4\)"):
            self.rig.body().measure(self.poses[0])
