//! The fields of one patch, in single precision, whole lanes of points at a time.
//!
//! Single precision is enough: what a field adds is measured in double precision on the moved points afterwards.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x4, f32x8};

use crate::fields::field::{Field, FieldFrame};
use crate::fields::profile_weights::{Bell, Heights, NO_HEIGHTS};
use crate::fields::supports::Support;
use crate::numeric::block_rows::{Block, LANES, PATCH_POINTS, Present};
use crate::numeric::lanes::{larger, rows};
use crate::surface::patches::Rows;

/// One number per owned point of a patch.
pub(crate) type Row = [f32; PATCH_POINTS];

/// What even fields push along, of the points of one patch or of all.
#[derive(Clone, Copy)]
pub(crate) struct Normals<'a> {
    /// Unit vectors.
    pub directions: Rows<'a>,
    /// Mean area over the length of the gradient at rest.
    pub inverse_gradients: &'a [f32],
    /// How much of each direction is the gradient's nevertheless, up to 1.
    pub gradient_share: f32,
}

impl Normals<'_> {
    pub fn of(&self, slots: &Range<usize>) -> Self {
        Self {
            directions: self.directions.map(|row| &row[slots.clone()]),
            inverse_gradients: &self.inverse_gradients[slots.clone()],
            ..*self
        }
    }
}

