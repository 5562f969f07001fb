//! Vectors of eight points side by side, in single precision.
//!
//! Not through `map` or iterators over arrays of these: they are not compiled for the instruction set of the caller.

use std::ops::{Add, Sub};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f64x4};
use glam::{DMat3, DVec3};

use crate::numeric::block_rows::{Block, LANES};
use crate::numeric::lanes::{Four, V4, rows};

/// Eight vectors: one to a lane.
#[derive(Clone, Copy)]
pub(super) struct Eight<S: Simd> {
    pub x: f32x8<S>,
    pub y: f32x8<S>,
    pub z: f32x8<S>,
}

impl<S: Simd> Eight<S> {
    /// The same vector everywhere.
    #[inline(always)]
    pub fn splat(simd: S, [x, y, z]: [f32; 3]) -> Self {
        Self { x: f32x8::splat(simd, x), y: f32x8::splat(simd, y), z: f32x8::splat(simd, z) }
    }

    /// From rows of coordinates.
    #[inline(always)]
    pub fn of(simd: S, [x, y, z]: &[Block<f32>; 3]) -> Self {
        Self { x: f32x8::simd_from(simd, *x), y: f32x8::simd_from(simd, *y), z: f32x8::simd_from(simd, *z) }
    }

    /// From vectors that follow one another, told from `origin`.
    #[inline(always)]
    pub fn of_rows(simd: S, [a, b, c, d, e, f, g, h]: &[V4; LANES], origin: DVec3) -> Self {
        Self::narrowed(simd, Four::of_rows(simd, [a, b, c, d]), Four::of_rows(simd, [e, f, g, h]), origin)
    }

    /// From coordinates of points that follow one another: their images.
    #[inline(always)]
    pub fn images(simd: S, m: &DMat3, rows: [&Block<f64>; 3]) -> Self {
        let (early, late) = (half_of(simd, rows, 0), half_of(simd, rows, 1));
        Self::narrowed(simd, image(m, early), image(m, late), DVec3::ZERO)
    }

    #[inline(always)]
    fn narrowed(simd: S, early: Four<S>, late: Four<S>, origin: DVec3) -> Self {
        let origin = Four::of_lanes([f64x4::splat(simd, origin.x), f64x4::splat(simd, origin.y), f64x4::splat(simd, origin.z)]);
        let ([x, y, z], [late_x, late_y, late_z]) = ((early - origin).coordinates(), (late - origin).coordinates());
        Self { x: x.narrow(late_x), y: y.narrow(late_y), z: z.narrow(late_z) }
    }

    /// (x, y, z, 0) of each.
    #[inline(always)]
    pub fn rows(self, simd: S) -> [[f32; 4]; LANES] {
        let ((x, late_x), (y, late_y), (z, late_z)) = (self.x.split(), self.y.split(), self.z.split());
        let ([a, b, c, d], [e, f, g, h]) = (rows(simd, [x, y, z]), rows(simd, [late_x, late_y, late_z]));
        [a.into(), b.into(), c.into(), d.into(), e.into(), f.into(), g.into(), h.into()]
    }

    #[inline(always)]
    pub fn dot(self, [x, y, z]: [f32; 3]) -> f32x8<S> {
        self.x * x + self.y * y + self.z * z
    }

    #[inline(always)]
    pub fn scale(self, by: f32x8<S>) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// One vector, so far in each lane.
    #[inline(always)]
    pub fn along([x, y, z]: [f32; 3], far: f32x8<S>) -> Self {
        Self { x: far * x, y: far * y, z: far * z }
    }

    /// Images under columns.
    #[inline(always)]
    pub fn image(self, [a, b, c]: &[[f32; 3]; 3]) -> Self {
        Self::along(*a, self.x) + Self::along(*b, self.y) + Self::along(*c, self.z)
    }

    /// Cross product of an axis with each.
    #[inline(always)]
    pub fn crossed_by(self, [x, y, z]: [f32; 3]) -> Self {
        Self { x: self.z * y - self.y * z, y: self.x * z - self.z * x, z: self.y * x - self.x * y }
    }

    /// Turned about a unit axis, less themselves.
    #[inline(always)]
    pub fn turned(self, axis: [f32; 3], angle: f32x8<S>) -> Self {
        let (sine, versine) = sine_and_versine(angle);
        let across = self.crossed_by(axis);
        across.scale(sine) + across.crossed_by(axis).scale(versine)
    }
}

impl<S: Simd> Add for Eight<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl<S: Simd> Sub for Eight<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

/// The first or second four of eight points.
#[inline(always)]
fn half_of<S: Simd>(simd: S, [x, y, z]: [&Block<f64>; 3], half: usize) -> Four<S> {
    Four::of_coordinates(simd, [&x.as_chunks().0[half], &y.as_chunks().0[half], &z.as_chunks().0[half]])
}

#[inline(always)]
fn image<S: Simd>(m: &DMat3, points: Four<S>) -> Four<S> {
    let [x, y, z] = points.coordinates();
    let [a, b, c] = [m.x_axis, m.y_axis, m.z_axis];
    Four::of_lanes([x * a.x + y * b.x + z * c.x, x * a.y + y * b.y + z * c.y, x * a.z + y * b.z + z * c.z])
}

#[inline(always)]
pub(super) fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

/// Columns.
#[inline(always)]
pub(super) fn single3(m: &DMat3) -> [[f32; 3]; 3] {
    [single(m.x_axis), single(m.y_axis), single(m.z_axis)]
}

/// Held in a range.
#[inline(always)]
pub(super) fn held<S: Simd>(x: f32x8<S>, low: f32, high: f32) -> f32x8<S> {
    let simd = x.token();
    x.max(f32x8::splat(simd, low)).min(f32x8::splat(simd, high))
}

/// 3x² − 2x³, held at its ends.
#[inline(always)]
pub(super) fn smooth<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let x = held(x, 0.0, 1.0);
    x * x * (-x * 2.0 + 3.0)
}

/// sin x and 1 − cos x of angles in −180°..180°, by series of their halves: to their last digits.
#[inline(always)]
pub(super) fn sine_and_versine<S: Simd>(angle: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
    let half = angle * 0.5;
    let square = half * half;
    let sine = square * (-1.0 / 39_916_800.0) + 1.0 / 362_880.0;
    let sine = square * (square * (square * sine + -1.0 / 5040.0) + 1.0 / 120.0) + -1.0 / 6.0;
    let sine = half * (square * sine + 1.0);
    let cosine = square * (1.0 / 479_001_600.0) + -1.0 / 3_628_800.0;
    let cosine = square * (square * (square * cosine + 1.0 / 40_320.0) + -1.0 / 720.0) + 1.0 / 24.0;
    let cosine = square * (square * cosine + -0.5) + 1.0;
    (sine * cosine * 2.0, sine * sine * 2.0)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn series_are_sines(angle in -std::f32::consts::PI..std::f32::consts::PI) {
            let (sine, versine): (Block<f32>, Block<f32>) = dispatch!(Level::new(), simd => {
                let (sine, versine) = sine_and_versine(f32x8::splat(simd, angle));
                (sine.into(), versine.into())
            });
            let angle = f64::from(angle);
            prop_assert!((f64::from(sine[0]) - angle.sin()).abs() < 3e-7);
            // Up to 2, where a last digit is 2.4e-7.
            prop_assert!((f64::from(versine[0]) - (1.0 - angle.cos())).abs() < 1e-6);
        }
    }
}
