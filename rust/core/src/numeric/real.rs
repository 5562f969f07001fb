//! One number or eight side by side: formulas are written once, for the point that is bound and for the points of a frame.

use std::ops::{Add, Div, Mul, Neg, Sub};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use glam::DVec3;

/// Numbers that lie side by side.
pub(crate) const LANES: usize = 8;

/// Eight numbers, one to a lane.
pub(crate) type Lanes = [f64; LANES];

/// A number, or one per lane. Every operation rounds as IEEE 754 says, so lanes and single numbers give the same bits.
pub(crate) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant, in as many lanes as `self`.
    fn constant(self, value: f64) -> Self;
    fn sqrt(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// `yes` where self < other, else `no`.
    fn if_below(self, other: Self, yes: Self, no: Self) -> Self;
    /// True when self < other in every lane.
    fn is_below(self, other: Self) -> bool;
}

impl Real for f64 {
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn if_below(self, other: Self, yes: Self, no: Self) -> Self {
        if self < other { yes } else { no }
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> bool {
        self < other
    }
}

impl<S: Simd> Real for f64x8<S> {
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::splat(self.token(), value)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        SimdFloat::sqrt(self)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.simd_lt(other).select(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.simd_gt(other).select(self, other)
    }

    #[inline(always)]
    fn if_below(self, other: Self, yes: Self, no: Self) -> Self {
        self.simd_lt(other).select(yes, no)
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> bool {
        self.simd_lt(other).all_true()
    }
}

/// A vector of three.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vector<R> {
    pub x: R,
    pub y: R,
    pub z: R,
}

impl<R: Real> Vector<R> {
    #[inline(always)]
    pub fn dot(self, b: Self) -> R {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self { x: self.y * b.z - self.z * b.y, y: self.z * b.x - self.x * b.z, z: self.x * b.y - self.y * b.x }
    }
}

impl<R: Real> Add for Vector<R> {
    type Output = Self;

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl<R: Real> Sub for Vector<R> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

impl<R: Real> Mul<R> for Vector<R> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, s: R) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}

impl From<DVec3> for Vector<f64> {
    fn from(v: DVec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vector<f64>> for DVec3 {
    fn from(v: Vector<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

/// π/2 in three parts, the first two with trailing zeros, so that small multiples of them are exact.
const HALF_PI: [f64; 3] = [f64::from_bits(0x3FF9_21FB_5440_0000), f64::from_bits(0x3DD0_B461_1A60_0000), 2.022_266_248_795_950_6e-21];
/// 1.5 · 2⁵²: adding and subtracting it rounds to the nearest whole number.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine, to rounding for angles up to some thousands of turns.
#[inline(always)]
pub(crate) fn sine_cosine<R: Real>(angle: R) -> (R, R) {
    let zero = angle.constant(0.0);
    let one = angle.constant(1.0);
    let quarters = nearest_whole(angle * angle.constant(std::f64::consts::FRAC_2_PI));
    let r =
        ((angle - quarters * angle.constant(HALF_PI[0])) - quarters * angle.constant(HALF_PI[1])) - quarters * angle.constant(HALF_PI[2]);
    let square = r * r;
    let sine = r + r * square * series(&SINE, square);
    let cosine = one - square * series(&COSINE, square);
    // Which quarter turn: −2 … 2. Odd ones exchange sine and cosine.
    let quarter = quarters - angle.constant(4.0) * nearest_whole(quarters * angle.constant(0.25));
    let evenness = (quarter * quarter - one) * (quarter * quarter - one);
    let half = angle.constant(0.5);
    let (s, c) = (evenness.if_below(half, cosine, sine), evenness.if_below(half, sine, cosine));
    // Sine is turned over in quarters −2, −1 and 2, cosine in −2, 1 and 2.
    let signed_sine = quarter.if_below(zero, -s, angle.constant(1.5).if_below(quarter, -s, s));
    let signed_cosine = half.if_below(quarter, -c, quarter.if_below(angle.constant(-1.5), -c, c));
    (signed_sine, signed_cosine)
}

#[inline(always)]
fn nearest_whole<R: Real>(x: R) -> R {
    (x + x.constant(ROUNDING)) - x.constant(ROUNDING)
}

/// Taylor's: the first term left out is below 5e-17 for |r| ≤ π/4.
#[inline(always)]
fn series<R: Real>(coefficients: &[f64], square: R) -> R {
    let mut sum = square.constant(coefficients[0]);
    for &coefficient in &coefficients[1..] {
        sum = sum * square + square.constant(coefficient);
    }
    sum
}

/// sin r = r + r³ · Σ, from the last: −1/3!, 1/5!, …, −1/15!.
const SINE: [f64; 7] =
    [-1.0 / 1_307_674_368_000.0, 1.0 / 6_227_020_800.0, -1.0 / 39_916_800.0, 1.0 / 362_880.0, -1.0 / 5_040.0, 1.0 / 120.0, -1.0 / 6.0];
/// cos r = 1 − r² · Σ, from the last: 1/2!, −1/4!, …, −1/16!.
const COSINE: [f64; 8] = [
    -1.0 / 20_922_789_888_000.0,
    1.0 / 87_178_291_200.0,
    -1.0 / 479_001_600.0,
    1.0 / 3_628_800.0,
    -1.0 / 40_320.0,
    1.0 / 720.0,
    -1.0 / 24.0,
    1.0 / 2.0,
];

#[cfg(test)]
mod tests {
    use super::sine_cosine;

    #[test]
    fn sine_and_cosine_agree_with_the_library() {
        for i in -40_000..=40_000 {
            let angle = f64::from(i) * 0.001_7;
            let (sine, cosine) = sine_cosine(angle);
            assert!((sine - angle.sin()).abs() < 3e-16 && (cosine - angle.cos()).abs() < 3e-16, "{angle}");
        }
    }
}
