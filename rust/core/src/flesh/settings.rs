//! How much of the law of flesh a joint follows, as the artist says it.

use crate::error::{Error, Result};

/// The law of flesh at one joint.
///
/// It acts at joints of a tree: one with another above it, with skin that blends there, whose bone keeps its handedness. It
/// fades out where nothing sound can be said: over the last 30° before a bend or a twist of 180°, where a bone is sheared flat,
/// where a joint of a cut chain goes with another bone than the one it hangs on. Segments of a bone that bends, and skin
/// that another deformer fleshes, are left alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flesh {
    /// 0: none, skin is that of the blend, to the last bit; 1: all.
    pub amount: f64,
    /// What lies on the outside of a bend: 1 soft flesh, which follows to the inside; 0 bone right under the skin, which stays.
    /// `None`: by how near the joint lies to the outside at rest.
    pub outside: Option<f64>,
    /// 1: a twist is spread straight along the bone, from its joint to the next; 0: it lies where the weights blend.
    /// Bones that do not lead to another joint, or are not longer than thick, always do the latter.
    pub spread_twist: f64,
    /// 1: the inside of a bend closes on the plane that halves it; 0: skin passes through itself there as skinned.
    pub crease: f64,
}

impl Flesh {
    /// No law.
    pub const NONE: Self = Self { amount: 0.0, outside: None, spread_twist: 1.0, crease: 1.0 };

    /// All of it.
    pub const FULL: Self = Self { amount: 1.0, ..Self::NONE };

    /// Checks ranges.
    ///
    /// # Errors
    /// Anything beyond 0..1.
    pub(crate) fn checked(self) -> Result<Self> {
        let Self { amount, outside, spread_twist, crease } = self;
        let outside = outside.unwrap_or(0.0);
        for (what, found) in [("flesh", amount), ("outside", outside), ("spread_twist", spread_twist), ("crease", crease)] {
            if !(0.0..=1.0).contains(&found) {
                return Err(Error::Value { what, found, needed: "a number from 0 to 1" });
            }
        }
        Ok(self)
    }
}

impl Default for Flesh {
    fn default() -> Self {
        Self::NONE
    }
}
