//! The fields of one patch, in single precision, whole lanes of points at a time.
//!
//! Single precision is enough: what a field adds is measured in double precision on the moved points afterwards.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x4, f32x8};

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

/// Multiplies the directions, volumes and lengths of points by what a mask leaves them.
pub(crate) fn mask(mask: &[f32], directions: &mut [Row; 3], volumes: &mut Row, lengths: &mut Row) {
    dispatch!(Level::new(), simd => mask_by_lanes(simd, mask, directions, volumes, lengths));
}

#[inline(always)]
fn mask_by_lanes<S: Simd>(_: S, mask: &[f32], directions: &mut [Row; 3], volumes: &mut Row, lengths: &mut Row) {
    for row in directions.iter_mut().chain([volumes, lengths]) {
        for (value, m) in row[..mask.len()].iter_mut().zip(mask) {
            *value *= m;
        }
    }
}

/// Weights times the joint's bell at each place.
pub(crate) fn bell_heights(weights: &[f32], places: Rows, frame: &FieldFrame, heights: &mut [f32]) {
    dispatch!(Level::new(), simd => bell_heights_by_lanes(simd, weights, places, frame, heights));
}

#[inline(always)]
fn bell_heights_by_lanes<S: Simd>(simd: S, weights: &[f32], places: Rows, frame: &FieldFrame, heights: &mut [f32]) {
    let bell = Bell::new(simd, places, frame);
    for (number, (weights, heights)) in weights.as_chunks().0.iter().zip(heights.as_chunks_mut().0).enumerate() {
        *heights = bell.times(simd, weights, number).into();
    }
}

/// A joint's bell over the points of one patch, eight at a time.
struct Bell<'a, S: Simd> {
    places: [&'a [[f32; LANES]]; 3],
    origin: [f32x8<S>; 3],
    narrowness: f32,
}

impl<'a, S: Simd> Bell<'a, S> {
    #[inline(always)]
    fn new(simd: S, [x, y, z]: Rows<'a>, frame: &FieldFrame) -> Self {
        let [a, b, c] = frame.origin.as_vec3().to_array();
        Self {
            places: [x.as_chunks().0, y.as_chunks().0, z.as_chunks().0],
            origin: [f32x8::splat(simd, a), f32x8::splat(simd, b), f32x8::splat(simd, c)],
            narrowness: (frame.inverse_length * frame.inverse_length / (BELL_WIDTH * BELL_WIDTH * BELL_END)) as f32,
        }
    }

    /// Weights times the heights at the points of a chunk.
    #[inline(always)]
    fn times(&self, simd: S, weights: &[f32; LANES], number: usize) -> f32x8<S> {
        let u = f32x8::simd_from(simd, self.places[0][number]) - self.origin[0];
        let v = f32x8::simd_from(simd, self.places[1][number]) - self.origin[1];
        let w = f32x8::simd_from(simd, self.places[2][number]) - self.origin[2];
        let (none, all) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let base = all - (u * u + v * v + w * w) * self.narrowness;
        let base = base.simd_gt(none).select(base, none);
        let square = base * base;
        let fourth = square * square;
        f32x8::simd_from(simd, *weights) * (fourth * fourth)
    }
}

/// Weights times the joint's bell at each place; Σ w·v and the largest w·l of the weights, and of the heights.
pub(crate) fn bell_sums(
    weights: &[f32],
    places: Rows,
    frame: &FieldFrame,
    volumes: &Row,
    lengths: &Row,
    heights: &mut [f32],
) -> [(f64, f64); 2] {
    dispatch!(Level::new(), simd => bell_sums_by_lanes(simd, weights, places, frame, volumes, lengths, heights))
}

#[inline(always)]
fn bell_sums_by_lanes<S: Simd>(
    simd: S,
    weights: &[f32],
    places: Rows,
    frame: &FieldFrame,
    volumes: &Row,
    lengths: &Row,
    heights: &mut [f32],
) -> [(f64, f64); 2] {
    let bell = Bell::new(simd, places, frame);
    let (volumes, lengths) = (volumes.as_chunks::<LANES>().0, lengths.as_chunks::<LANES>().0);
    let none = f32x8::splat(simd, 0.0);
    let (mut sum, mut most) = (none, none);
    let (mut bell_sum, mut bell_most) = (none, none);
    for (number, (weights, heights)) in weights.as_chunks().0.iter().zip(heights.as_chunks_mut().0).enumerate() {
        let (volume, length) = (f32x8::simd_from(simd, volumes[number]), f32x8::simd_from(simd, lengths[number]));
        let all = f32x8::simd_from(simd, *weights);
        let round = bell.times(simd, weights, number);
        *heights = round.into();
        sum += all * volume;
        bell_sum += round * volume;
        most = larger(all * length, most);
        bell_most = larger(round * length, bell_most);
    }
    [(sum_of(sum.into()), largest(most.into())), (sum_of(bell_sum.into()), largest(bell_most.into()))]
}

/// The first where it is larger: numbers win over what is none.
#[inline(always)]
fn larger<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
    a.simd_gt(b).select(a, b)
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
    (sum_of(sums), largest(most))
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
    (sum_of(sums), largest(most))
}

/// How one point moves, (x, y, z, 0): on one cache line, since sweeps and vertices pick points one by one.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(32))]
pub(crate) struct Move {
    /// By the fields.
    pub by: [f32; 4],
    /// By a unit of the residual's field.
    pub residual: [f32; 4],
}

