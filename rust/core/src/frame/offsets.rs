//! What leaves the engine: offsets of vertices and their positions, in object space.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x4};
use glam::{DVec3, Vec3};

use super::Workspace;
use crate::binding::Binding;
use crate::fields::Move;
use crate::skinning::columns;
use crate::split::{Equal, for_each_piece};

/// Vertices that are written at a time.
const CHUNK: usize = 512;

impl Workspace {
    /// Corrected − skinned of every vertex, object space.
    pub(crate) fn write_offsets(&mut self, binding: &Binding, offsets: &mut [[f32; 3]]) {
        let to_object = [0, 1, 2].map(|column| columns(&self.object)[column].map(|c| c as f32));
        let (moves, components) = (&self.moves, &self.components);
        let level = Level::new();
        // Most characters are one shell: nothing to look up then.
        let only_step = if let [state] = &**components { Some(state.step as f32) } else { None };
        let step = |component: u32| components[component as usize].step as f32;
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

    /// Skinned, and so much of `offsets`, of every vertex.
    pub(crate) fn write_positions(&self, binding: &Binding, offsets: &[[f32; 3]], part: f64, positions: &mut [[f32; 3]]) {
        dispatch!(Level::new(), simd => write_all(simd, self, binding, offsets, part, positions));
    }
}

#[inline(always)]
fn write_all<S: Simd>(_: S, frame: &Workspace, binding: &Binding, offsets: &[[f32; 3]], part: f64, positions: &mut [[f32; 3]]) {
    let (object, origin, count) = (frame.object, frame.motions.palette.origin, frame.moves.len());
    let [near, rest] = [&frame.skinned.near, &frame.skinned.rest].map(|rows| rows.each_ref().map(|row| &row[..count]));
    // Every point has its own place, as `skinned_vertex` finds it.
    let is_plain = !binding.sites.is_split() && frame.added.is_empty();
    for (vertex, ((position, offset), &slot)) in positions.iter_mut().zip(offsets).zip(&binding.slot_of_vertex).enumerate() {
        let slot = slot as usize;
        let skinned = if is_plain && slot < count {
            let at = |axis: usize| f64::from(near[axis][slot]) + f64::from(rest[axis][slot]);
            DVec3::new(at(0), at(1), at(2)) + origin
        } else {
            frame.skinned_vertex(binding, vertex)
        };
        *position = (object.transform_point3(skinned) + part * Vec3::from_array(*offset).as_dvec3()).as_vec3().to_array();
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
    let (x, y) = (f32x4::simd_from(simd, to_object[0]), f32x4::simd_from(simd, to_object[1]));
    let z = f32x4::simd_from(simd, to_object[2]);
    let mut largest = 0.0;
    for ((offset, &slot), &component) in offsets.iter_mut().zip(slots).zip(of_vertex) {
        let point = moves.get(slot as usize).map(|point| (point, step(component))).filter(|(_, step)| !step.is_nan());
        let Some((Move { by, residual }, step)) = point else {
            *offset = [0.0; 3];
            continue;
        };
        let u: [f32; 4] = (f32x4::simd_from(simd, *by) + f32x4::simd_from(simd, *residual) * step).into();
        let u: [f32; 4] = (x * u[0] + y * u[1] + z * u[2]).into();
        let squared = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        largest = if squared > largest { squared } else { largest };
        offset.copy_from_slice(&u[..3]);
    }
    largest
}
