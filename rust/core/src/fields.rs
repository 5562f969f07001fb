//! The fields of one patch, in single precision, whole lanes of points at a time.
//!
//! Single precision is enough: what a field adds is measured in double precision on the moved points afterwards.

use fearless_simd::{Level, Simd, dispatch};

use crate::correction::{Field, FieldFrame};
use crate::patches::{LANES, PATCH_POINTS};
use crate::profile::{BELL_END, BELL_WIDTH};

/// One number per owned point of a patch.
pub(crate) type Row = [f32; PATCH_POINTS];

/// Three coordinates of the points of one patch.
pub(crate) type Rows<'a> = [&'a [f32]; 3];

/// Directions of displacements: the gradient g of a point of rest area A, made less where skin is stretched or compressed.
///
/// Without this a point moves by |g|/A: stretched skin, an armpit, would grow fins, and a crease be pushed into itself.
/// With q = |g|/A, 1 on skin as at rest, 2q/(1 + q²) of it is left: at most twice as far, and hardly at all in a crease.
/// Also the volume each direction adds by its length, and the length.
pub(crate) fn directions(gradient: Rows, inverse_areas: &[f32], directions: &mut [Row; 3], volumes: &mut Row, lengths: &mut Row) {
    dispatch!(Level::new(), simd => directions_by_lanes(simd, gradient, inverse_areas, directions, volumes, lengths));
}

#[inline(always)]
fn directions_by_lanes<S: Simd>(
    _: S,
    gradient: Rows,
    inverse_areas: &[f32],
    directions: &mut [Row; 3],
    volumes: &mut Row,
    lengths: &mut Row,
) {
    let count = inverse_areas.len();
    let [x, y, z] = gradient.map(|row| &row[..count]);
    let [dx, dy, dz] = directions.each_mut().map(|row| &mut row[..count]);
    let (volumes, lengths) = (&mut volumes[..count], &mut lengths[..count]);
    for i in 0..count {
        let square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
        let length = square.sqrt();
        let q = length * inverse_areas[i];
        let left = 2.0 * q / (1.0 + q * q);
        (dx[i], dy[i], dz[i]) = (x[i] * left, y[i] * left, z[i] * left);
        (volumes[i], lengths[i]) = (square * left, length * left);
    }
}

/// Weights times the joint's bell at each place.
pub(crate) fn bell_heights(weights: &[f32], places: Rows, frame: &FieldFrame, heights: &mut [f32]) {
    dispatch!(Level::new(), simd => bell_heights_by_lanes(simd, weights, places, frame, heights));
}

#[inline(always)]
fn bell_heights_by_lanes<S: Simd>(_: S, weights: &[f32], places: Rows, frame: &FieldFrame, heights: &mut [f32]) {
    let count = weights.len();
    let [x, y, z] = places.map(|row| &row[..count]);
    let heights = &mut heights[..count];
    let [a, b, c] = frame.origin.as_vec3().to_array();
    let narrowness = (frame.inverse_length * frame.inverse_length / (BELL_WIDTH * BELL_WIDTH * BELL_END)) as f32;
    for i in 0..count {
        let (u, v, w) = (x[i] - a, y[i] - b, z[i] - c);
        let base = 1.0 - (u * u + v * v + w * w) * narrowness;
        let base = if base > 0.0 { base } else { 0.0 };
        let square = base * base;
        let fourth = square * square;
        heights[i] = weights[i] * (fourth * fourth);
    }
}

/// Σ w·v and the largest w·l.
pub(crate) fn sum_and_most(weights: &[f32], volumes: &Row, lengths: &Row) -> (f64, f64) {
    dispatch!(Level::new(), simd => sum_and_most_by_lanes(simd, weights, volumes, lengths))
}

#[inline(always)]
fn sum_and_most_by_lanes<S: Simd>(_: S, weights: &[f32], volumes: &Row, lengths: &Row) -> (f64, f64) {
    let (mut sums, mut most) = ([0.0f32; LANES], [0.0f32; LANES]);
    let lanes = weights.as_chunks::<LANES>().0.iter();
    for ((w, v), l) in lanes.zip(volumes.as_chunks::<LANES>().0).zip(lengths.as_chunks::<LANES>().0) {
        for i in 0..LANES {
            sums[i] += w[i] * v[i];
            let moved = w[i] * l[i];
            most[i] = if moved > most[i] { moved } else { most[i] };
        }
    }
    (sum(sums), largest(most))
}

/// Σ w·(g·e)(d·e) and the largest w·|d·e|.
pub(crate) fn sum_and_most_along(weights: &[f32], gradient: Rows, directions: &[Row; 3], axis: [f32; 3]) -> (f64, f64) {
    dispatch!(Level::new(), simd => sum_and_most_along_by_lanes(simd, weights, gradient, directions, axis))
}

#[inline(always)]
fn sum_and_most_along_by_lanes<S: Simd>(_: S, weights: &[f32], gradient: Rows, directions: &[Row; 3], axis: [f32; 3]) -> (f64, f64) {
    let (mut sums, mut most) = ([0.0f32; LANES], [0.0f32; LANES]);
    let [x, y, z] = gradient.map(|row| row.as_chunks::<LANES>().0);
    let [dx, dy, dz] = directions.each_ref().map(|row| row.as_chunks::<LANES>().0);
    for (chunk, w) in weights.as_chunks::<LANES>().0.iter().enumerate() {
        for i in 0..LANES {
            let slope = x[chunk][i] * axis[0] + y[chunk][i] * axis[1] + z[chunk][i] * axis[2];
            let along = dx[chunk][i] * axis[0] + dy[chunk][i] * axis[1] + dz[chunk][i] * axis[2];
            let moved = w[i] * along.abs();
            sums[i] += moved * slope.abs();
            most[i] = if moved > most[i] { moved } else { most[i] };
        }
    }
    (sum(sums), largest(most))
}

