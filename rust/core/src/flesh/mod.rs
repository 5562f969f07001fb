//! The law of flesh: what near-incompressible flesh does that skinning does not, before volume is looked at [MATH §10].
//!
//! Twists turn skin by angle, spread along the bone; near a bend skin shifts to the inside, widens, and closes on the plane that
//! halves the bend. All of it follows from the pose and from what was bound at rest: nothing is remembered.

mod anatomy;
mod bend;
mod crease;
mod lanes;
mod limb;
mod neighbours;
pub(crate) mod settings;
pub(crate) mod shape;
mod turn;
mod twist;

pub(crate) use anatomy::{Anatomy, Parts};

/// 3x² − 2x³, held at its ends.
pub(crate) fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
