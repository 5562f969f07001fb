//! The fields of one patch, in single precision, whole lanes of points at a time.
//!
//! Single precision is enough: what a field adds is measured in double precision on the moved points afterwards.

use multiversion::multiversion;

use crate::correction::{Field, FieldFrame};
use crate::patches::{LANES, PATCH_POINTS};
use crate::profile::{BELL_END, BELL_WIDTH};

/// One number per owned point of a patch.
pub(crate) type Row = [f32; PATCH_POINTS];

/// Three coordinates of the points of one patch.
pub(crate) type Rows<'a> = [&'a [f32]; 3];
pub(crate) type RowsMut<'a> = [&'a mut [f32]; 3];

/// Squares and lengths of vectors.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
pub(crate) fn measure(vectors: Rows, squares: &mut Row, lengths: &mut Row) {
    let count = vectors[0].len();
    let [x, y, z] = vectors.map(|row| &row[..count]);
    let (squares, lengths) = (&mut squares[..count], &mut lengths[..count]);
    for i in 0..count {
        squares[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
        lengths[i] = squares[i].sqrt();
    }
}

/// Weights times the joint's bell at each place.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
pub(crate) fn bell_heights(weights: &[f32], places: Rows, frame: &FieldFrame, heights: &mut [f32]) {
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

/// Σ w·s and the largest w·l.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
pub(crate) fn sum_and_most(weights: &[f32], squares: &Row, lengths: &Row) -> (f64, f64) {
    let (mut sums, mut most) = ([0.0f32; LANES], [0.0f32; LANES]);
    let lanes = weights.as_chunks::<LANES>().0.iter();
    for ((w, s), l) in lanes.zip(squares.as_chunks::<LANES>().0).zip(lengths.as_chunks::<LANES>().0) {
        for i in 0..LANES {
            sums[i] += w[i] * s[i];
            let moved = w[i] * l[i];
            most[i] = if moved > most[i] { moved } else { most[i] };
        }
    }
    (sum(sums), largest(most))
}

/// Σ w·(g·e)² and the largest w·|g·e|.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
pub(crate) fn sum_and_most_along(weights: &[f32], gradient: Rows, axis: [f32; 3]) -> (f64, f64) {
    let (mut sums, mut most) = ([0.0f32; LANES], [0.0f32; LANES]);
    let [x, y, z] = gradient.map(|row| row.as_chunks::<LANES>().0);
    for (((w, x), y), z) in weights.as_chunks::<LANES>().0.iter().zip(x).zip(y).zip(z) {
        for i in 0..LANES {
            let slope = x[i] * axis[0] + y[i] * axis[1] + z[i] * axis[2];
            let moved = w[i] * slope.abs();
            sums[i] += moved * slope.abs();
            most[i] = if moved > most[i] { moved } else { most[i] };
        }
    }
    (sum(sums), largest(most))
}

/// Coefficients of the gradient in the field and in the residual's field, where they need no axes.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
pub(crate) fn add_round(field: &Field, sign: f32, weights: &[f32], heights: &[f32], coefficients: &mut Row, residual: &mut Row) {
    let count = weights.len();
    let (heights, coefficients, residual) = (&heights[..count], &mut coefficients[..count], &mut residual[..count]);
    let (bell, all) = (field.bell as f32, field.all as f32);
    for i in 0..count {
        let added = heights[i] * bell + weights[i] * all;
        coefficients[i] += added;
        residual[i] += added * sign;
    }
}

/// Displacements along the axes of a joint.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
pub(crate) fn add_shaped(field: &Field, sign: f32, heights: &[f32], gradient: Rows, moved: RowsMut, residual: RowsMut) {
    let count = heights.len();
    let m = field.shaped.as_mat3().to_cols_array();
    let [gx, gy, gz] = gradient.map(|row| &row[..count]);
    for (axis, (moved, residual)) in moved.into_iter().zip(residual).enumerate() {
        let (moved, residual) = (&mut moved[..count], &mut residual[..count]);
        let [a, b, c] = [m[axis], m[3 + axis], m[6 + axis]];
        for i in 0..count {
            let added = (gx[i] * a + gy[i] * b + gz[i] * c) * heights[i];
            moved[i] += added;
            residual[i] += added * sign;
        }
    }
}

/// Displacements along the gradient.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
pub(crate) fn add_along_gradient(coefficients: &Row, gradient: Rows, moved: RowsMut) {
    for (moved, gradient) in moved.into_iter().zip(gradient) {
        for ((moved, gradient), coefficient) in moved.iter_mut().zip(gradient).zip(coefficients) {
            *moved += gradient * coefficient;
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
