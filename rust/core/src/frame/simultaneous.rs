//! All joints give back at once: sums over the gradient, how much of each field, displacements.

use super::buffers::{ComponentOutcome, Correction, Fields, Gradient, JobOutcome, Solution};
use super::pass::Pass;
use super::places::ragged;
use super::scratch::{Scratch, with_scratch};
use super::{Bound, Problem, in_single_precision};
use crate::binding::Binding;
use crate::fields::field::{Capacity, Field};
use crate::fields::patch_sums::{self, FieldRows, Move};
use crate::fields::profile_weights;
use crate::numeric::block_rows::Present;
use crate::numeric::lanes::{V4, add};
use crate::parallel::split::{Ragged, for_each_piece};
use crate::surface::sweeps::{Buffer, GRADIENT_PARTS};

impl Solution {
    /// Displacements by all fields at once, and the field of the residual: the same with every joint giving, none taking.
    pub(super) fn correct_simultaneously(&mut self, problem: Problem) {
        let Self { gradient, fields, correction } = self;
        correction.start();
        fields.follow_normals();
        fields.sum_capacities(problem, gradient, Pass::All);
        if fields.weigh_gradient(problem) {
            fields.sum_capacities(problem, gradient, Pass::All);
        }
        fields.solve(problem, &mut correction.jobs, Pass::All);
        fields.add(
            problem,
            gradient,
            correction,
            Pass::All,
            #[inline(always)]
            |old, new| *old = new,
        );
    }
}

impl Correction {
    /// Nothing is done yet.
    fn start(&mut self) {
        self.jobs.fill(JobOutcome::default());
        self.components.fill(ComponentOutcome::default());
    }
}

impl Fields {
    /// Reads the gradient and sums what each field could do with it. Sums the gradient itself where patches share points.
    pub(super) fn sum_capacities(&mut self, problem: Problem, swept: &mut Gradient, pass: Pass) {
        let Problem { bound: Bound { binding, supports, settings }, mask, skinned, targets, .. } = problem;
        let (patches, jobs, sources) = (&binding.patches, &targets.jobs, &swept.sources);
        let (places, has_profiles) = (skinned.places.near.each_ref().map(|c| &**c), !self.profiled.is_empty());
        let components = &*self.components;
        let profile_offsets = if has_profiles { &supports.block_offsets } else { &patches.no_rows };
        for_each_piece(
            patches.list.len(),
            (
                ragged(&mut swept.rows, &patches.slot_offsets),
                Ragged::new(&mut self.profiled, profile_offsets),
                Ragged::new(&mut self.capacities, supports.jobs_of_patch.offsets()),
                (&mut *self.wide_capacities, &mut *self.evenness),
            ),
            &|index, (gradient, profiled, capacities, (wide, evenness))| {
                let patch = &patches.list[index];
                if pass.passes_over(patch.component) {
                    return;
                }
                with_scratch(|scratch| {
                    let Scratch { first, fields: FieldRows { directions, volumes, lengths, unmasked, bell }, .. } = scratch;
                    let slots = patch.start..patches.slot_offsets[index + 1] as usize;
                    let mut gradient = gradient.map(|row| row.values);
                    import_gradient(binding, index, sources, first, &mut gradient);
                    let gradient = gradient.map(|row| &*row);
                    let areas = &binding.inverse_areas[slots.clone()];
                    let normals = problem.normals(components, index);
                    patch_sums::directions(gradient, normals, areas, directions, volumes, lengths);
                    if let (Pass::All, Some(_)) = (pass, normals) {
                        evenness[0] = patch_sums::added_and_most(gradient, volumes, lengths);
                    }
                    let mask = mask.and_then(|mask| mask.of_slots(slots.clone()));
                    if let Some(mask) = mask {
                        *unmasked = *volumes;
                        patch_sums::mask(mask, directions, volumes, lengths);
                    }
                    let places = places.map(|row| &row[slots.clone()]);
                    let (all, _) = areas.as_chunks();
                    wide[0] = patch_sums::sum_and_most(Present::first(all.len()), all, volumes, lengths).0;
                    for (support, capacity) in supports.of_patch(index).zip(capacities.values) {
                        let state = &jobs[support.job];
                        *capacity = Capacity::default();
                        if !state.frame.is_active || !pass.concerns(support.job) {
                            continue;
                        }
                        let (present, weights, at) = (support.present, support.weights, support.blocks());
                        let profiles =
                            settings[binding.plan.jobs[support.job].joint as usize].profiles.as_ref().filter(|_| state.frame.has_axes());
                        let bell = &mut bell[..weights.len()];
                        let [all, round] = patch_sums::bell_sums(support, places, &state.frame, volumes, lengths, bell);
                        if let (Pass::All, Some(profiles)) = (pass, profiles) {
                            profile_weights::drawn(support, places, &state.frame, profiles, &mut profiled.values[at.clone()]);
                        }
                        ((capacity.all, capacity.all_most), (capacity.bell, capacity.bell_most)) = (all, round);
                        capacity.unmasked = mask.map_or(capacity.all, |_| patch_sums::sum_and_most(present, weights, unmasked, lengths).0);
                        if state.frame.has_axes() {
                            let shape = if profiles.is_some() { &profiled.values[at] } else { &*bell };
                            let axes = state.frame.axes.map(|e| e.as_vec3().to_array());
                            let along = patch_sums::sums_along(present, shape, gradient, directions, axes);
                            (capacity.along, capacity.along_most) = (along.map(|(sum, _)| sum), along.map(|(_, most)| most));
                        }
                    }
                });
            },
        );
        let concerns = |job: usize| pass.concerns(job) && !pass.passes_over(binding.plan.jobs[job].component);
        for (_, job) in self.jobs.iter_mut().enumerate().filter(|(index, _)| concerns(*index)) {
            job.capacity = Capacity::default();
        }
        for (&job, capacity) in supports.jobs_of_patch.values().iter().zip(&self.capacities) {
            if concerns(job as usize) {
                self.jobs[job as usize].capacity.join(capacity, binding.area_unit);
            }
        }
        for state in &mut self.components {
            state.wide_capacity = 0.0;
        }
        for (patch, wide) in patches.list.iter().zip(&self.wide_capacities) {
            self.components[patch.component as usize].wide_capacity += wide * binding.area_unit;
        }
    }

