"""Bones that are segments of the bone above: one body, whose segments bend it and mean nothing else (MATH 3)."""

from __future__ import annotations

import numpy as np
import pytest
import turgor
from hypothesis import given
from hypothesis import strategies as st
from rigs import Mode, Rig, limb

seeds = st.integers(0, 2**32 - 1)
modes = st.sampled_from(["linear", "dual_quaternion"])
BONES = 6
# The second of three bodies is a bone and two segments.
SEGMENTS = [False, False, True, True, False, False]


def segmented(rig: Rig, segments: list[bool] | None, mode: Mode = "linear", **options) -> turgor.VolumeSkin:
    count, width = rig.bones.shape
    skinning = turgor.Skinning(
        turgor.Skeleton(rig.parents, rig.rest_matrices, segments),
        np.arange(0, count * width + 1, width, dtype=np.int32),
        rig.bones.ravel(),
        rig.weights.ravel(),
        mode,
    )
    return turgor.VolumeSkin(rig.surface.mesh(), skinning, **options)


def shifted(rig: Rig, random: np.random.Generator) -> np.ndarray:
    """All bones turned; segments, and what hangs below them not, moved against what they hang on."""
    pose = rig.random_pose(random)
    for bone in np.flatnonzero(SEGMENTS):
        offset = random.uniform(-0.1, 0.1, 3)
        pose[bone:, :3, 3] += offset
    return pose


@given(seeds, modes)
def test_shifts_of_segments_are_no_intent(seed: int, mode: Mode):
    rig = limb(bone_count=BONES)
    pose = shifted(rig, np.random.default_rng(seed))
    rest = np.array([part.rest_volume for part in rig.surface.mesh().components])
    found = segmented(rig, SEGMENTS, mode).deform(pose).report
    assert found.target_volumes == pytest.approx(rest, rel=1e-9)
    assert found.corrected_volumes == pytest.approx(found.target_volumes, rel=1e-12)
    plain = segmented(rig, None, mode).deform(pose).report
    assert np.abs(plain.target_volumes / rest - 1.0).max() > 1e-6


@given(seeds, modes)
def test_losses_of_all_joints_sum_to_the_whole(seed: int, mode: Mode):
    rig = limb(bone_count=BONES)
    pose = shifted(rig, np.random.default_rng(seed))
    found = segmented(rig, SEGMENTS, mode).deform(pose).report
    assert found.joint_losses.sum() == pytest.approx((found.target_volumes - found.skinned_volumes).sum(), abs=1e-12)


@given(seeds)
def test_scale_of_segments_is_intent(seed: int):
    """The target is that of the same bones without segments, where nothing is shifted."""
    rig = limb(bone_count=BONES)
    pose = rig.random_pose(np.random.default_rng(seed), scale=0.2)
    found = segmented(rig, SEGMENTS).deform(pose).report
    plain = segmented(rig, None).deform(pose).report
    assert found.target_volumes == pytest.approx(plain.target_volumes, rel=1e-9)


def test_without_any_segment_nothing_changes():
    rig = limb(bone_count=BONES)
    pose = rig.random_pose(np.random.default_rng(1), scale=0.1, shift=0.1)
    found, plain = (segmented(rig, segments).deform(pose) for segments in ([False] * BONES, None))
    assert (found.offsets == plain.offsets).all()
    assert (found.report.joint_losses == plain.report.joint_losses).all()


def test_the_first_joint_of_a_body_reaches_as_a_bone_does():
    """Not as far as its first segment alone."""
    rig = limb(bone_count=BONES)
    first = list(segmented(rig, None).joint_bones).index(1)
    lengths = [segmented(rig, segments).joint_lengths[first] for segments in (SEGMENTS, None)]
    assert lengths[0] >= lengths[1]


@pytest.mark.parametrize(
    ("segments", "words"),
    [([True] * BONES, "parents of segments"), ([False] * 3, "need 6"), ([False] * 7, "need 6")],
)
def test_segments_that_cannot_be_are_refused(segments: list[bool], words: str):
    with pytest.raises(turgor.TurgorError, match=words):
        segmented(limb(bone_count=BONES), segments)
