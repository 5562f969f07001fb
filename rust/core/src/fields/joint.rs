//! Settings of one joint, as the artist gives them.

use crate::error::{Error, LARGEST, Result};
use crate::fields::profile::Profile;
use crate::flesh::settings::Flesh;

/// Sizes, and losses that reach folded profiles: far beyond all use, and numbers in single precision still.
const SIZES: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
const LOSSES: std::ops::RangeInclusive<f64> = 1e-12..=1e12;
/// Most that a joint bulges beyond what it lost.
const FLEX_MAX: f64 = 10.0;
/// Largest factor on what is given back: a thousandfold extent.
pub(crate) const FACTOR_MAX: f64 = 1e9;

/// Refuses strengths that are negative, too large or no numbers.
pub(crate) fn check_strengths(what: &'static str, strengths: &[f64]) -> Result<()> {
    match strengths.iter().find(|s| !(0.0..=FACTOR_MAX).contains(*s)) {
        Some(&found) => Err(Error::Value { what, found, needed: "numbers from 0 to 1e9" }),
        None => Ok(()),
    }
}

/// How fields lie on the skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fields {
    /// Along the gradient of the volume, as in \[RHC09\]; less of each profile the farther from its joint.
    #[default]
    Plain,
    /// Along normals that are evened out: fine detail is carried along, not torn. Profiles act as they are drawn.
    Even,
}

/// How the volume to add is shared: parts of a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// Along e0 (the parent), e1 (axis of the bend), e2 (inside of the bend).
    pub axes: [f64; 3],
    /// By the least displacement: every axis by what it can take.
    pub automatic: f64,
}

impl Shares {
    /// All by the least displacement.
    pub const AUTOMATIC: Self = Self { axes: [0.0; 3], automatic: 1.0 };

    /// All along the axes.
    pub const fn along(axes: [f64; 3]) -> Self {
        Self { axes, automatic: 0.0 }
    }

    /// Parts that sum to 1.
    fn checked(self) -> Result<Self> {
        let Self { axes: [along, sideways, inside], automatic } = self;
        let parts = [along, sideways, inside, automatic];
        if let Some(&found) = parts.iter().find(|s| !(**s >= 0.0 && **s <= LARGEST)) {
            return Err(Error::Value { what: "shares", found, needed: "numbers from 0 to 1e15" });
        }
        let sum: f64 = parts.iter().sum();
        if sum <= 0.0 {
            return Err(Error::Value { what: "sum of shares", found: sum, needed: "at least one share above 0" });
        }
        Ok(Self { axes: self.axes.map(|s| s / sum), automatic: automatic / sum })
    }
}

impl Default for Shares {
    fn default() -> Self {
        Self::AUTOMATIC
    }
}

/// The three curves that shape a correction, along e0, e1, e2.
#[derive(Debug, Clone, PartialEq)]
pub struct Profiles {
    /// One curve per axis.
    pub axes: [Profile; 3],
    /// Curves they turn into as more is lost, and the loss, over the volume of the joint's vicinity, that reaches them.
    pub folded: Option<([Profile; 3], f64)>,
}

impl Profiles {
    /// The same with folds filled in, each curve of height 1.
    pub(crate) fn envelope(&self) -> Self {
        let filled = |axes: &[Profile; 3]| axes.each_ref().map(Profile::envelope);
        Self { axes: filled(&self.axes), folded: self.folded.as_ref().map(|(folded, loss)| (filled(folded), *loss)) }
    }
}

/// How the volume lost at the joint at the head of `bone` is given back.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Index into the skeleton.
    pub bone: usize,
    /// Parts of the volume.
    pub shares: Shares,
    /// `None`: the isotropic bell.
    pub profiles: Option<Profiles>,
    /// Part of the loss given back.
    pub strength: f64,
    /// Factor on the automatic length.
    pub size: f64,
    /// How far the joint's shape bulges beyond what was lost, as a muscle that is tensed: 1 is a tenth of the vicinity's volume,
    /// taken from all of the vicinity.
    pub flex: f64,
    /// The law of flesh.
    pub flesh: Flesh,
}

impl Joint {
    /// The isotropic preset, all given back.
    pub fn isotropic(bone: usize) -> Self {
        Self { bone, shares: Shares::AUTOMATIC, profiles: None, strength: 1.0, size: 1.0, flex: 0.0, flesh: Flesh::NONE }
    }

    /// Checks what can be checked without a mesh; shares are normalised to sum 1.
    ///
    /// # Errors
    /// Strength, size, flex or shares out of range, shares that are all 0.
    pub fn checked(mut self) -> Result<Self> {
        check_strengths("strength", &[self.strength])?;
        if !SIZES.contains(&self.size) {
            return Err(Error::Value { what: "size", found: self.size, needed: "a number from 1e-6 to 1e6" });
        }
        if !(0.0..=FLEX_MAX).contains(&self.flex) {
            return Err(Error::Value { what: "flex", found: self.flex, needed: "a number from 0 to 10" });
        }
        self.shares = self.shares.checked()?;
        self.flesh = self.flesh.checked()?;
        if let Some(Profiles { folded: Some((_, loss)), .. }) = &self.profiles
            && !LOSSES.contains(loss)
        {
            return Err(Error::Value { what: "folded_loss_relative", found: *loss, needed: "a number from 1e-12 to 1e12" });
        }
        Ok(self)
    }
}
