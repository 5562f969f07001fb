//! What leaves the engine: offsets of vertices and their positions, in object space.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x4, f64x4};
use glam::DVec3;

use super::buffers::ComponentOutcome;
use super::solved::Solved;
use crate::fields::patch_sums::Move;
use crate::numeric::block_rows::LANES;
use crate::numeric::lanes::{self, Four, columns, larger};
use crate::parallel::split::{Equal, for_each_piece};

/// Vertices that are written at a time.
const CHUNK: usize = 512;

impl Solved<'_> {
    /// Corrected − skinned of every vertex, object space. Returns the largest displacement.
    pub(crate) fn write_offsets(&self, offsets: &mut [[f32; 3]]) -> f64 {
        let binding = self.binding;
        let to_object = self.posed.object.matrix3.as_mat3().to_cols_array_2d();
        let (moves, components) = (&self.correction.moves, &self.correction.components);
        let flesh = if self.flesh.is_active() { self.flesh.offsets() } else { &[] };
        let level = Level::new();
        // Most characters are one shell: nothing to look up then.
        let only_step = if let [state] = &**components { Some(state.step as f32) } else { None };
        let step = |component: u32| step_of(components, component);
        // Of numbers of 0 or more the bits are in the same order.
        let largest_squared = AtomicU32::new(0);
        let rows = Equal::new(&mut *offsets, CHUNK);
        for_each_piece(rows.count(), rows, &|row, offsets| {
            let vertices = row * CHUNK..row * CHUNK + offsets.values.len();
            let (slots, of_vertex) = (&binding.slot_of_vertex[vertices.clone()], &binding.component_of_vertex[vertices]);
            let largest = match only_step {
                Some(step) => {
                    dispatch!(level, simd => write_some(simd, (moves, flesh), slots, of_vertex, |_| step, &to_object, offsets.values))
                }
                None => dispatch!(level, simd => write_some(simd, (moves, flesh), slots, of_vertex, step, &to_object, offsets.values)),
            };
            largest_squared.fetch_max(largest.to_bits(), Ordering::Relaxed);
        });
        let largest_squared = f32::from_bits(largest_squared.into_inner());
        if largest_squared.is_finite() {
            return f64::from(largest_squared).sqrt();
        }
        // The square is beyond single precision, not the offset.
        let length = |offset: &[f32; 3]| DVec3::from_array(offset.map(f64::from)).length();
        offsets.iter().map(length).fold(0.0, f64::max)
    }

    /// Skinned, and `part` of the way to corrected, of every vertex: the same bits as by way of `write_offsets`.
    pub(crate) fn write_positions(&self, part: f64, positions: &mut [[f32; 3]]) {
        let to_object = self.posed.object.matrix3.as_mat3().to_cols_array_2d();
        dispatch!(Level::new(), simd => write_all(simd, self, &to_object, part, positions));
    }
}

#[inline(always)]
fn write_all<S: Simd>(simd: S, frame: &Solved, to_object: &[[f32; 3]; 3], part: f64, positions: &mut [[f32; 3]]) {
    let Solved { binding, posed, correction, .. } = *frame;
    let [a, b, c, d] = columns(&posed.object);
    let mut vertices = binding.vertices_by_slot.iter().map(|&vertex| vertex as usize).peekable();
    let slot_of = |vertex: usize| binding.slot_of_vertex[vertex] as usize;
    // Every point has its own place, as `skinned_vertex` finds it, and all of eight slots are of one component.
    let is_plain = !binding.sites.is_split() && !posed.body.is_split() && posed.added.is_empty() && !frame.flesh.is_active();
    while let Some(&first) = vertices.peek().filter(|&&vertex| is_plain && slot_of(vertex) < correction.moves.len()) {
        let number = slot_of(first) / LANES;
        let eight = eight_positions(simd, frame, number, binding.component_of_vertex[first], to_object, part);
        while let Some(vertex) = vertices.next_if(|&vertex| slot_of(vertex) / LANES == number) {
            positions[vertex].copy_from_slice(&eight[slot_of(vertex) % LANES][..3]);
        }
    }
    for vertex in vertices {
        let p = frame.skinned_vertex(vertex);
        let step = step_of(&correction.components, binding.component_of_vertex[vertex]);
        let flesh = if frame.flesh.is_active() { frame.flesh.offsets().get(slot_of(vertex)) } else { None };
        let offset = offsets_in_object([own_offset(simd, correction.moves.get(slot_of(vertex)), flesh, step); 4], to_object);
        for (axis, value) in positions[vertex].iter_mut().enumerate() {
            let skinned = a[axis] * p.x + b[axis] * p.y + c[axis] * p.z + d[axis];
            *value = (skinned + part * f64::from(offset[axis][0])) as f32;
        }
    }
}

