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

    /// Whether any of eight points that lie so far `along` the limb, and now stand `from_joint`, is on the inside, near the plane or
    /// beyond it.
    #[inline(always)]
    pub fn concerns<S: Simd>(&self, along: f32x8<S>, from_joint: Eight<S>) -> bool {
        let (simd, off) = (along.token(), along.abs());
        let is_inside = from_joint.dot(self.inside).simd_gt(f32x8::splat(simd, 0.0));
        let is_near = off.simd_lt(f32x8::splat(simd, REACH + FADE));
        let has_no_room = self.short(along, from_joint).simd_gt(f32x8::splat(simd, -ROOM));
        (is_inside & is_near & has_no_room).any_true()
    }

    /// How far points are on the wrong side of the plane, or nearer to it than the margin.
    #[inline(always)]
    fn short<S: Simd>(&self, along: f32x8<S>, from_joint: Eight<S>) -> f32x8<S> {
        let margin = (along.abs() * 0.25).min(f32x8::splat(along.token(), MARGIN));
        margin - side(along) * from_joint.dot(self.along)
    }

    /// Holds points that stand `from_joint` on their side: adds to `by`, and takes what lies in the closed crease from `free`.
    #[inline(always)]
    pub fn hold<S: Simd>(&self, rest: &InBend<S>, from_joint: Eight<S>, by: &mut Eight<S>, free: &mut f32x8<S>) {
        let simd = free.token();
        let off = rest.along.abs();
        let inside = smooth(from_joint.dot(self.inside) * (1.0 / ABOVE));
        let closes = rest.mask * self.closes * (-smooth((off - REACH) * (1.0 / FADE)) + 1.0) * inside;
        let short = self.short(rest.along, from_joint);
        // What is larger of short and 0, rounded off between −SOFT and SOFT.
        let round = held(short + SOFT, 0.0, 2.0 * SOFT);
        let short_round = round * round * (0.25 / SOFT) + (short - SOFT).max(f32x8::splat(simd, 0.0));
        let deep = (short_round * (1.0 / DEEP)) * (short_round * (1.0 / DEEP));
        let pushed = short_round / (deep * deep + 1.0).sqrt().sqrt() * smooth(off * (1.0 / SIDES));
        *by = *by + Eight::along(self.posed_along, side(rest.along) * pushed * closes);
        let touch = closes * (-smooth((pushed - short) * (1.0 / ROOM)) + 1.0);
        *free *= -touch + 1.0;
    }
}

/// 1 on the joint's own side, −1 on that of the bone above.
#[inline(always)]
fn side<S: Simd>(along: f32x8<S>) -> f32x8<S> {
    let one = f32x8::splat(along.token(), 1.0);
    along.simd_lt(f32x8::splat(along.token(), 0.0)).select(-one, one)
}
