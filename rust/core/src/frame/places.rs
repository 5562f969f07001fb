//! Coordinates of all slots, row by row.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f64x4};

use crate::numeric::block_rows::LANES;
use crate::numeric::lanes::{Four, V4};
use crate::parallel::split::Ragged;

/// Three coordinates of all slots.
pub(super) type Coordinates = [Vec<f32>; 3];

/// Skinned positions of all slots about the palette's origin, each the sum of two: what fields need, and the rest of its
/// digits, to about 2⁻⁴⁹.
#[derive(Debug, Clone)]
pub(super) struct Places {
    pub near: Coordinates,
    pub rest: Coordinates,
}

impl Places {
    #[inline(always)]
    pub fn at(&self, slot: usize) -> V4 {
        let [x, y, z] = std::array::from_fn(|axis| f64::from(self.near[axis][slot]) + f64::from(self.rest[axis][slot]));
        [x, y, z, 0.0]
    }

    /// The same of eight slots side by side, the first of them a multiple of eight.
    #[inline(always)]
    pub fn eight<S: Simd>(&self, simd: S, number: usize) -> [Four<S>; 2] {
        let Self { near, rest } = self;
        let (x, y, z) =
            (sums(simd, &near[0], &rest[0], number), sums(simd, &near[1], &rest[1], number), sums(simd, &near[2], &rest[2], number));
        [Four::of_lanes([x.0, y.0, z.0]), Four::of_lanes([x.1, y.1, z.1])]
    }
}

#[inline(always)]
fn sums<S: Simd>(simd: S, near: &[f32], rest: &[f32], number: usize) -> (f64x4<S>, f64x4<S>) {
    let of = |row: &[f32]| f32x8::simd_from(simd, row.as_chunks::<LANES>().0[number]).widen();
    let (near, rest) = (of(near), of(rest));
    (near.0 + rest.0, near.1 + rest.1)
}

/// Rows of patches.
pub(super) fn ragged<'a>(coordinates: &'a mut Coordinates, offsets: &'a [u32]) -> [Ragged<'a, f32>; 3] {
    coordinates.each_mut().map(|row| Ragged::new(row, offsets))
}