    /// How much of each field.
    pub(super) fn solve(&mut self, problem: Problem, outcomes: &mut [JobOutcome], pass: Pass) {
        let Problem { bound: Bound { binding, .. }, targets, .. } = problem;
        let is_solved = |component: usize| !pass.passes_over(component as u32);
        for (component, state) in self.components.iter_mut().enumerate().filter(|(component, _)| is_solved(*component)) {
            state.wide = targets.components[component].wide;
        }
        let states = self.jobs.iter_mut().zip(outcomes).zip(&targets.jobs);
        for (((state, outcome), target), job) in states.zip(&binding.plan.jobs).filter(|(_, job)| is_solved(job.component as usize)) {
            let component = &mut self.components[job.component as usize];
            if !target.frame.is_active {
                component.wide += target.volume;
                continue;
            }
            state.field = Field::new(&target.frame, &state.capacity, component.wide_capacity, target.volume);
            component.wide += target.volume - state.field.volume;
            outcome.count(&state.field);
        }
        for (component, state) in self.components.iter_mut().enumerate().filter(|(component, _)| is_solved(*component)) {
            (state.wide_field, state.wide_residual) = (0.0, 0.0);
            if state.wide_capacity > 0.0 {
                state.wide_field = in_single_precision(state.wide / state.wide_capacity);
                let floor = targets.components[component].floor;
                state.wide_residual = in_single_precision((floor + state.wide.abs()) / state.wide_capacity);
            }
        }
    }

