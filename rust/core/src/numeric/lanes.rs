//! Vectors padded to four lanes, the last one 0, and four such vectors side by side.

use std::ops::{Add, Sub};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f64x4};
use glam::{DAffine3, DMat3, DMat4, DVec3};

/// (x, y, z, 0).
pub(crate) type V4 = [f64; 4];

pub(crate) const ZERO: V4 = [0.0; 4];

/// The affine part of a matrix.
pub(crate) fn affine(m: &DMat4) -> DAffine3 {
    DAffine3 { matrix3: DMat3::from_mat4(*m), translation: m.w_axis.truncate() }
}

/// An affine map: images of the axes, and of 0.
pub(crate) type Columns = [V4; 4];

/// The columns of an affine map.
pub(crate) fn columns(m: &DAffine3) -> Columns {
    [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis, m.translation].map(from)
}

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

/// The same of a direction.
#[inline(always)]
pub(crate) fn linear(m: &Columns, v: V4) -> V4 {
    add_scaled(add_scaled(scale(m[0], v[0]), m[1], v[1]), m[2], v[2])
}

/// Four vectors side by side: one to a lane.
///
/// Not through `map` or iterators over arrays of these: they are not compiled for the instruction set of the caller.
#[derive(Clone, Copy)]
pub(crate) struct Four<S: Simd> {
    x: f64x4<S>,
    y: f64x4<S>,
    z: f64x4<S>,
}

impl<S: Simd> Four<S> {
    /// The same number everywhere.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        let lane = f64x4::splat(simd, value);
        Self { x: lane, y: lane, z: lane }
    }

    /// From coordinates of points that follow one another.
    #[inline(always)]
    pub fn of_coordinates(simd: S, [x, y, z]: [&[f64; 4]; 3]) -> Self {
        Self { x: f64x4::simd_from(simd, *x), y: f64x4::simd_from(simd, *y), z: f64x4::simd_from(simd, *z) }
    }

    #[inline(always)]
    pub fn of_lanes([x, y, z]: [f64x4<S>; 3]) -> Self {
        Self { x, y, z }
    }

    #[inline(always)]
    pub fn of_rows(simd: S, [a, b, c, d]: [&V4; 4]) -> Self {
        let (a, b) = (f64x4::simd_from(simd, *a), f64x4::simd_from(simd, *b));
        let (c, d) = (f64x4::simd_from(simd, *c), f64x4::simd_from(simd, *d));
        let ((x_ab, y_ab), (x_cd, y_cd)) = (a.zip_low(b).split(), c.zip_low(d).split());
        let (z_ab, z_cd) = (a.zip_high(b).split().0, c.zip_high(d).split().0);
        Self { x: x_ab.combine(x_cd), y: y_ab.combine(y_cd), z: z_ab.combine(z_cd) }
    }

    /// (x, y, z, 0) of each.
    #[inline(always)]
    pub fn rows(self, simd: S) -> [f64x4<S>; 4] {
        let none = f64x4::splat(simd, 0.0);
        let ((xy_a, xy_b), (xy_c, xy_d)) = (self.x.zip_low(self.y).split(), self.x.zip_high(self.y).split());
        let ((z_a, z_b), (z_c, z_d)) = (self.z.zip_low(none).split(), self.z.zip_high(none).split());
        [xy_a.combine(z_a), xy_b.combine(z_b), xy_c.combine(z_c), xy_d.combine(z_d)]
    }

    /// Lanes of each coordinate.
    #[inline(always)]
    pub fn coordinates(self) -> [f64x4<S>; 3] {
        [self.x, self.y, self.z]
    }

    /// From rows of a buffer.
    #[inline(always)]
    pub fn gather(simd: S, rows: &[V4; 256], [a, b, c, d]: [u8; 4]) -> Self {
        Self::of_rows(simd, [&rows[usize::from(a)], &rows[usize::from(b)], &rows[usize::from(c)], &rows[usize::from(d)]])
    }

    /// Adds to rows of a buffer, one after the other: lanes may name the same row.
    #[inline(always)]
    pub fn scatter_add(self, simd: S, rows: &mut [V4; 256], [a, b, c, d]: [u8; 4]) {
        let [to_a, to_b, to_c, to_d] = self.rows(simd);
        add_to(simd, &mut rows[usize::from(a)], to_a);
        add_to(simd, &mut rows[usize::from(b)], to_b);
        add_to(simd, &mut rows[usize::from(c)], to_c);
        add_to(simd, &mut rows[usize::from(d)], to_d);
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

#[inline(always)]
fn add_to<S: Simd>(simd: S, row: &mut V4, added: f64x4<S>) {
    *row = (f64x4::simd_from(simd, *row) + added).into();
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

/// Coordinates of four vectors (x, y, z, 0) in single precision.
#[inline(always)]
pub(crate) fn coordinates<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 3] {
    let (xy, xy_other) = (a.zip_low(c), b.zip_low(d));
    [xy.zip_low(xy_other), xy.zip_high(xy_other), a.zip_high(c).zip_low(b.zip_high(d))]
}

/// (x, y, z, 0) of four such vectors side by side.
#[inline(always)]
pub(crate) fn rows<S: Simd>(simd: S, [x, y, z]: [f32x4<S>; 3]) -> [f32x4<S>; 4] {
    let none = f32x4::splat(simd, 0.0);
    let (xz, xz_after) = (x.zip_low(z), x.zip_high(z));
    let (y, y_after) = (y.zip_low(none), y.zip_high(none));
    [xz.zip_low(y), xz.zip_high(y), xz_after.zip_low(y_after), xz_after.zip_high(y_after)]
}

/// The first where it is larger: numbers win over what is none.
#[inline(always)]
pub(crate) fn larger<S: Simd, V: SimdFloat<S>>(a: V, b: V) -> V {
    a.simd_gt(b).select(a, b)
}
