//! Vectors padded to four lanes, the last one 0, and four such vectors side by side.

use std::ops::{Add, Sub};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x2, f64x4};
use glam::DVec3;

use crate::skinning::Columns;

/// (x, y, z, 0).
pub(crate) type V4 = [f64; 4];

pub(crate) const ZERO: V4 = [0.0; 4];

#[inline(always)]
pub(crate) fn from(v: DVec3) -> V4 {
    [v.x, v.y, v.z, 0.0]
}

#[inline(always)]
pub(crate) fn to(v: V4) -> DVec3 {
    DVec3::new(v[0], v[1], v[2])
}

#[inline(always)]
pub(crate) fn add(a: V4, b: V4) -> V4 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[inline(always)]
pub(crate) fn sub(a: V4, b: V4) -> V4 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

#[inline(always)]
pub(crate) fn mul(a: V4, b: V4) -> V4 {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
}

#[inline(always)]
pub(crate) fn scale(a: V4, s: f64) -> V4 {
    [a[0] * s, a[1] * s, a[2] * s, a[3] * s]
}

/// a + b·s.
#[inline(always)]
pub(crate) fn add_scaled(a: V4, b: V4, s: f64) -> V4 {
    add(a, scale(b, s))
}

#[inline(always)]
pub(crate) fn cross(a: V4, b: V4) -> V4 {
    yzx(sub(mul(a, yzx(b)), mul(yzx(a), b)))
}

/// Sum of the lanes.
#[inline(always)]
pub(crate) fn sum(a: V4) -> f64 {
    (a[0] + a[1]) + (a[2] + a[3])
}

#[inline(always)]
fn yzx(a: V4) -> V4 {
    [a[1], a[2], a[0], a[3]]
}

/// Image of a point under an affine map.
#[inline(always)]
pub(crate) fn transform(m: &Columns, p: V4) -> V4 {
    add_scaled(add_scaled(add_scaled(m[3], m[0], p[0]), m[1], p[1]), m[2], p[2])
}

/// Four vectors side by side: one to a lane.
#[derive(Clone, Copy)]
pub(crate) struct Four<S: Simd> {
    x: f64x4<S>,
    y: f64x4<S>,
    z: f64x4<S>,
}

impl<S: Simd> Four<S> {
    /// From rows of a buffer.
    #[inline(always)]
    pub fn gather(simd: S, rows: &[V4; 256], [a, b, c, d]: [u8; 4]) -> Self {
        let low = |i: u8| f64x2::simd_from(simd, [rows[usize::from(i)][0], rows[usize::from(i)][1]]);
        let high = |i: u8| f64x2::simd_from(simd, [rows[usize::from(i)][2], rows[usize::from(i)][3]]);
        let (xy_a, xy_b, xy_c, xy_d) = (low(a), low(b), low(c), low(d));
        Self {
            x: xy_a.zip_low(xy_b).combine(xy_c.zip_low(xy_d)),
            y: xy_a.zip_high(xy_b).combine(xy_c.zip_high(xy_d)),
            z: high(a).zip_low(high(b)).combine(high(c).zip_low(high(d))),
        }
    }

    /// Adds to rows of a buffer, one after the other: lanes may name the same row.
    #[inline(always)]
    pub fn scatter_add(self, simd: S, rows: &mut [V4; 256], [a, b, c, d]: [u8; 4]) {
        let ((x_ab, x_cd), (y_ab, y_cd), (z_ab, z_cd)) = (self.x.split(), self.y.split(), self.z.split());
        let none = f64x2::splat(simd, 0.0);
        let mut add = |i: u8, xy: f64x2<S>, z: f64x2<S>| {
            let row = &mut rows[usize::from(i)];
            *row = (f64x4::simd_from(simd, *row) + xy.combine(z)).into();
        };
        add(a, x_ab.zip_low(y_ab), z_ab.zip_low(none));
        add(b, x_ab.zip_high(y_ab), z_ab.zip_high(none));
        add(c, x_cd.zip_low(y_cd), z_cd.zip_low(none));
        add(d, x_cd.zip_high(y_cd), z_cd.zip_high(none));
    }

    #[inline(always)]
    pub fn scale(self, s: f64) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }

    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self { x: self.y * b.z - self.z * b.y, y: self.z * b.x - self.x * b.z, z: self.x * b.y - self.y * b.x }
    }

    #[inline(always)]
    pub fn dot(self, b: Self) -> f64x4<S> {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    /// Sum over the lanes.
    #[inline(always)]
    pub fn sum(self) -> V4 {
        [sum(self.x.into()), sum(self.y.into()), sum(self.z.into()), 0.0]
    }
}

impl<S: Simd> Add for Four<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl<S: Simd> Sub for Four<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}
