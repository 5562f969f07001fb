//! The inside of a bend closes on the plane that halves it: skin stays on its own bone's side.

use glam::DVec3;

use super::bend::InBend;
use super::smoothstep;
use super::turn::Turn;

/// It begins to close at this bend, and holds in full from so much more on; radians.
const BEGINS: f64 = 0.6;
const GROWS: f64 = 0.5;
/// Skin keeps this far from the plane, and is held softly over so much before it; radii.
const MARGIN: f64 = 0.03;
const SOFT: f64 = 0.05;
/// Skin that rests this near to the plane is on neither side.
const SIDES: f64 = 0.05;
/// Inside begins this far from the joint.
const ABOVE: f64 = 0.3;
/// Along the limb it holds up to the first of these, and ends so much farther out.
const REACH: f64 = 1.0;
const FADE: f64 = 1.2;
/// Nothing is pushed farther.
const DEEP: f64 = 0.35;
/// Skin within this of the plane has no room for more.
const ROOM: f64 = 0.3;

/// A point that a crease may hold.
#[derive(Debug, Clone, Copy)]
pub(super) struct Creased {
    pub by: DVec3,
    /// Part of the point that lies in the closed crease.
    pub touch: f64,
}

/// What the crease of a joint does to a point; `from_joint`: where it stands, from the joint.
pub(super) fn creased(turn: &Turn, rest: &InBend, from_joint: DVec3) -> Option<Creased> {
    let bend = &turn.bend;
    let closes = bend.crease * smoothstep((bend.angle - BEGINS) / GROWS) * rest.mask;
    let closes = closes * (1.0 - smoothstep((rest.along.abs() - REACH) / FADE));
    if closes <= 0.0 {
        return None;
    }
    let in_radii = |axis: DVec3| from_joint.dot(axis) / axis.length_squared().max(f64::MIN_POSITIVE);
    let closes = closes * smoothstep(in_radii(bend.posed_inside) / ABOVE);
    let side = rest.along.signum();
    let along = side * in_radii(bend.posed_along);
    let margin = MARGIN.min(0.25 * rest.along.abs());
    if closes <= 0.0 || along > margin + ROOM {
        return None;
    }
    // ln(1 + e^x) without overflow.
    let x = (along - margin) / SOFT;
    let soft = x.max(0.0) + (-x.abs()).exp().ln_1p();
    let short = (margin + SOFT * soft - along).max(0.0);
    let pushed = DEEP * (short / DEEP).tanh() * smoothstep(rest.along.abs() / SIDES);
    let touch = closes * (1.0 - smoothstep((along + pushed - margin) / ROOM));
    Some(Creased { by: bend.posed_along * (side * pushed * closes), touch })
}
