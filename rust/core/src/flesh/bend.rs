//! Near a bend skin shifts to its inside, and grows across.

use glam::DVec3;

use super::anatomy::Near;
use super::limb::Limb;
use super::smoothstep;
use super::turn::Turn;

/// How far along the limb, in radii: exp(−(x/width)²), to 4 %, as (1 − (x/width)²/8)⁸.
const WIDTH: f64 = 0.9;
const ENDS: f64 = 8.0;
/// Where the law ends along the limb, in radii.
pub(super) const REACH: f64 = 2.55;
/// Across the limb it holds up to the first of these, in reaches of the section, and ends so much farther out.
const RIM: f64 = 1.3;
const FADE: f64 = 0.7;
/// What sticks out to the inside or outside (breasts) is the joint's own sooner than what does sideways (the other thigh).
const FRONT: f64 = 0.6;
/// Farthest that anything is across, in reaches of the section.
pub(super) const NEAR_MAX: f64 = (RIM + FADE) / FRONT;
/// Growth across ends here, in radii.
const WIDE_MAX: f64 = 1.5;

/// A place in the frame of a bend, at rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct InBend {
    /// Along the limb from the joint, in radii.
    pub along: f64,
    /// To the inside from the section's middle, in its reaches: 1 the inner skin, −1 the outer.
    pub inside: f64,
    /// Along the axis, in radii.
    pub across: f64,
    /// Part of the point that is the joint's, all along the limb.
    pub mask: f64,
}

impl InBend {
    /// `None` out of reach. The place is turned by its share of the twist first: in the bone above it meets the bend so.
    pub fn new(limb: &Limb, turn: &Turn, near: &Near, place: DVec3) -> Option<Self> {
        let bend = &turn.bend;
        let mut from_head = place - limb.head;
        if turn.twist != 0.0 {
            let (sine, cosine) = (turn.share(near.share) * turn.twist).sin_cos();
            let across = limb.axis.cross(from_head);
            from_head += across * sine + limb.axis.cross(across) * (1.0 - cosine);
        }
        let along = from_head.dot(bend.along) / limb.radius;
        if along.abs() >= REACH {
            return None;
        }
        let from_middle = from_head + (limb.head - limb.middle);
        let (height, across) = (from_middle.dot(bend.inside), from_middle.dot(bend.axis));
        let [inner, outer, left, right] = bend.sides;
        let inside = height * if height > 0.0 { inner } else { outer };
        let sideways = across * if across > 0.0 { left } else { right };
        let rim = (FRONT * inside).hypot(sideways);
        let mask = (1.0 - smoothstep((rim - RIM) / FADE)) * f64::from(near.kin);
        (mask > 0.0).then_some(Self { along, inside, across: across / limb.radius, mask })
    }

    /// Part of the point that the bend moves.
    pub fn part(&self) -> f64 {
        (1.0 - (self.along / WIDTH).powi(2) / ENDS).max(0.0).powi(8) * self.mask
    }

    /// Shift and growth of a point that is the joint's alone.
    pub fn shift(&self, turn: &Turn) -> DVec3 {
        let bend = &turn.bend;
        let inner = (0.5 * (1.0 + self.inside)).clamp(0.0, 1.0);
        let shift = bend.to_inside * inner + bend.from_outside * (1.0 - inner);
        bend.posed_inside * shift + bend.posed_axis * (bend.wider * self.across.clamp(-WIDE_MAX, WIDE_MAX))
    }
}

/// Sum of the shifts of joints whose reaches overlap: as many as there are count as one.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shifts {
    sum: DVec3,
    weight: f64,
    square: f64,
}

impl Shifts {
    pub fn add(&mut self, part: f64, strength: f64, shift: DVec3) {
        self.sum += shift * part;
        self.weight += part * strength;
        self.square += part * strength * strength;
    }

    /// The sum, over how many joints of their mean strength there are, if these are more than one.
    pub fn total(&self) -> DVec3 {
        let count = if self.square > 0.0 { self.weight * self.weight / self.square } else { 0.0 };
        self.sum / count.max(1.0)
    }
}