/// Directions of displacements: the gradient g of a point of rest area A, made less where skin is stretched or compressed.
///
/// Without this a point moves by |g|/A: stretched skin, an armpit, would grow fins, and a crease be pushed into itself.
/// With q = |g|/A, 1 on skin as at rest, 2q/(1 + q²) of it is left: at most twice as far, and hardly at all in a crease.
/// Also the volume each direction adds by its length, and the length.
///
/// Along `normals` where there are any, by 2A/(q + 1/q) with q against the gradient at rest: one way, and as far, for all of a navel.
pub(crate) fn directions(
    gradient: Rows,
    normals: Option<Normals>,
    inverse_areas: &[f32],
    directions: &mut [Row; 3],
    volumes: &mut Row,
    lengths: &mut Row,
) {
    match normals {
        None => dispatch!(Level::new(), simd => directions_by_lanes(simd, gradient, inverse_areas, directions, volumes, lengths)),
        Some(normals) => {
            dispatch!(Level::new(), simd => along_normals_by_lanes(simd, gradient, normals, inverse_areas, directions, volumes, lengths));
            if normals.gradient_share > 0.0 {
                mix_in_gradient(gradient, normals.gradient_share, inverse_areas, directions, volumes, lengths);
            }
        }
    }
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

/// What a patch adds by its directions, and what it would add if they were the gradient's, of the same lengths.
pub(crate) fn added_and_most(gradient: Rows, volumes: &Row, lengths: &Row) -> [f64; 2] {
    dispatch!(Level::new(), simd => added_and_most_by_lanes(simd, gradient, volumes, lengths))
}

#[inline(always)]
fn added_and_most_by_lanes<S: Simd>(_: S, [x, y, z]: Rows, volumes: &Row, lengths: &Row) -> [f64; 2] {
    let count = x.len();
    let (y, z, volumes, lengths) = (&y[..count], &z[..count], &volumes[..count], &lengths[..count]);
    let (mut added, mut most) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..count {
        added[i % LANES] += volumes[i];
        most[i % LANES] += (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt() * lengths[i];
    }
    [sum_of(added), sum_of(most)]
}

/// Makes vectors unit vectors, or leaves 0.
pub(crate) fn normalize(rows: [&mut [f32]; 3]) {
    dispatch!(Level::new(), simd => normalize_by_lanes(simd, rows));
}

#[inline(always)]
fn normalize_by_lanes<S: Simd>(_: S, [x, y, z]: [&mut [f32]; 3]) {
    let count = x.len();
    let (y, z) = (&mut y[..count], &mut z[..count]);
    for i in 0..count {
        let length = (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt();
        let inverse = if length > 0.0 { length.recip() } else { 0.0 };
        (x[i], y[i], z[i]) = (x[i] * inverse, y[i] * inverse, z[i] * inverse);
    }
}

/// Takes a share of each direction from the gradient.
fn mix_in_gradient(gradient: Rows, share: f32, inverse_areas: &[f32], directions: &mut [Row; 3], volumes: &mut Row, lengths: &mut Row) {
    let [dx, dy, dz] = directions;
    for (i, inverse_area) in inverse_areas.iter().enumerate() {
        let g = gradient.map(|row| row[i]);
        let q = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]).sqrt() * inverse_area;
        let part = share * (2.0 * q / (1.0 + q * q));
        let d = [dx[i], dy[i], dz[i]];
        let d: [f32; 3] = std::array::from_fn(|axis| d[axis] * (1.0 - share) + g[axis] * part);
        ([dx[i], dy[i], dz[i]], lengths[i]) = (d, (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt());
        volumes[i] = g[0] * d[0] + g[1] * d[1] + g[2] * d[2];
    }
}

#[inline(always)]
fn along_normals_by_lanes<S: Simd>(
    _: S,
    gradient: Rows,
    normals: Normals,
    inverse_areas: &[f32],
    directions: &mut [Row; 3],
    volumes: &mut Row,
    lengths: &mut Row,
) {
    let count = inverse_areas.len();
    let [x, y, z] = gradient.map(|row| &row[..count]);
    let [nx, ny, nz] = normals.directions.map(|row| &row[..count]);
    let inverse_gradients = &normals.inverse_gradients[..count];
    let [dx, dy, dz] = directions.each_mut().map(|row| &mut row[..count]);
    let (volumes, lengths) = (&mut volumes[..count], &mut lengths[..count]);
    for i in 0..count {
        let square = (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]) * (inverse_gradients[i] * inverse_gradients[i]);
        let area = if inverse_areas[i] > 0.0 { inverse_areas[i].recip() } else { 0.0 };
        let q = square.sqrt();
        // Not 2q/(1 + q²), which is no number where q² is none.
        lengths[i] = area * (2.0 / (q + q.recip()));
        (dx[i], dy[i], dz[i]) = (nx[i] * lengths[i], ny[i] * lengths[i], nz[i] * lengths[i]);
        volumes[i] = x[i] * dx[i] + y[i] * dy[i] + z[i] * dz[i];
    }
}

/// A point whose gradient is less than this part of its area at rest moves as if it were as much.
const AREA_MIN: f32 = 0.2;

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

/// Weights times the joint's bell at each place; Σ w·v and the largest w·l of the weights, and of the heights.
pub(crate) fn bell_sums(
    support: Support,
    places: Rows,
    frame: &FieldFrame,
    volumes: &Row,
    lengths: &Row,
    heights: &mut [Block<f32>],
) -> [(f64, f64); 2] {
    dispatch!(Level::new(), simd => bell_sums_by_lanes(simd, support, places, frame, volumes, lengths, heights))
}

#[inline(always)]
fn bell_sums_by_lanes<S: Simd>(
    simd: S,
    support: Support,
    places: Rows,
    frame: &FieldFrame,
    volumes: &Row,
    lengths: &Row,
    heights: &mut [Block<f32>],
) -> [(f64, f64); 2] {
    let bell = Bell::new(simd, places, frame);
    let (volumes, lengths) = (volumes.as_chunks::<LANES>().0, lengths.as_chunks::<LANES>().0);
    let none = f32x8::splat(simd, 0.0);
    let (mut sum, mut most) = (none, none);
    let (mut bell_sum, mut bell_most) = (none, none);
    for ((number, weights), heights) in support.present.numbered(support.weights).zip(heights) {
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

/// Σ w·v and the largest w·l.
pub(crate) fn sum_and_most(present: Present, weights: &[Block<f32>], volumes: &Row, lengths: &Row) -> (f64, f64) {
    dispatch!(Level::new(), simd => sum_and_most_by_lanes(simd, present, weights, volumes, lengths))
}

#[inline(always)]
fn sum_and_most_by_lanes<S: Simd>(simd: S, present: Present, weights: &[Block<f32>], volumes: &Row, lengths: &Row) -> (f64, f64) {
    let none = f32x8::splat(simd, 0.0);
    let (mut sum, mut most) = (none, none);
    let (volumes, lengths) = (volumes.as_chunks::<LANES>().0, lengths.as_chunks::<LANES>().0);
    for (number, weights) in present.numbered(weights) {
        let weights = f32x8::simd_from(simd, *weights);
        sum += weights * f32x8::simd_from(simd, volumes[number]);
        most = larger(weights * f32x8::simd_from(simd, lengths[number]), most);
    }
    (sum_of(sum.into()), largest(most.into()))
}

/// Σ w·(g·e)(d·e) and the largest w·|d·e|, for each of three axes.
pub(crate) fn sums_along(
    present: Present,
    heights: &[Block<f32>],
    gradient: Rows,
    directions: &[Row; 3],
    axes: [[f32; 3]; 3],
) -> [(f64, f64); 3] {
    dispatch!(Level::new(), simd => sums_along_by_lanes(simd, present, heights, gradient, directions, axes))
}

#[inline(always)]
fn sums_along_by_lanes<S: Simd>(
    simd: S,
    present: Present,
    heights: &[Block<f32>],
    gradient: Rows,
    directions: &[Row; 3],
    axes: [[f32; 3]; 3],
) -> [(f64, f64); 3] {
    let none = f32x8::splat(simd, 0.0);
    let (mut sums, mut most) = ([none; 3], [none; 3]);
    let [x, y, z] = gradient.map(|row| row.as_chunks::<LANES>().0);
    let [dx, dy, dz] = directions.each_ref().map(|row| row.as_chunks::<LANES>().0);
    for (number, height) in present.numbered(heights) {
        let height = f32x8::simd_from(simd, *height);
        let (x, y) = (f32x8::simd_from(simd, x[number]), f32x8::simd_from(simd, y[number]));
        let (z, dx) = (f32x8::simd_from(simd, z[number]), f32x8::simd_from(simd, dx[number]));
        let (dy, dz) = (f32x8::simd_from(simd, dy[number]), f32x8::simd_from(simd, dz[number]));
        for axis in 0..3 {
            let [a, b, c] = axes[axis];
            let moved = height * (dx * a + dy * b + dz * c);
            sums[axis] += moved * (x * a + y * b + z * c);
            most[axis] = larger(moved.abs(), most[axis]);
        }
    }
    let of = |axis: usize| (sum_of(sums[axis].into()), largest(most[axis].into()));
    [of(0), of(1), of(2)]
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
    /// Weight times bell, for each block of weights of one joint.
    pub bell: Heights,
}

/// What the fields of a patch and the residual's field add to its points: the same up to the sign of those that take.
pub(crate) struct FieldSum {
    count: usize,
    /// Of joints that give, and of those that take: factors on the directions, which need no axes.
    by_gradient: [Row; 2],
    /// Whether some field has axes: the rest stands only then.
    is_shaped: bool,
    shaped: [[Row; 3]; 2],
}

const NO_ROW: Row = [0.0; PATCH_POINTS];

impl FieldRows {
    pub const fn new() -> Self {
        Self { directions: [NO_ROW; 3], volumes: NO_ROW, lengths: NO_ROW, unmasked: NO_ROW, bell: NO_HEIGHTS }
    }
}

impl FieldSum {
    pub const fn new() -> Self {
        Self { count: 0, by_gradient: [NO_ROW; 2], is_shaped: false, shaped: [[NO_ROW; 3]; 2] }
    }

    /// Begins with nothing, of so many points.
    pub fn start(&mut self, count: usize) {
        self.count = count;
        self.is_shaped = false;
        self.by_gradient.iter_mut().for_each(|row| row[..count].fill(0.0));
    }

    /// What points themselves give, or take: `volumes` in units of the mean area, none moved by more than its bound, smoothly.
    ///
    /// By its own gradient a point would move the farther the less it has of it; skin of a fifth of its area at rest counts as such.
    pub fn add_local(&mut self, volumes: &[f32], bounds: &[f32], gradient: Rows, inverse_areas: &[f32], lengths: &Row) {
        dispatch!(Level::new(), simd => self.add_local_by_lanes(simd, volumes, bounds, gradient, inverse_areas, lengths));
    }

    #[inline(always)]
    fn add_local_by_lanes<S: Simd>(&mut self, _: S, volumes: &[f32], bounds: &[f32], gradient: Rows, inverse_areas: &[f32], lengths: &Row) {
        let count = self.count;
        let [given, taken] = self.by_gradient.each_mut().map(|row| &mut row[..count]);
        let [x, y, z] = gradient.map(|row| &row[..count]);
        let (volumes, bounds, inverse_areas, lengths) = (&volumes[..count], &bounds[..count], &inverse_areas[..count], &lengths[..count]);
        for i in 0..count {
            let least = AREA_MIN / inverse_areas[i];
            let square = (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).max(least * least);
            let factor = volumes[i] / square;
            let beyond = factor * lengths[i] / bounds[i];
            let within = 1.0 / (1.0 + beyond * beyond * (beyond * beyond)).sqrt().sqrt();
            // Where there is no area, or no room, there is no number.
            let factor = if (factor * within).is_finite() { factor * within } else { 0.0 };
            given[i] += factor.max(0.0);
            taken[i] += factor.min(0.0);
        }
    }

    /// What a joint gives, or takes, without axes: by its bell, and by all of its vicinity. Leaves weights times the bell in
    /// `heights`.
    pub fn add_round(
        &mut self,
        takes: bool,
        field: &Field,
        support: Support,
        places: Rows,
        frame: &FieldFrame,
        heights: &mut [Block<f32>],
    ) {
        let sum = &mut self.by_gradient[usize::from(takes)];
        dispatch!(Level::new(), simd => add_round_by_lanes(simd, field, support, places, frame, heights, sum));
    }

    /// The same along its axes.
    pub fn add_shaped(&mut self, takes: bool, field: &Field, present: Present, heights: &[Block<f32>], directions: &[Row; 3]) {
        if !self.is_shaped {
            self.is_shaped = true;
            self.shaped.as_flattened_mut().iter_mut().for_each(|row| row[..self.count].fill(0.0));
        }
        let sums = &mut self.shaped[usize::from(takes)];
        dispatch!(Level::new(), simd => add_shaped_by_lanes(simd, field, present, heights, directions, sums));
    }

    /// Adds the field of the whole shell, so much of it, and of it for the residual, to which joints contribute or not;
    /// `keep` takes what all of it makes of each point's move.
    pub fn end(
        &self,
        inverse_areas: &[f32],
        shell: [f64; 2],
        joints_contribute: bool,
        directions: &[Row; 3],
        moves: &mut [Move],
        keep: &impl Fn(&mut Move, Move),
    ) {
        let shell = shell.map(|s| s as f32);
        let joints = if joints_contribute { 1.0 } else { 0.0 };
        dispatch!(Level::new(), simd => self.end_by_lanes(simd, inverse_areas, shell, joints, directions, moves, keep));
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the arguments of one loop")]
    fn end_by_lanes<S: Simd>(
        &self,
        simd: S,
        inverse_areas: &[f32],
        [shell, shell_residual]: [f32; 2],
        joints: f32,
        directions: &[Row; 3],
        moves: &mut [Move],
        keep: &impl Fn(&mut Move, Move),
    ) {
        let four = |row: &[f32], at: usize| f32x4::simd_from(simd, row.as_chunks::<4>().0[at]);
        let [given, taken] = &self.by_gradient;
        for (at, moves) in moves.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let (areas, given, taken) = (four(inverse_areas, at), four(given, at), four(taken, at));
            let by = areas * shell + (given + taken);
            let residual = areas * shell_residual + (given - taken) * joints;
            let (mut by, mut residual) = ([by; 3], [residual; 3]);
            for axis in 0..3 {
                let direction = four(&directions[axis], at);
                by[axis] *= direction;
                residual[axis] *= direction;
                if self.is_shaped {
                    let (given, taken) = (four(&self.shaped[0][axis], at), four(&self.shaped[1][axis], at));
                    by[axis] += given + taken;
                    residual[axis] += (given - taken) * joints;
                }
            }
            let (by, residual) = (rows(simd, by), rows(simd, residual));
            for (i, old) in moves.iter_mut().enumerate() {
                keep(old, Move { by: by[i].into(), residual: residual[i].into() });
            }
        }
    }
}

#[inline(always)]
fn add_round_by_lanes<S: Simd>(
    simd: S,
    field: &Field,
    support: Support,
    places: Rows,
    frame: &FieldFrame,
    heights: &mut [Block<f32>],
    sum: &mut Row,
) {
    let bell = Bell::new(simd, places, frame);
    let (round, all) = (field.bell as f32, field.all as f32);
    let (sum, _) = sum.as_chunks_mut::<LANES>();
    for ((number, weights), heights) in support.present.numbered(support.weights).zip(heights) {
        let height = bell.times(simd, weights, number);
        *heights = height.into();
        let added = height * round + f32x8::simd_from(simd, *weights) * all;
        sum[number] = (f32x8::simd_from(simd, sum[number]) + added).into();
    }
}

#[inline(always)]
fn add_shaped_by_lanes<S: Simd>(
    simd: S,
    field: &Field,
    present: Present,
    heights: &[Block<f32>],
    directions: &[Row; 3],
    sums: &mut [Row; 3],
) {
    let [a, b, c] = field.shaped.as_mat3().to_cols_array_2d();
    let [dx, dy, dz] = directions.each_ref().map(|row| row.as_chunks::<LANES>().0);
    let [sx, sy, sz] = sums.each_mut().map(|row| row.as_chunks_mut::<LANES>().0);
    for (number, height) in present.numbered(heights) {
        let height = f32x8::simd_from(simd, *height);
        let (dx, dy) = (f32x8::simd_from(simd, dx[number]), f32x8::simd_from(simd, dy[number]));
        let dz = f32x8::simd_from(simd, dz[number]);
        sx[number] = (f32x8::simd_from(simd, sx[number]) + (dx * a[0] + dy * b[0] + dz * c[0]) * height).into();
        sy[number] = (f32x8::simd_from(simd, sy[number]) + (dx * a[1] + dy * b[1] + dz * c[1]) * height).into();
        sz[number] = (f32x8::simd_from(simd, sz[number]) + (dx * a[2] + dy * b[2] + dz * c[2]) * height).into();
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