/// Positions of all points in eight slots.
#[inline(always)]
fn eight_positions<S: Simd>(
    simd: S,
    frame: &Solved,
    number: usize,
    component: u32,
    to_object: &[[f32; 3]; 3],
    part: f64,
) -> [[f32; 4]; LANES] {
    let step = step_of(&frame.correction.components, component);
    let moves = &frame.correction.moves.as_chunks::<LANES>().0[number];
    let at = |place: usize| own_offset(simd, Some(&moves[place]), None, step);
    let first = offsets_in_object([at(0), at(1), at(2), at(3)], to_object);
    let second = offsets_in_object([at(4), at(5), at(6), at(7)], to_object);
    let [early, late] = frame.skinned.places.eight(simd, number);
    let (early, late) = (points_in_object(simd, frame, early).coordinates(), points_in_object(simd, frame, late).coordinates());
    let (mut first_positions, mut second_positions) = (first, second);
    for axis in 0..3 {
        let (by, by_late) = first[axis].combine(second[axis]).widen();
        (first_positions[axis], second_positions[axis]) = (early[axis] + by * part).narrow(late[axis] + by_late * part).split();
    }
    let ([p, q, r, s], [t, u, v, w]) = (lanes::rows(simd, first_positions), lanes::rows(simd, second_positions));
    [p.into(), q.into(), r.into(), s.into(), t.into(), u.into(), v.into(), w.into()]
}

/// Object space, of points about the palette's origin.
#[inline(always)]
fn points_in_object<S: Simd>(simd: S, frame: &Solved, points: Four<S>) -> Four<S> {
    let [a, b, c, d] = columns(&frame.posed.object);
    let origin = frame.posed.motions.palette.origin;
    let [x, y, z] = points.coordinates();
    let (x, y, z) = (x + origin.x, y + origin.y, z + origin.z);
    let along = |axis: usize| x * a[axis] + y * b[axis] + z * c[axis] + f64x4::splat(simd, d[axis]);
    Four::of_lanes([along(0), along(1), along(2)])
}

/// Offsets of some vertices; the largest squared length.
#[inline(always)]
fn write_some<S: Simd>(
    simd: S,
    (moves, flesh): (&[Move], &[[f32; 4]]),
    slots: &[u32],
    of_vertex: &[u32],
    step: impl Fn(u32) -> f32,
    to_object: &[[f32; 3]; 3],
    offsets: &mut [[f32; 3]],
) -> f32 {
    let at = |slot: u32, component: u32| own_offset(simd, moves.get(slot as usize), flesh.get(slot as usize), step(component));
    let mut largest = f32x4::splat(simd, 0.0);
    let ((rows, last_rows), (slots, last_slots)) = (offsets.as_chunks_mut::<4>(), slots.as_chunks::<4>());
    let (components, last_components) = of_vertex.as_chunks::<4>();
    for ((rows, &[p, q, r, s]), &[a, b, c, d]) in rows.iter_mut().zip(slots).zip(components) {
        let [x, y, z] = offsets_in_object([at(p, a), at(q, b), at(r, c), at(s, d)], to_object);
        largest = larger(x * x + y * y + z * z, largest);
        let [a, b, c, d] = lanes::rows(simd, [x, y, z]);
        *rows = [first_three(a), first_three(b), first_three(c), first_three(d)];
    }
    let mut largest = <[f32; 4]>::from(largest).into_iter().fold(0.0, f32::max);
    for ((row, &slot), &component) in last_rows.iter_mut().zip(last_slots).zip(last_components) {
        let [x, y, z] = offsets_in_object([at(slot, component); 4], to_object);
        *row = [x[0], y[0], z[0]];
        largest = f32::max(largest, (x * x + y * y + z * z)[0]);
    }
    largest
}

#[inline(always)]
fn first_three<S: Simd>(row: f32x4<S>) -> [f32; 3] {
    let [x, y, z, _] = row.into();
    [x, y, z]
}

/// Step along the residual's field; not a number for loose points, which are of no component.
#[inline(always)]
fn step_of(components: &[ComponentOutcome], component: u32) -> f32 {
    if let Some(state) = components.get(component as usize) { state.step as f32 } else { f32::NAN }
}

/// Corrected − skinned of a point, with what the law of flesh adds, armature space; no point, and a step that is not a number, stay.
#[inline(always)]
fn own_offset<S: Simd>(simd: S, point: Option<&Move>, flesh: Option<&[f32; 4]>, step: f32) -> f32x4<S> {
    let own = match point {
        Some(Move { by, residual }) if !step.is_nan() => f32x4::simd_from(simd, *by) + f32x4::simd_from(simd, *residual) * step,
        _ => f32x4::splat(simd, 0.0),
    };
    match flesh {
        Some(by) => own + f32x4::simd_from(simd, *by),
        None => own,
    }
}

/// Coordinates of four offsets in object space.
#[inline(always)]
fn offsets_in_object<S: Simd>(offsets: [f32x4<S>; 4], to_object: &[[f32; 3]; 3]) -> [f32x4<S>; 3] {
    let [x, y, z] = lanes::coordinates(offsets);
    let [of_x, of_y, of_z] = to_object;
    [x * of_x[0] + y * of_y[0] + z * of_z[0], x * of_x[1] + y * of_y[1] + z * of_z[1], x * of_x[2] + y * of_y[2] + z * of_z[2]]
}
