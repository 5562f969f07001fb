"""Walking on legs of two bones: feet placed by a closed-form knee, in the plane of the leg's step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, atan2, cos, degrees, hypot, pi

from .character import Bone
from .posing import Pose


@dataclass(frozen=True)
class Leg:
    """A leg's step: phase of its touch-down in the cycle (0..1), stride and lift of the foot in metres."""

    upper: Bone
    lower: Bone
    phase: float
    stride: float
    lift: float
    duty: float = 0.66
    """Part of the cycle on the ground."""

    def pose(self, cycle: float, body_rise: float) -> Pose:
        """Angles of both bones; the knee points forward, the foot folds back.

        body_rise: how far the hip stands above its rest height, metres.
        """
        hip, knee, foot = (_sagittal(point) for point in (self.upper.head, self.lower.head, self.lower.tail))
        reach_forward, reach_up = self.foot_offset(cycle)
        forward = foot[0] + reach_forward - hip[0]
        down = hip[1] + body_rise - foot[1] - reach_up
        thigh = hypot(knee[0] - hip[0], knee[1] - hip[1])
        shin = hypot(foot[0] - knee[0], foot[1] - knee[1])
        reach = min(hypot(forward, down), 0.9995 * (thigh + shin))
        at_hip = acos((thigh**2 + reach**2 - shin**2) / (2 * thigh * reach))
        at_knee = pi - acos((thigh**2 + shin**2 - reach**2) / (2 * thigh * shin))
        thigh_angle = atan2(forward, down) + at_hip
        shin_angle = thigh_angle - at_knee
        rest_thigh = atan2(knee[0] - hip[0], hip[1] - knee[1])
        rest_shin = atan2(foot[0] - knee[0], knee[1] - foot[1])
        bend_upper = rest_thigh - thigh_angle
        bend_lower = rest_shin - shin_angle - bend_upper
        return {self.upper.name: (degrees(bend_upper), 0, 0), self.lower.name: (degrees(bend_lower), 0, 0)}

    def foot_offset(self, cycle: float) -> tuple[float, float]:
        """The foot's way forward and up from its rest place, in metres: sliding back on the ground, swinging ahead."""
        t = (cycle - self.phase) % 1.0
        if t < self.duty:
            return self.stride * (0.5 - t / self.duty), 0.0
        swing = (t - self.duty) / (1 - self.duty)
        forward = self.stride * (0.5 - 0.5 * cos(pi * swing) - 0.5)
        return forward, self.lift * 0.5 * (1 - cos(2 * pi * swing))


def walk_pose(legs: Sequence[Leg], cycle: float, body_rise: float) -> Pose:
    """Angles of all legs at a moment of the cycle, 0 to 1."""
    pose: dict[str, tuple[float, float, float]] = {}
    for leg in legs:
        pose.update(leg.pose(cycle, body_rise))
    return pose


def _sagittal(point: tuple[float, float, float]) -> tuple[float, float]:
    """Forward and height."""
    return -point[1], point[2]
