//! 1D curves drawn by the artist, and the bell they default to [RHC09 §5, MATH §4].

use crate::error::{Error, Result};

/// A curve over x in [-1, 1] of a joint's length, zero outside, from evenly spaced samples joined by straight lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    samples: Vec<f64>,
    half_steps: f64,
}

impl Profile {
    /// At least two samples; values below 0 count as 0.
    ///
    /// # Errors
    /// Fewer than two samples, or samples that are not finite.
    pub fn new(samples: &[f64]) -> Result<Self> {
        if samples.len() < 2 {
            return Err(Error::Length { what: "profile", found: samples.len(), needed: 2 });
        }
        if let Some(row) = samples.iter().position(|s| !s.is_finite()) {
            return Err(Error::NotFinite { what: "profile", row });
        }
        let half_steps = (samples.len() - 1) as f64 / 2.0;
        Ok(Self { samples: samples.iter().map(|s| s.max(0.0)).collect(), half_steps })
    }

    /// Largest slope, over the largest height: how steep a fold of height 1 would be. Slopes over an eighth of the joint's
    /// length: a drawn curve's small unevenness is no fold.
    pub(crate) fn steepness(&self) -> f64 {
        let step = (self.samples.len() / 16).max(1);
        let highest = self.samples.iter().copied().fold(0.0, f64::max);
        let steepest = self.samples.windows(step + 1).map(|w| (w[step] - w[0]).abs()).fold(0.0, f64::max);
        if highest > 0.0 { steepest * self.half_steps / (step as f64 * highest) } else { 0.0 }
    }

    /// Height at x.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        if !(x > -1.0 && x < 1.0) {
            return 0.0;
        }
        let place = (x + 1.0) * self.half_steps;
        let index = (place as usize).min(self.samples.len() - 2);
        let (low, high) = (self.samples[index], self.samples[index + 1]);
        low + (high - low) * (place - index as f64)
    }
}

/// Width of the isotropic bell in joint lengths.
pub(crate) const BELL_WIDTH: f64 = 0.25;
/// exp(−q) for q = |x|²/σ², to 4 % of its height, is (1 − q/8)⁸: it ends here, with seven smooth derivatives.
pub(crate) const BELL_END: f64 = 8.0;
