//! Near a bend skin shifts to its inside, and grows across.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::anatomy::NearBlock;
use super::lanes::{Eight, held, single, smooth};
use super::limb::Limb;
use super::turn::Turn;

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
#[derive(Clone, Copy)]
pub(super) struct InBend<S: Simd> {
    /// Along the limb from the joint, in radii.
    pub along: f32x8<S>,
    /// To the inside from the section's middle, in its reaches: 1 the inner skin, −1 the outer.
    inside: f32x8<S>,
    /// Along the axis, in radii.
    across: f32x8<S>,
    /// Part of the point that is the joint's, all along the limb.
    pub mask: f32x8<S>,
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

    /// Places from the joint, turned by their share of the twist first: in the bone above they meet the bend so.
    #[inline(always)]
    pub fn before_bend<S: Simd>(&self, simd: S, near: &NearBlock, places: Eight<S>) -> Eight<S> {
        let from_head = places - Eight::splat(simd, self.head);
        if self.twist == 0.0 {
            return from_head;
        }
        let [blended, along] = [f32x8::simd_from(simd, near.shares[0]), f32x8::simd_from(simd, near.shares[1])];
        let share = blended + (along - blended) * self.spread;
        from_head + from_head.turned(self.axis_of_twist, share * self.twist)
    }

    /// How far along the limb they lie, in radii.
    #[inline(always)]
    pub fn along<S: Simd>(&self, from_head: Eight<S>) -> f32x8<S> {
        from_head.dot(self.along)
    }

    /// Places from the joint in the frame of the bend.
    #[inline(always)]
    pub fn places<S: Simd>(&self, simd: S, near: &NearBlock, from_head: Eight<S>) -> InBend<S> {
        let from_middle = from_head + Eight::splat(simd, self.to_head);
        let (height, across) = (from_middle.dot(self.inside), from_middle.dot(self.axis));
        let ([inner, outer, left, right], none) = (self.sides, f32x8::splat(simd, 0.0));
        let inside = height.max(none) * inner + height.min(none) * outer;
        let sideways = across.max(none) * left + across.min(none) * right;
        let rim_squared = inside * inside * (FRONT * FRONT) + sideways * sideways;
        let mut mask = f32x8::simd_from(simd, near.kin);
        // Seldom: most skin lies within.
        if rim_squared.simd_gt(f32x8::splat(simd, RIM * RIM)).any_true() {
            mask = (-smooth((rim_squared.sqrt() - RIM) * (1.0 / FADE)) + 1.0) * mask;
        }
        InBend { along: self.along(from_head), inside, across: across * self.per_radius, mask }
    }
}

/// Sums over joints whose reaches overlap: as many as there are count as one.
#[derive(Clone, Copy)]
pub(super) struct Shifts<S: Simd> {
    sum: Eight<S>,
    weight: f32x8<S>,
    square: f32x8<S>,
}

impl<S: Simd> Shifts<S> {
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        let none = f32x8::splat(simd, 0.0);
        Self { sum: Eight::splat(simd, [0.0; 3]), weight: none, square: none }
    }

    /// Adds shift and growth by one bend.
    #[inline(always)]
    pub fn add(&mut self, bent: &Bent, places: &InBend<S>) {
        let x = places.along * (1.0 / WIDTH);
        let bell = (-(x * x) * (1.0 / ENDS) + 1.0).max(f32x8::splat(x.token(), 0.0));
        let (bell, inner) = (bell * bell, held((places.inside + 1.0) * 0.5, 0.0, 1.0));
        let bell = bell * bell;
        let part = bell * bell * places.mask;
        let shift = part * (inner * bent.to_inside + (-inner + 1.0) * bent.from_outside);
        let growth = part * bent.wider * held(places.across, -WIDE_MAX, WIDE_MAX);
        self.sum = self.sum + (Eight::along(bent.posed_inside, shift) + Eight::along(bent.posed_axis, growth));
        self.weight += part * bent.strength;
        self.square += part * bent.strength * bent.strength;
    }

    /// The sum, over how many joints of their mean strength there are, if these are more than one.
    #[inline(always)]
    pub fn total(self) -> Eight<S> {
        let least = f32x8::splat(self.weight.token(), f32::MIN_POSITIVE);
        self.sum.scale(self.square / (self.weight * self.weight).max(self.square).max(least))
    }
}
