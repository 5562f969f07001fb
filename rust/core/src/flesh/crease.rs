//! The inside of a bend closes on the plane that halves it: skin stays on its own bone's side.

use glam::DVec3;

use super::bend::InBend;
use super::lanes::{Points8, at, dot, each, single, smooth};
use super::smoothstep;
use super::turn::Turn;
use crate::numeric::block_rows::{Block, LANES};

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

    /// How much each point is the crease's, before it is known where it stands.
    #[inline(always)]
    pub fn parts(&self, rest: &InBend) -> Block<f32> {
        each(|lane| self.closes * rest.mask[lane] * (1.0 - smooth((rest.along[lane].abs() - REACH) / FADE)))
    }

    /// Holds points that stand `from_joint` on their side: adds to `by`, and takes what lies in the closed crease from `free`.
    #[inline(always)]
    pub fn hold(&self, rest: &InBend, parts: &Block<f32>, from_joint: &Points8, by: &mut Points8, free: &mut Block<f32>) {
        for lane in 0..LANES {
            let place = at(from_joint, lane);
            let closes = parts[lane] * smooth(dot(place, self.inside) * (1.0 / ABOVE));
            let side = if rest.along[lane] < 0.0 { -1.0 } else { 1.0 };
            let off = rest.along[lane].abs();
            let margin = MARGIN.min(0.25 * off);
            let short = margin - side * dot(place, self.along);
            // What is larger of short and 0, rounded off between −SOFT and SOFT.
            let round = (short + SOFT).clamp(0.0, 2.0 * SOFT);
            let short_round = round * round * (0.25 / SOFT) + (short - SOFT).max(0.0);
            let deep = (short_round * (1.0 / DEEP)) * (short_round * (1.0 / DEEP));
            let pushed = short_round / (1.0 + deep * deep).sqrt().sqrt() * smooth(off * (1.0 / SIDES));
            for (by, along) in by.iter_mut().zip(self.posed_along) {
                by[lane] += along * (side * pushed * closes);
            }
            let touch = closes * (1.0 - smooth((pushed - short) * (1.0 / ROOM)));
            free[lane] *= 1.0 - touch;
        }
    }
}