impl Move {
    /// `by`, then `residual`.
    #[inline(always)]
    pub fn lanes<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x4::simd_from(simd, self.by).combine(f32x4::simd_from(simd, self.residual))
    }
}

/// Rows of one patch that every sum of fields needs.
pub(crate) struct FieldRows {
    pub directions: [Row; 3],
    pub volumes: Row,
    pub lengths: Row,
    /// Volumes without the mask.
    pub unmasked: Row,
    pub bell: Row,
}

/// What the fields of a patch and the residual's field add to its points.
pub(crate) struct FieldSum {
    count: usize,
    /// Factors on the directions: what needs no axes.
    by_gradient: Row,
    residual_by_gradient: Row,
    /// Whether some field has axes: the rest stands only then.
    is_shaped: bool,
    moved: [Row; 3],
    residual: [Row; 3],
}

const NO_ROW: Row = [0.0; PATCH_POINTS];

impl FieldRows {
    pub const fn new() -> Self {
        Self { directions: [NO_ROW; 3], volumes: NO_ROW, lengths: NO_ROW, unmasked: NO_ROW, bell: NO_ROW }
    }
}

impl FieldSum {
    pub const fn new() -> Self {
        let (moved, residual) = ([NO_ROW; 3], [NO_ROW; 3]);
        Self { count: 0, by_gradient: NO_ROW, residual_by_gradient: NO_ROW, is_shaped: false, moved, residual }
    }

    /// Begins with the field of the whole shell: so much of it, and of it for the residual.
    pub fn start(&mut self, inverse_areas: &[f32], shell: [f64; 2]) {
        self.count = inverse_areas.len();
        self.is_shaped = false;
        let [field, residual] = shell.map(|s| s as f32);
        for ((moved, rest), area) in self.by_gradient.iter_mut().zip(&mut self.residual_by_gradient).zip(inverse_areas) {
            *moved = area * field;
            *rest = area * residual;
        }
    }

    /// What a joint gives without axes: by its bell, and by all of its vicinity. Leaves weights times the bell in `heights`.
    pub fn add_round(&mut self, field: &Field, sign: f32, frame: &FieldFrame, weights: &[f32], places: Rows, heights: &mut [f32]) {
        let sums = [&mut self.by_gradient, &mut self.residual_by_gradient];
        dispatch!(Level::new(), simd => add_round_by_lanes(simd, field, sign, frame, weights, places, heights, sums));
    }

    /// What a joint gives along its axes.
    pub fn add_shaped(&mut self, field: &Field, sign: f32, heights: &[f32], directions: &[Row; 3]) {
        if !self.is_shaped {
            self.is_shaped = true;
            self.moved.iter_mut().chain(&mut self.residual).for_each(|row| row[..self.count].fill(0.0));
        }
        add_along_axes(field, sign, heights, directions.each_ref().map(|row| &row[..]), &mut self.moved, &mut self.residual);
    }

    /// Adds what needs no axes; `keep` takes what all of it makes of each point's move.
    pub fn end(&self, directions: &[Row; 3], moves: &mut [Move], keep: &impl Fn(&mut Move, Move)) {
        dispatch!(Level::new(), simd => self.end_by_lanes(simd, directions, moves, keep));
    }

    #[inline(always)]
    fn end_by_lanes<S: Simd>(&self, _: S, directions: &[Row; 3], moves: &mut [Move], keep: &impl Fn(&mut Move, Move)) {
        let [dx, dy, dz] = directions.each_ref().map(|row| &row[..moves.len()]);
        let (by, residual_by) = (&self.by_gradient[..moves.len()], &self.residual_by_gradient[..moves.len()]);
        for (i, old) in moves.iter_mut().enumerate() {
            let along = |factor: f32| [dx[i] * factor, dy[i] * factor, dz[i] * factor, 0.0];
            let mut new = Move { by: along(by[i]), residual: along(residual_by[i]) };
            if self.is_shaped {
                for axis in 0..3 {
                    new.by[axis] += self.moved[axis][i];
                    new.residual[axis] += self.residual[axis][i];
                }
            }
            keep(old, new);
        }
    }
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the arguments of one loop")]
fn add_round_by_lanes<S: Simd>(
    simd: S,
    field: &Field,
    sign: f32,
    frame: &FieldFrame,
    weights: &[f32],
    places: Rows,
    heights: &mut [f32],
    [by_gradient, residual]: [&mut Row; 2],
) {
    let bell = Bell::new(simd, places, frame);
    let (round, all) = (field.bell as f32, field.all as f32);
    let rows = weights.as_chunks().0.iter().zip(heights.as_chunks_mut().0);
    let sums = by_gradient.as_chunks_mut::<LANES>().0.iter_mut().zip(residual.as_chunks_mut::<LANES>().0);
    for (number, ((weights, heights), (by_gradient, residual))) in rows.zip(sums).enumerate() {
        let height = bell.times(simd, weights, number);
        let added = height * round + f32x8::simd_from(simd, *weights) * all;
        *heights = height.into();
        *by_gradient = (f32x8::simd_from(simd, *by_gradient) + added).into();
        *residual = (f32x8::simd_from(simd, *residual) + added * sign).into();
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

#[inline(always)]
fn sum_of(lanes: [f32; LANES]) -> f64 {
    let [a, b, c, d, e, f, g, h] = lanes.map(f64::from);
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

#[inline(always)]
fn largest(lanes: [f32; LANES]) -> f64 {
    f64::from(lanes.into_iter().fold(0.0, f32::max))
}
