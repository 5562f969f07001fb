//! What no field reaches: in a step along one direction for all points the volume is linear, so every target is reached [MATH §2].
//!
//! A small part of a shell that alone may move bends over before it has enough: the cubic along its gradient has a summit.

use glam::{DMat3, DVec3};

use super::buffers::{Correction, Fields, Gradient};
use super::pass::Pass;
use super::scratch::{Scratch, with_scratch};
use super::{Bound, Problem, in_single_precision};
use crate::fields::patch_sums::{self, Move};

impl Correction {
    /// Instead of all fields, in components that need it: one step along the direction in which most can be done.
    pub(super) fn step_linearly(&mut self, problem: Problem, gradient: &Gradient, fields: &Fields, pass: Pass) {
        let Problem { bound: Bound { binding, .. }, targets, .. } = problem;
        let patches = &binding.patches;
        for (component, target) in targets.components.iter().enumerate() {
            if !self.components[component].is_linear_only || pass.passes_over(component as u32) {
                continue;
            }
            let mine = || patches.list.iter().enumerate().filter(|(_, patch)| patch.component as usize == component);
            let mut capacity = DMat3::ZERO;
            for (index, _) in mine() {
                visit_directions(problem, gradient, fields, index, |_, weight, slope, direction| {
                    capacity += DMat3::from_cols(direction * slope.x, direction * slope.y, direction * slope.z) * weight;
                });
            }
            let e = main_direction(&capacity);
            let gap = if let Pass::Again(again) = pass { again.gaps[component] } else { target.target - target.skinned };
            let scale = in_single_precision(gap / (e.dot(capacity * e) * binding.area_unit));
            for (index, _) in mine() {
                visit_directions(problem, gradient, fields, index, |slot, weight, _, direction| {
                    let residual = (e * (direction.dot(e) * weight * scale)).as_vec3().extend(0.0).to_array();
                    let by = if let Pass::Again(again) = pass { again.moves[slot].by } else { [0.0; 4] };
                    self.moves[slot] = Move { by, residual };
                });
            }
            let jobs = binding.plan.jobs.iter().zip(&mut self.jobs);
            for (_, state) in jobs.filter(|(job, _)| job.component as usize == component) {
                state.is_capped |= state.regained != 0.0;
                (state.regained, state.displacement) = (0.0, 0.0);
            }
        }
    }
}

/// Slot, weight in the field of the whole shell, gradient and masked direction of each point of a patch.
fn visit_directions(problem: Problem, gradient: &Gradient, fields: &Fields, index: usize, mut visit: impl FnMut(usize, f64, DVec3, DVec3)) {
    let Problem { bound: Bound { binding, .. }, mask, .. } = problem;
    let slots = binding.patches.list[index].start..binding.patches.slot_offsets[index + 1] as usize;
    let gradient = gradient.rows.each_ref().map(|row| &row[slots.clone()]);
    let areas = &binding.inverse_areas[slots.clone()];
    let normals = problem.normals(&fields.components, index);
    with_scratch(|Scratch { fields: rows, .. }| {
        patch_sums::directions(gradient, normals, areas, &mut rows.directions, &mut rows.volumes, &mut rows.lengths);
        if let Some(mask) = mask {
            patch_sums::mask(&mask.of_slot[slots.clone()], &mut rows.directions, &mut rows.volumes, &mut rows.lengths);
        }
        let at = |rows: [&[f32]; 3], i: usize| DVec3::from_array(rows.map(|row| f64::from(row[i])));
        let directions = rows.directions.each_ref().map(|row| &row[..]);
        for (i, slot) in slots.enumerate() {
            visit(slot, f64::from(areas[i]), at(gradient, i), at(directions, i));
        }
    });
}

/// Direction of the largest eigenvalue of a symmetric matrix, nearly: a column of its 256th power.
fn main_direction(matrix: &DMat3) -> DVec3 {
    let mut power = *matrix;
    for _ in 0..8 {
        let trace = power.x_axis.x + power.y_axis.y + power.z_axis.z;
        power *= trace.recip();
        power = power * power;
    }
    let columns = [power.x_axis, power.y_axis, power.z_axis];
    let longest = columns.into_iter().fold(DVec3::ZERO, |a, b| if b.length_squared() > a.length_squared() { b } else { a });
    longest.normalize_or_zero()
}
