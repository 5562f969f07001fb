//! Fleshing: bends points along a spine, every chunk keeping its volume [ZR13, MATH §5].

mod arc_length;
mod b_spline;
mod bound_points;
mod cells;
mod closest;
mod curve;
mod fleshing;
mod flow;
mod frames;
mod imported_curve;
mod interpolation;
mod matching;
mod pieces;
mod planar;
mod polynomial;
mod quintic;
mod twist;
mod validity;

pub use b_spline::KnotFlags;
pub use curve::{ClosestPoint, Method, Parameters, Resolution, Spine};
pub use fleshing::{Flesh, FleshFrame, Fleshing, FleshingReport};
pub use matching::Match;
pub use planar::{Blend, Kind};
pub use twist::Twist;
pub use validity::Validity;