/// What the fields of a patch and the residual's field add to its points.
#[repr(align(64))]
pub(crate) struct PatchFields {
    /// Factors on the directions: what needs no axes.
    by_gradient: Row,
    residual_by_gradient: Row,
    moved: [Row; 3],
    residual: [Row; 3],
}

impl PatchFields {
    pub fn new() -> Self {
        let none = [0.0; PATCH_POINTS];
        Self { by_gradient: none, residual_by_gradient: none, moved: [none; 3], residual: [none; 3] }
    }

    #[inline]
    pub fn moved(&self, i: usize) -> [f32; 4] {
        [self.moved[0][i], self.moved[1][i], self.moved[2][i], 0.0]
    }

    #[inline]
    pub fn residual(&self, i: usize) -> [f32; 4] {
        [self.residual[0][i], self.residual[1][i], self.residual[2][i], 0.0]
    }

    /// The field of the whole shell.
    pub fn add_wide(&mut self, inverse_areas: &[f32], field: f64, residual: f64) {
        let (field, residual) = (field as f32, residual as f32);
        for ((moved, rest), area) in self.by_gradient.iter_mut().zip(&mut self.residual_by_gradient).zip(inverse_areas) {
            *moved += area * field;
            *rest += area * residual;
        }
    }

    /// What a joint gives without axes: by its bell, and by all of its vicinity.
    pub fn add_round(&mut self, field: &Field, sign: f32, weights: &[f32], bell: &[f32]) {
        add_factors(field, sign, weights, bell, &mut self.by_gradient, &mut self.residual_by_gradient);
    }

    /// What a joint gives along its axes.
    pub fn add_shaped(&mut self, field: &Field, sign: f32, heights: &[f32], directions: &[Row; 3]) {
        add_along_axes(field, sign, heights, directions.each_ref().map(|row| &row[..]), &mut self.moved, &mut self.residual);
    }

    /// Ends the sums: adds what needs no axes.
    pub fn add_along(&mut self, directions: &[Row; 3]) {
        let gradient = directions.each_ref().map(|row| &row[..]);
        add_along_gradient(&self.by_gradient, gradient, &mut self.moved);
        add_along_gradient(&self.residual_by_gradient, gradient, &mut self.residual);
    }
}

fn add_factors(field: &Field, sign: f32, weights: &[f32], heights: &[f32], by_gradient: &mut Row, residual: &mut Row) {
    dispatch!(Level::new(), simd => add_factors_by_lanes(simd, field, sign, weights, heights, by_gradient, residual));
}

#[inline(always)]
fn add_factors_by_lanes<S: Simd>(
    _: S,
    field: &Field,
    sign: f32,
    weights: &[f32],
    heights: &[f32],
    by_gradient: &mut Row,
    residual: &mut Row,
) {
    let count = weights.len();
    let (heights, by_gradient, residual) = (&heights[..count], &mut by_gradient[..count], &mut residual[..count]);
    let (bell, all) = (field.bell as f32, field.all as f32);
    for i in 0..count {
        let added = heights[i] * bell + weights[i] * all;
        by_gradient[i] += added;
        residual[i] += added * sign;
    }
}

fn add_along_axes(field: &Field, sign: f32, heights: &[f32], gradient: Rows, moved: &mut [Row; 3], residual: &mut [Row; 3]) {
    dispatch!(Level::new(), simd => add_along_axes_by_lanes(simd, field, sign, heights, gradient, moved, residual));
}

#[inline(always)]
fn add_along_axes_by_lanes<S: Simd>(
    _: S,
    field: &Field,
    sign: f32,
    heights: &[f32],
    gradient: Rows,
    moved: &mut [Row; 3],
    residual: &mut [Row; 3],
) {
    let count = heights.len();
    let m = field.shaped.as_mat3().to_cols_array();
    let [gx, gy, gz] = gradient.map(|row| &row[..count]);
    for (axis, (moved, residual)) in moved.iter_mut().zip(residual).enumerate() {
        let (moved, residual) = (&mut moved[..count], &mut residual[..count]);
        let [a, b, c] = [m[axis], m[3 + axis], m[6 + axis]];
        for i in 0..count {
            let added = (gx[i] * a + gy[i] * b + gz[i] * c) * heights[i];
            moved[i] += added;
            residual[i] += added * sign;
        }
    }
}

fn add_along_gradient(factors: &Row, gradient: Rows, moved: &mut [Row; 3]) {
    dispatch!(Level::new(), simd => add_along_gradient_by_lanes(simd, factors, gradient, moved));
}

#[inline(always)]
fn add_along_gradient_by_lanes<S: Simd>(_: S, factors: &Row, gradient: Rows, moved: &mut [Row; 3]) {
    for (moved, gradient) in moved.iter_mut().zip(gradient) {
        for ((moved, gradient), factor) in moved.iter_mut().zip(gradient).zip(factors) {
            *moved += gradient * factor;
        }
    }
}

#[inline(always)]
fn sum(lanes: [f32; LANES]) -> f64 {
    let [a, b, c, d, e, f, g, h] = lanes.map(f64::from);
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

#[inline(always)]
fn largest(lanes: [f32; LANES]) -> f64 {
    f64::from(lanes.into_iter().fold(0.0, f32::max))
}
