//! All joints give back at once: sums over the gradient, how much of each field, displacements.

use super::carried::carried;
use super::pass::Pass;
use super::scratch::{Scratch, with_scratch};
use super::{JobState, Workspace, in_single_precision, ragged};
use crate::binding::Binding;
use crate::fields::field::{Capacity, Field};
use crate::fields::joint::Joint;
use crate::fields::patch_sums::{self, FieldRows, Move};
use crate::fields::profile_weights;
use crate::fields::supports::Supports;
use crate::numeric::block_rows::Present;
use crate::numeric::lanes::{V4, add};
use crate::parallel::split::{Ragged, for_each_piece};
use crate::surface::sweeps::{Buffer, GRADIENT_PARTS};

impl Workspace {
    /// Displacements by all fields at once, and the field of the residual: the same with every joint giving, none taking.
    pub(crate) fn correct_simultaneously(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint]) {
        self.carry_normals(binding, supports);
        self.sum_capacities(binding, supports, settings, Pass::All);
        self.solve(binding, Pass::All);
        self.add_fields(
            binding,
            supports,
            settings,
            Pass::All,
            #[inline(always)]
            |old, new| *old = new,
        );
    }

    /// Reads the gradient and sums what each field could do with it.
    pub(super) fn sum_capacities(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint], pass: Pass) {
        let (patches, jobs, sources, mask) = (&binding.patches, &self.jobs, &self.sources, self.mask.as_deref());
        let carried = carried(&self.carried, self.carries_normals, binding);
        let (places, has_profiles) = (self.skinned.near.each_ref().map(|c| &**c), !self.profiled.is_empty());
        let profile_offsets = if has_profiles { &supports.block_offsets } else { &patches.no_rows };
        for_each_piece(
            patches.list.len(),
            (
                ragged(&mut self.gradient, &patches.slot_offsets),
                Ragged::new(&mut self.profiled, profile_offsets),
                Ragged::new(&mut self.capacities, supports.jobs_of_patch.offsets()),
                &mut *self.patches,
            ),
            &|index, (gradient, profiled, capacities, sums)| {
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
                    let normals = carried.map(|normals| normals.of(&slots));
                    patch_sums::directions(gradient, normals, areas, directions, volumes, lengths);
                    if let Some(mask) = mask {
                        *unmasked = *volumes;
                        patch_sums::mask(&mask.of_slot[slots.clone()], directions, volumes, lengths);
                    }
                    let places = places.map(|row| &row[slots.clone()]);
                    let (all, _) = areas.as_chunks();
                    sums[0].wide_capacity = patch_sums::sum_and_most(Present::first(all.len()), all, volumes, lengths).0;
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
        for (patch, sums) in patches.list.iter().zip(&self.patches) {
            self.components[patch.component as usize].wide_capacity += sums.wide_capacity * binding.area_unit;
        }
    }

    /// How much of each field.
    pub(super) fn solve(&mut self, binding: &Binding, pass: Pass) {
        for (state, job) in self.jobs.iter_mut().zip(&binding.plan.jobs).filter(|(_, job)| !pass.passes_over(job.component)) {
            let component = &mut self.components[job.component as usize];
            if !state.frame.is_active {
                component.wide += state.volume;
                continue;
            }
            let field = Field::new(&state.frame, &state.capacity, component.wide_capacity, state.volume);
            component.wide += state.volume - field.volume;
            state.use_field(field);
        }
        for (_, state) in (0..).zip(&mut self.components).filter(|(component, _)| !pass.passes_over(*component)) {
            if state.wide_capacity > 0.0 {
                state.wide_field = in_single_precision(state.wide / state.wide_capacity);
                state.wide_residual = in_single_precision((state.floor + state.wide.abs()) / state.wide_capacity);
            }
        }
    }

    /// Computes the fields of some jobs in each patch; `keep` takes what they make of each point's move.
    pub(super) fn add_fields(
        &mut self,
        binding: &Binding,
        supports: &Supports,
        settings: &[Joint],
        pass: Pass,
        keep: impl Fn(&mut Move, Move) + Sync,
    ) {
        let (jobs, components, patches, mask) = (&self.jobs, &self.components, &binding.patches, self.mask.as_deref());
        let carried = carried(&self.carried, self.carries_normals, binding);
        let local = Some(&self.local).filter(|local| local.is_used && matches!(pass, Pass::All | Pass::Shell));
        let (gradient, places, profiled) =
            (self.gradient.each_ref().map(|c| &**c), self.skinned.near.each_ref().map(|c| &**c), &self.profiled);
        for_each_piece(patches.list.len(), Ragged::new(&mut self.moves, &patches.slot_offsets), &|index, moves| {
            let patch = &patches.list[index];
            if pass.passes_over(patch.component) {
                return;
            }
            with_scratch(|scratch| {
                let slots = patch.start..patches.slot_offsets[index + 1] as usize;
                let (gradient, places) = (gradient.map(|row| &row[slots.clone()]), places.map(|row| &row[slots.clone()]));
                let areas = &binding.inverse_areas[slots.clone()];
                let component = &components[patch.component as usize];
                let Scratch { fields: FieldRows { directions, volumes, lengths, bell, .. }, sum, .. } = scratch;
                let normals = carried.map(|normals| normals.of(&slots));
                patch_sums::directions(gradient, normals, areas, directions, volumes, lengths);
                if let Some(mask) = mask {
                    patch_sums::mask(&mask.of_slot[slots.clone()], directions, volumes, lengths);
                }
                let is_wide = !matches!(pass, Pass::Some(_));
                sum.start(areas.len());
                if let Some(local) = local {
                    sum.add_local(&local.volumes[slots.clone()], &local.bounds[slots.clone()], gradient, areas, lengths);
                }
                let of_patch = supports.block_offsets[index] as usize..supports.block_offsets[index + 1] as usize;
                let profiled = profiled.get(of_patch).unwrap_or_default();
                for support in supports.of_patch(index) {
                    let state = &jobs[support.job];
                    if !state.frame.is_active || !pass.concerns(support.job) {
                        continue;
                    }
                    let bell = &mut bell[..support.weights.len()];
                    let takes = state.volume.is_sign_negative();
                    sum.add_round(takes, &state.field, support, places, &state.frame, bell);
                    if state.frame.has_axes() {
                        let has_profiles = settings[binding.plan.jobs[support.job].joint as usize].profiles.is_some();
                        let heights = if has_profiles { &profiled[support.blocks()] } else { &*bell };
                        sum.add_shaped(takes, &state.field, support.present, heights, directions);
                    }
                }
                let shell = if is_wide { [component.wide_field, component.wide_residual] } else { [0.0; 2] };
                sum.end(areas, shell, !component.is_wide_only, directions, moves.values, &keep);
            });
        });
    }
}

impl JobState {
    /// Uses a field, and counts what it does.
    pub(super) fn use_field(&mut self, field: Field) {
        self.regained += field.volume;
        self.displacement += field.displacement;
        self.is_capped |= field.is_capped;
        self.field = field;
    }
}

/// Sums the parts of the gradient at the points that a patch shares.
fn import_gradient(binding: &Binding, index: usize, sources: &[V4], sum: &mut Buffer, gradient: &mut [&mut [f32]; 3]) {
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
