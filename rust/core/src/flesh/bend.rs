//! Near a bend skin shifts to its inside, and grows across.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::anatomy::NearBlock;
use super::lanes::{Points8, add, at, each, each3, scale, single, turned};
use super::limb::Limb;
use super::turn::Turn;
use crate::numeric::block_rows::Block;

/// How far along the limb, in radii: exp(−(x/width)²), to 4 %, as (1 − (x/width)²/8)⁸.
const WIDTH: f32 = 0.9;
const ENDS: f32 = 8.0;
/// Across the limb it holds up to the first of these, in reaches of the section, and ends so much farther out.
const RIM: f32 = 1.3;
const FADE: f32 = 0.7;
/// What sticks out to the inside or outside (breasts) is the joint's own sooner than what does sideways (the other thigh).
const FRONT: f32 = 0.6;
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
    pub fn places<S: Simd>(&self, simd: S, near: &NearBlock, points: &Points8) -> InBend {
        let mut from_head = *points;
        for (row, head) in from_head.iter_mut().zip(self.head) {
            for place in row {
                *place -= head;
            }
        }
        if self.twist != 0.0 {
            let shares = &near.shares;
            from_head = each3(|lane| {
                let v = at(&from_head, lane);
                let share = shares[0][lane] + (shares[1][lane] - shares[0][lane]) * self.spread;
                add(v, turned(self.axis_of_twist, v, share * self.twist))
            });
        }
        let number = |value: f32| f32x8::splat(simd, value);
        let [x, y, z] = [f32x8::simd_from(simd, from_head[0]), f32x8::simd_from(simd, from_head[1]), f32x8::simd_from(simd, from_head[2])];
        let along = x * self.along[0] + y * self.along[1] + z * self.along[2];
        let (x, y, z) = (x + self.to_head[0], y + self.to_head[1], z + self.to_head[2]);
        let height = x * self.inside[0] + y * self.inside[1] + z * self.inside[2];
        let across = x * self.axis[0] + y * self.axis[1] + z * self.axis[2];
        let ([inner, outer, left, right], none) = (self.sides, number(0.0));
        let inside = height.max(none) * inner + height.min(none) * outer;
        let sideways = across.max(none) * left + across.min(none) * right;
        let rim = (inside * inside * (FRONT * FRONT) + sideways * sideways).sqrt();
        let past = ((rim - RIM) * (1.0 / FADE)).max(none).min(number(1.0));
        let mask = (number(1.0) - past * past * (number(3.0) - past * 2.0)) * f32x8::simd_from(simd, near.kin);
        InBend { along: along.into(), inside: inside.into(), across: (across * self.per_radius).into(), mask: mask.into() }
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
            let (bell, inner) = (bell * bell, (0.5 * (1.0 + places.inside[lane])).clamp(0.0, 1.0));
            let bell = bell * bell;
            let part = bell * bell * places.mask[lane];
            let shift = part * (bent.to_inside * inner + bent.from_outside * (1.0 - inner));
            let growth = part * bent.wider * places.across[lane].clamp(-WIDE_MAX, WIDE_MAX);
            for (sum, (inside, axis)) in self.sum.iter_mut().zip(bent.posed_inside.iter().zip(bent.posed_axis)) {
                sum[lane] += inside * shift + axis * growth;
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
