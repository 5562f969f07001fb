//! What leaves the engine: offsets of vertices and their positions, in object space.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x4};

use super::{ComponentState, Workspace};
use crate::binding::Binding;
use crate::fields::Move;
use crate::lanes;
use crate::skinning::columns;
use crate::split::{Equal, for_each_piece};

/// Vertices that are written at a time.
const CHUNK: usize = 512;

impl Workspace {
    /// Corrected − skinned of every vertex, object space.
    pub(crate) fn write_offsets(&mut self, binding: &Binding, offsets: &mut [[f32; 3]]) {
        let to_object = self.offset_columns();
        let (moves, components) = (&self.moves, &self.components);
        let level = Level::new();
        // Most characters are one shell: nothing to look up then.
        let only_step = if let [state] = &**components { Some(state.step as f32) } else { None };
        let step = |component: u32| step_of(components, component);
        // Of numbers of 0 or more the bits are in the same order.
        let largest_squared = AtomicU32::new(0);
        let rows = Equal::new(offsets, CHUNK);
        for_each_piece(rows.count(), rows, &|row, offsets| {
            let vertices = row * CHUNK..row * CHUNK + offsets.values.len();
            let (slots, of_vertex) = (&binding.slot_of_vertex[vertices.clone()], &binding.component_of_vertex[vertices]);
            let largest = match only_step {
                Some(step) => dispatch!(level, simd => write_some(simd, moves, slots, of_vertex, |_| step, &to_object, offsets.values)),
                None => dispatch!(level, simd => write_some(simd, moves, slots, of_vertex, step, &to_object, offsets.values)),
            };
            largest_squared.fetch_max(largest.to_bits(), Ordering::Relaxed);
        });
        let largest_squared = f32::from_bits(largest_squared.into_inner());
        self.report.max_displacement = f64::from(largest_squared).sqrt();
    }

    /// Skinned, and `part` of the way to corrected, of every vertex: the same bits as by way of `write_offsets`.
    pub(crate) fn write_positions(&self, binding: &Binding, part: f64, positions: &mut [[f32; 3]]) {
        let to_object = self.offset_columns();
        dispatch!(Level::new(), simd => write_all(simd, self, binding, &to_object, part, positions));
    }

    fn offset_columns(&self) -> [[f32; 4]; 3] {
        [0, 1, 2].map(|column| columns(&self.object)[column].map(|c| c as f32))
    }
}

#[inline(always)]
fn write_all<S: Simd>(simd: S, frame: &Workspace, binding: &Binding, to_object: &[[f32; 4]; 3], part: f64, positions: &mut [[f32; 3]]) {
    // Every point has its own place, as `skinned_vertex` finds it.
    let is_plain = !binding.sites.is_split() && frame.added.is_empty();
    let (near, rest) = (&frame.skinned.near, &frame.skinned.rest);
    let (object, origin) = (columns(&frame.object), lanes::from(frame.motions.palette.origin));
    for &vertex in &binding.vertices_by_slot {
        let vertex = vertex as usize;
        let (slot, component) = (binding.slot_of_vertex[vertex] as usize, binding.component_of_vertex[vertex]);
        let point = frame.moves.get(slot);
        let p = if is_plain && point.is_some() {
            [
                f64::from(near[0][slot]) + f64::from(rest[0][slot]) + origin[0],
                f64::from(near[1][slot]) + f64::from(rest[1][slot]) + origin[1],
                f64::from(near[2][slot]) + f64::from(rest[2][slot]) + origin[2],
            ]
        } else {
            frame.skinned_vertex(binding, vertex).to_array()
        };
        let step = step_of(&frame.components, component);
        let offset = offset(simd, point, step, to_object);
        let [a, b, c, d] = &object;
        let row = &mut positions[vertex];
        for axis in 0..3 {
            let skinned = a[axis] * p[0] + b[axis] * p[1] + c[axis] * p[2] + d[axis];
            row[axis] = (skinned + part * f64::from(offset[axis])) as f32;
        }
    }
}

/// Offsets of some vertices; the largest squared length.
#[inline(always)]
fn write_some<S: Simd>(
    simd: S,
    moves: &[Move],
    slots: &[u32],
    of_vertex: &[u32],
    step: impl Fn(u32) -> f32,
    to_object: &[[f32; 4]; 3],
    offsets: &mut [[f32; 3]],
) -> f32 {
    let mut largest = 0.0;
    for ((row, &slot), &component) in offsets.iter_mut().zip(slots).zip(of_vertex) {
        let u = offset(simd, moves.get(slot as usize), step(component), to_object);
        let squared = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        largest = if squared > largest { squared } else { largest };
        row.copy_from_slice(&u[..3]);
    }
    largest
}

/// Step along the residual's field; not a number for loose points, which are of no component.
#[inline(always)]
fn step_of(components: &[ComponentState], component: u32) -> f32 {
    if let Some(state) = components.get(component as usize) { state.step as f32 } else { f32::NAN }
}

/// Corrected − skinned of a point, object space; no point, and a step that is not a number, stay.
#[inline(always)]
fn offset<S: Simd>(simd: S, point: Option<&Move>, step: f32, to_object: &[[f32; 4]; 3]) -> [f32; 4] {
    let Some(Move { by, residual }) = point else { return [0.0; 4] };
    if step.is_nan() {
        return [0.0; 4];
    }
    let u: [f32; 4] = (f32x4::simd_from(simd, *by) + f32x4::simd_from(simd, *residual) * step).into();
    let (x, y) = (f32x4::simd_from(simd, to_object[0]), f32x4::simd_from(simd, to_object[1]));
    let z = f32x4::simd_from(simd, to_object[2]);
    (x * u[0] + y * u[1] + z * u[2]).into()
}
