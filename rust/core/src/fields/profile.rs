//! 1D curves drawn by the artist, and the bell they default to [RHC09 §5, MATH §4].

use crate::error::{Error, Result};

/// Largest height: products of three are numbers in single precision still.
const HEIGHT_MAX: f64 = 1e6;

/// A curve over x in [-1, 1] of a joint's length, zero outside, from evenly spaced samples joined by straight lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    samples: Vec<f64>,
    half_steps: f64,
    /// Per step: its first height, and how much it rises, for whole lanes of points.
    lines: Vec<[f32; 2]>,
}

impl Profile {
    /// At least two samples; values below 0 count as 0.
    ///
    /// # Errors
    /// Fewer than two samples, or samples that are not finite, or above 1e6.
    pub fn new(samples: &[f64]) -> Result<Self> {
        if samples.len() < 2 {
            return Err(Error::Length { what: "profile", found: samples.len(), needed: 2 });
        }
        if let Some(row) = samples.iter().position(|s| !s.is_finite()) {
            return Err(Error::NotFinite { what: "profile", row });
        }
        if let Some(&found) = samples.iter().find(|s| **s > HEIGHT_MAX) {
            return Err(Error::Value { what: "profile", found, needed: "heights up to 1e6" });
        }
        Ok(Self::of(samples.iter().map(|s| s.max(0.0)).collect()))
    }

    fn of(samples: Vec<f64>) -> Self {
        let half_steps = (samples.len() - 1) as f64 / 2.0;
        let lines = samples.windows(2).map(|ends| [ends[0] as f32, (ends[1] - ends[0]) as f32]).collect();
        Self { samples, half_steps, lines }
    }

    /// The straight lines of the curve, from −1 to 1.
    pub(crate) fn lines(&self) -> &[[f32; 2]] {
        &self.lines
    }

    /// Largest slope, over the largest height: how steep a fold of height 1 would be. Slopes over an eighth of the joint's
    /// length: a drawn curve's small unevenness is no fold.
    pub(crate) fn steepness(&self) -> f64 {
        let step = (self.samples.len() / 16).max(1);
        let highest = self.samples.iter().copied().fold(0.0, f64::max);
        let steepest = self.samples.windows(step + 1).map(|w| (w[step] - w[0]).abs()).fold(0.0, f64::max);
        if highest > 0.0 { steepest * self.half_steps / (step as f64 * highest) } else { 0.0 }
    }

    /// The curve with the valleys between its highest places filled in, rising once and falling once, of height 1.
    pub(crate) fn envelope(&self) -> Self {
        let highest_so_far = |highest: &mut f64, &sample: &f64| {
            *highest = highest.max(sample);
            Some(*highest)
        };
        let highest = self.samples.iter().copied().fold(0.0, f64::max);
        let height = if highest > 0.0 { highest } else { 1.0 };
        let rising = self.samples.iter().scan(0.0, highest_so_far);
        let mut falling: Vec<f64> = self.samples.iter().rev().scan(0.0, highest_so_far).collect();
        falling.reverse();
        Self::of(rising.zip(falling).map(|(rise, fall)| rise.min(fall) / height).collect())
    }

    /// Length of the longest chords that keep within `error` of the curve: root of mean squares, over that of its heights.
    /// What the frequency of a wave asks for, a kink less.
    pub(crate) fn chord_length(&self, error: f64) -> f64 {
        let mut length = CHORD_MIN;
        while length < 2.0 {
            let found = self.chord_error(length);
            if found > error {
                return length * (error / found).sqrt();
            }
            length *= CHORD_STEP;
        }
        2.0
    }

    fn chord_error(&self, length: f64) -> f64 {
        let (mut errors, mut heights) = (0.0, 0.0);
        let span = 1.0 - length / 2.0;
        for place in 0..=CHORD_PLACES {
            let x = span * (2.0 * f64::from(place) / f64::from(CHORD_PLACES) - 1.0);
            let chord = 0.5 * (self.at(x - length / 2.0) + self.at(x + length / 2.0));
            errors += (self.at(x) - chord).powi(2);
            heights += self.at(x).powi(2);
        }
        if heights > 0.0 { (errors / heights).sqrt() } else { 0.0 }
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

/// Chords are looked at from this length on, each so much longer than the last, at so many places.
const CHORD_MIN: f64 = 0.015;
const CHORD_STEP: f64 = 1.1;
const CHORD_PLACES: i32 = 256;

/// Width of the isotropic bell in joint lengths.
pub(crate) const BELL_WIDTH: f64 = 0.25;
/// exp(−q) for q = |x|²/σ², to 4 % of its height, is (1 − q/8)⁸: it ends here, with seven smooth derivatives.
pub(crate) const BELL_END: f64 = 8.0;

/// The bell as a curve.
pub(crate) fn bell() -> Profile {
    let samples = (-64..=64).map(|step| {
        let x = f64::from(step) / 64.0;
        (1.0 - x * x / (BELL_WIDTH * BELL_WIDTH * BELL_END)).max(0.0).powi(8)
    });
    Profile::of(samples.collect())
}
