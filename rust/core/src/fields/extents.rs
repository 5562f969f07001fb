//! How wide and how high the field of a joint is.

use crate::fields::joint::Fields;
use crate::fields::profile::BELL_WIDTH;

/// Measures of fields of one kind. A radius is how far from the joint the skin lies that blends there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extents {
    /// A joint is as long as its bone, but at least and at most so many radii.
    pub radii: [f64; 2],
    /// Skin that rests farther from the joint than so many of its lengths is not moved.
    pub reach: f64,
    /// Most that one field moves a point, in joint lengths: what is beyond it goes to a wider field.
    pub displacement_max: f64,
    /// Volume of a joint's vicinity over its length cubed: what a loss is compared with to fold.
    pub vicinity_volume: f64,
}

/// Bells reach the skin, and a correction stays at its joint on long thin limbs.
const PLAIN: Extents = Extents { radii: [1.0 / BELL_WIDTH, 2.0 / BELL_WIDTH], reach: 1.25, displacement_max: 0.08, vicinity_volume: 0.1 };

/// Flesh gives way over several radii, however long its bones are; what is narrower and higher tears skin that a bend has stretched.
const EVEN: Extents = Extents { radii: [10.0, 10.0], reach: 1.5, displacement_max: 0.02, vicinity_volume: 0.0125 };

impl Fields {
    pub(crate) fn extents(self) -> &'static Extents {
        match self {
            Self::Plain => &PLAIN,
            Self::Even => &EVEN,
        }
    }
}
