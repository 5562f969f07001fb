//! Near a bend skin shifts to its inside, and grows across.

use super::anatomy::NearBlock;
use super::lanes::{Points8, add, at, dot, each, each3, scale, single, smooth, sub, turned};
use super::limb::Limb;
use super::turn::Turn;
use crate::numeric::block_rows::Block;

/// How far along the limb, in radii: exp(−(x/width)²), to 4 %, as (1 − (x/width)²/8)⁸.
const WIDTH: f32 = 0.9;
const ENDS: f32 = 8.0;
/// Where the law ends along the limb, in radii.
pub(super) const REACH: f64 = 2.55;
/// Across the limb it holds up to the first of these, in reaches of the section, and ends so much farther out.
const RIM: f32 = 1.3;
const FADE: f32 = 0.7;
/// What sticks out to the inside or outside (breasts) is the joint's own sooner than what does sideways (the other thigh).
const FRONT: f32 = 0.6;
/// Farthest that anything is across, in reaches of the section.
pub(super) const NEAR_MAX: f64 = 2.0 / 0.6;
/// Growth across ends here, in radii.
const WIDE_MAX: f32 = 1.5;

/// A bend in one frame, as its points need it, in single precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bent {
    head: [f32; 3],
    /// From the section's middle to the joint.
    to_head: [f32; 3],
    axis_of_twist: [f32; 3],
    twist: f32,
    spread: f32,
    /// Over the radius.
    along: [f32; 3],
    inside: [f32; 3],
    axis: [f32; 3],
    sides: [f32; 4],
    per_radius: f32,
    posed_inside: [f32; 3],
    posed_axis: [f32; 3],
    to_inside: f32,
    from_outside: f32,
    wider: f32,
    strength: f32,
}

/// Eight places in the frame of a bend, at rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct InBend {
    /// Along the limb from the joint, in radii.
    pub along: Block<f32>,
    /// To the inside from the section's middle, in its reaches: 1 the inner skin, −1 the outer.
    inside: Block<f32>,
    /// Along the axis, in radii.
    across: Block<f32>,
    /// Part of the point that is the joint's, all along the limb.
    pub mask: Block<f32>,
}

impl Bent {
    /// `centre`: that places are told from.
    pub fn new(limb: &Limb, turn: &Turn, centre: glam::DVec3) -> Self {
        let bend = &turn.bend;
        Self {
            head: single(limb.head - centre),
            to_head: single(limb.head - limb.middle),
            axis_of_twist: single(limb.axis),
            twist: turn.twist as f32,
            spread: turn.spread as f32,
            along: single(bend.along / limb.radius),
            inside: single(bend.inside),
            axis: single(bend.axis),
            sides: bend.sides.map(|side| side as f32),
            per_radius: limb.radius.recip() as f32,
            posed_inside: single(bend.posed_inside),
            posed_axis: single(bend.posed_axis),
            to_inside: bend.to_inside as f32,
            from_outside: bend.from_outside as f32,
            wider: bend.wider as f32,
            strength: bend.strength as f32,
        }
    }

    /// Places turned by their share of the twist first: in the bone above they meet the bend so.
    #[inline(always)]
    pub fn places(&self, near: &NearBlock, points: &Points8) -> InBend {
        let mut result = InBend { along: [0.0; 8], inside: [0.0; 8], across: [0.0; 8], mask: [0.0; 8] };
        let [inner, outer, left, right] = self.sides;
        for lane in 0..8 {
            let mut from_head = sub(at(points, lane), self.head);
            if self.twist != 0.0 {
                let (blended, along) = (near.shares[0][lane], near.shares[1][lane]);
                let by = turned(self.axis_of_twist, from_head, (blended + (along - blended) * self.spread) * self.twist);
                from_head = add(from_head, by);
            }
            let from_middle = add(from_head, self.to_head);
            let (height, across) = (dot(from_middle, self.inside), dot(from_middle, self.axis));
            let inside = height.max(0.0) * inner + height.min(0.0) * outer;
            let sideways = across.max(0.0) * left + across.min(0.0) * right;
            let rim = (FRONT * FRONT * inside * inside + sideways * sideways).sqrt();
            result.along[lane] = dot(from_head, self.along);
            result.inside[lane] = inside;
            result.across[lane] = across * self.per_radius;
            result.mask[lane] = (1.0 - smooth((rim - RIM) / FADE)) * near.kin[lane];
        }
        result
    }
}

/// Sums over joints whose reaches overlap: as many as there are count as one.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shifts {
    sum: Points8,
    weight: Block<f32>,
    square: Block<f32>,
}

impl Shifts {
    pub const NONE: Self = Self { sum: [[0.0; 8]; 3], weight: [0.0; 8], square: [0.0; 8] };

    /// Adds shift and growth by one bend.
    #[inline(always)]
    pub fn add(&mut self, bent: &Bent, places: &InBend) {
        for lane in 0..8 {
            let x = places.along[lane] * (1.0 / WIDTH);
            let bell = (1.0 - x * x * (1.0 / ENDS)).max(0.0);
            let (bell, inner) = (bell * bell, (0.5 * (1.0 + places.inside[lane])).max(0.0).min(1.0));
            let bell = bell * bell;
            let part = bell * bell * places.mask[lane];
            let shift = part * (bent.to_inside * inner + bent.from_outside * (1.0 - inner));
            let growth = part * bent.wider * places.across[lane].max(-WIDE_MAX).min(WIDE_MAX);
            for axis in 0..3 {
                self.sum[axis][lane] += bent.posed_inside[axis] * shift + bent.posed_axis[axis] * growth;
            }
            self.weight[lane] += part * bent.strength;
            self.square[lane] += part * bent.strength * bent.strength;
        }
    }

    /// The sum, over how many joints of their mean strength there are, if these are more than one.
    #[inline(always)]
    pub fn total(&self) -> Points8 {
        let parts = each(|lane| {
            let (weight, square) = (self.weight[lane], self.square[lane]);
            square / (weight * weight).max(square).max(f32::MIN_POSITIVE)
        });
        each3(|lane| scale(at(&self.sum, lane), parts[lane]))
    }
}
