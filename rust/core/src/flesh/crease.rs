//! The inside of a bend closes on the plane that halves it: skin stays on its own bone's side.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::DVec3;

use super::bend::InBend;
use super::lanes::{Eight, held, single, smooth};
use super::smoothstep;
use super::turn::Turn;

/// It begins to close at this bend, and holds in full from so much more on; radians.
const BEGINS: f64 = 0.6;
const GROWS: f64 = 0.5;
/// Skin keeps this far from the plane, and is held softly over so much on either side of that; radii.
const MARGIN: f32 = 0.03;
const SOFT: f32 = 0.14;
/// Skin that rests this near to the plane is on neither side.
const SIDES: f32 = 0.05;
/// Inside begins this far from the joint.
const ABOVE: f32 = 0.3;
/// Along the limb it holds up to the first of these, and ends so much farther out.
const REACH: f32 = 1.4;
const FADE: f32 = 1.0;
/// Nothing is pushed farther: deeper bends are limbs that touch, not folds.
const DEEP: f32 = 0.5;
/// Skin within this of the plane has no room for more.
const ROOM: f32 = 0.3;

/// A crease in one frame, as its points need it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crease {
    pub joint: DVec3,
    closes: f32,
    /// Over the radius, and by one radius.
    along: [f32; 3],
    inside: [f32; 3],
    posed_along: [f32; 3],
}

impl Crease {
    /// `joint`: where it stands in the pose. `None` where nothing closes.
    pub fn new(turn: &Turn, joint: DVec3) -> Option<Self> {
        let bend = &turn.bend;
        let closes = (bend.crease * smoothstep((bend.angle - BEGINS) / GROWS)) as f32;
        let per_radius = |axis: DVec3| single(axis / axis.length_squared().max(f64::MIN_POSITIVE));
        (closes > 0.0).then(|| Self {
            joint,
            closes,
            along: per_radius(bend.posed_along),
            inside: per_radius(bend.posed_inside),
            posed_along: single(bend.posed_along),
        })
    }

    /// Whether any of eight points that stand `from_joint` lies on the inside.
    #[inline(always)]
    pub fn concerns<S: Simd>(&self, from_joint: Eight<S>) -> bool {
        let inside = from_joint.dot(self.inside);
        inside.simd_gt(f32x8::splat(inside.token(), 0.0)).any_true()
    }

    /// Holds points that stand `from_joint` on their side: adds to `by`, and takes what lies in the closed crease from `free`.
    #[inline(always)]
    pub fn hold<S: Simd>(&self, rest: &InBend<S>, from_joint: Eight<S>, by: &mut Eight<S>, free: &mut f32x8<S>) {
        let simd = free.token();
        let (none, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let off = rest.along.abs();
        let inside = smooth(from_joint.dot(self.inside) * (1.0 / ABOVE));
        let closes = rest.mask * self.closes * (-smooth((off - REACH) * (1.0 / FADE)) + 1.0) * inside;
        let side = rest.along.simd_lt(none).select(-one, one);
        let margin = (off * 0.25).min(f32x8::splat(simd, MARGIN));
        let short = margin - side * from_joint.dot(self.along);
        // What is larger of short and 0, rounded off between −SOFT and SOFT.
        let round = held(short + SOFT, 0.0, 2.0 * SOFT);
        let short_round = round * round * (0.25 / SOFT) + (short - SOFT).max(none);
        let deep = (short_round * (1.0 / DEEP)) * (short_round * (1.0 / DEEP));
        let pushed = short_round / (deep * deep + 1.0).sqrt().sqrt() * smooth(off * (1.0 / SIDES));
        *by = *by + Eight::along(self.posed_along, side * pushed * closes);
        let touch = closes * (-smooth((pushed - short) * (1.0 / ROOM)) + 1.0);
        *free = *free * (-touch + 1.0);
    }
}
