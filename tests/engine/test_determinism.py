"""The same bytes for the same frame, however it was reached."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from rigs import Mode, Rig, chain, limb
from surfaces import tube

POSE_COUNT = 6


def large_limb() -> Rig:
    """Enough vertices for several chunks of parallel work."""
    return chain(tube(rings=801, sides=24, length=12.0), 12, length=12.0)


def poses(rig: Rig) -> list[np.ndarray]:
    rng = np.random.default_rng(11)
    return [rig.random_pose(rng, 0.7) for _ in range(POSE_COUNT)]


def digest_of_all_poses() -> str:
    """What the subprocess prints: the digest of both modes over all poses."""
    rig = large_limb()
    digest = hashlib.sha256()
    for mode in ("linear", "dual_quaternion"):
        body = rig.body(mode)
        for pose in poses(rig):
            digest.update(body.deform(pose).positions.tobytes())
    return digest.hexdigest()


def digest_in_threads(count: int, of: str = "test_determinism.digest_of_all_poses") -> str:
    """What a function of a test module returns in a process with so many threads."""
    module, name = of.split(".")
    environment = {**os.environ, "RAYON_NUM_THREADS": str(count)}
    command = [sys.executable, "-c", f"import {module} as t; print(t.{name}())"]
    here = Path(__file__).parent
    return subprocess.run(command, cwd=here, env=environment, check=True, capture_output=True, text=True).stdout


def test_number_of_threads_does_not_matter():
    assert digest_in_threads(1) == digest_in_threads(2) == digest_in_threads(5)


@pytest.mark.parametrize("mode", ["linear", "dual_quaternion"])
def test_order_of_frames_does_not_matter(mode: Mode):
    rig = limb(bone_count=5)
    body = rig.body(mode)
    forwards = [body.deform(pose).positions for pose in poses(rig)]
    for index in (5, 0, 3, 3, 1, 4, 2, 0):
        assert np.array_equal(body.deform(poses(rig)[index]).positions, forwards[index])


def test_binding_again_does_not_matter():
    rig = limb(bone_count=5)
    for pose in poses(rig):
        assert np.array_equal(rig.body().deform(pose).positions, rig.body().deform(pose).positions)


def test_other_threads_deforming_do_not_matter():
    rig = limb(bone_count=5)
    body = rig.body()
    alone = [body.deform(pose).positions for pose in poses(rig)]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda pose: body.deform(pose).positions, poses(rig) * 4))
    assert all(np.array_equal(result, alone[index % POSE_COUNT]) for index, result in enumerate(together))


def test_every_way_out_gives_the_same_offsets():
    rig = limb(bone_count=5)
    body = rig.body()
    for pose in poses(rig):
        frame = body.deform(pose)
        written, addressed = (np.full_like(frame.offsets, np.nan) for _ in range(2))
        report = body.deform_into(written, pose)
        body.deform_into_address(addressed.ctypes.data, len(addressed), pose)
        assert np.array_equal(written, frame.offsets)
        assert np.array_equal(addressed, frame.offsets)
        assert np.array_equal(report.joint_losses, frame.report.joint_losses)
        np.testing.assert_allclose(frame.offsets, frame.positions - frame.skinned, rtol=1e-6, atol=1e-12)


def test_skinned_is_what_skinning_alone_gives():
    rig = limb(bone_count=5)
    for pose in poses(rig):
        alone = rig.skinning().deform(rig.surface.positions, pose)
        np.testing.assert_allclose(rig.body().deform(pose).skinned, alone, atol=1e-13)