    /// Computes the fields of some jobs in each patch; `keep` takes what they make of each point's move.
    pub(super) fn add(
        &self,
        problem: Problem,
        swept: &Gradient,
        correction: &mut Correction,
        pass: Pass,
        keep: impl Fn(&mut Move, Move) + Sync,
    ) {
        let Problem { bound: Bound { binding, supports, settings }, mask, skinned, targets, .. } = problem;
        let (patches, Correction { moves, components: outcomes, .. }) = (&binding.patches, correction);
        let local = Some(&targets.local).filter(|local| local.is_used && matches!(pass, Pass::All | Pass::Shell));
        let (gradient, places) = (swept.rows.each_ref().map(|c| &**c), skinned.places.near.each_ref().map(|c| &**c));
        for_each_piece(patches.list.len(), Ragged::new(moves, &patches.slot_offsets), &|index, moves| {
            let patch = &patches.list[index];
            if pass.passes_over(patch.component) {
                return;
            }
            with_scratch(|scratch| {
                let slots = patch.start..patches.slot_offsets[index + 1] as usize;
                let (gradient, places) = (gradient.map(|row| &row[slots.clone()]), places.map(|row| &row[slots.clone()]));
                let areas = &binding.inverse_areas[slots.clone()];
                let component = &self.components[patch.component as usize];
                let Scratch { fields: FieldRows { directions, volumes, lengths, bell, .. }, sum, .. } = scratch;
                patch_sums::directions(gradient, problem.normals(&self.components, index), areas, directions, volumes, lengths);
                if let Some(mask) = mask.and_then(|mask| mask.of_slots(slots.clone())) {
                    patch_sums::mask(mask, directions, volumes, lengths);
                }
                let is_wide = !matches!(pass, Pass::Some(_));
                sum.start(areas.len());
                if let Some(local) = local {
                    sum.add_local(&local.volumes[slots.clone()], &local.bounds[slots.clone()], gradient, areas, lengths);
                }
                let of_patch = supports.block_offsets[index] as usize..supports.block_offsets[index + 1] as usize;
                let profiled = self.profiled.get(of_patch).unwrap_or_default();
                for support in supports.of_patch(index) {
                    let (target, field) = (&targets.jobs[support.job], &self.jobs[support.job].field);
                    if !target.frame.is_active || !pass.concerns(support.job) {
                        continue;
                    }
                    let bell = &mut bell[..support.weights.len()];
                    let takes = target.volume.is_sign_negative();
                    sum.add_round(takes, field, support, places, &target.frame, bell);
                    if target.frame.has_axes() {
                        let has_profiles = settings[binding.plan.jobs[support.job].joint as usize].profiles.is_some();
                        let heights = if has_profiles { &profiled[support.blocks()] } else { &*bell };
                        sum.add_shaped(takes, field, support.present, heights, directions);
                    }
                }
                let shell = if is_wide { [component.wide_field, component.wide_residual] } else { [0.0; 2] };
                sum.end(areas, shell, !outcomes[patch.component as usize].is_wide_only, directions, moves.values, &keep);
            });
        });
    }
}

impl JobOutcome {
    /// Counts what a field does.
    pub(super) fn count(&mut self, field: &Field) {
        self.regained += field.volume;
        self.displacement += field.displacement;
        self.is_capped |= field.is_capped;
    }
}

/// Sums the parts of the gradient at the points that a patch shares.
pub(super) fn import_gradient(binding: &Binding, index: usize, sources: &[V4], sum: &mut Buffer, gradient: &mut [&mut [f32]; 3]) {
    let patches = &binding.patches;
    let patch = &patches.list[index];
    sum[..patch.shared].copy_from_slice(&sources[patches.source_offsets[index] as usize..][..patch.shared]);
    for import in patches.imports.row(index) {
        let sum = &mut sum[usize::from(import.owned)];
        *sum = add(*sum, sources[import.source as usize]);
    }
    let per_area = 1.0 / (GRADIENT_PARTS * binding.area_unit);
    for (axis, row) in gradient.iter_mut().enumerate() {
        for (g, sum) in row.iter_mut().zip(&sum[..patch.shared]) {
            *g = (sum[axis] * per_area) as f32;
        }
    }
}
