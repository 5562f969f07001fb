//! Joint after joint, axis after axis, each on the mesh so far: the order of \[RHC09\].

use fearless_simd::{Level, dispatch};

use super::pass::Pass;
use super::skin::{keep_gradient, sweep_giants};
use super::{JobState, Workspace, ragged, widened};
use crate::binding::Binding;
use crate::fields::field::Field;
use crate::fields::joint::Joint;
use crate::fields::supports::Supports;
use crate::numeric::block_rows::PATCH_POINTS;
use crate::numeric::lanes::{self, add};
use crate::parallel::split::{Ragged, for_each_piece};
use crate::surface::sweeps::{self, Buffer};

impl Workspace {
    /// The paper's order: parents first, axis after axis, each on the mesh so far. The residual's field stays as `correct_simultaneously` made it.
    pub(crate) fn correct_sequentially(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint]) {
        self.add_fields(
            binding,
            supports,
            settings,
            Pass::Shell,
            #[inline(always)]
            |old, new| old.by = new.by,
        );
        for joint in 0..binding.motions.tree.len() {
            let is_mine = |job: usize, jobs: &[JobState]| binding.plan.jobs[job].joint as usize == joint && jobs[job].frame.is_active;
            let mine: Vec<usize> = (0..self.jobs.len()).filter(|&job| is_mine(job, &self.jobs)).collect();
            if mine.is_empty() {
                continue;
            }
            for job in &mine {
                let state = &mut self.jobs[*job];
                (state.regained, state.displacement, state.is_capped) = (0.0, 0.0, false);
            }
            let shares: Vec<[f64; 4]> = mine.iter().map(|&j| self.jobs[j].frame.ordered_shares(&self.jobs[j].capacity)).collect();
            for step in 0..4 {
                if shares.iter().all(|s| s[step] == 0.0) {
                    continue;
                }
                self.sweep_gradient(binding, true);
                self.sum_capacities(binding, supports, settings, Pass::Some(&mine));
                for (&job, shares) in mine.iter().zip(&shares) {
                    let state = &mut self.jobs[job];
                    let shell = self.components[binding.plan.jobs[job].component as usize].wide_capacity;
                    state.use_field(Field::new(&state.frame.for_step(step), &state.capacity, shell, state.volume * shares[step]));
                }
                self.add_fields(
                    binding,
                    supports,
                    settings,
                    Pass::Some(&mine),
                    #[inline(always)]
                    |old, new| {
                        old.by = std::array::from_fn(|i| old.by[i] + new.by[i]);
                    },
                );
            }
        }
        // What is left starts from the skinned surface, if it must.
        self.sweep_gradient(binding, false);
        self.sum_capacities(binding, supports, settings, Pass::Shell);
    }

    /// Gradient of the surface moved so far, or as skinned.
    fn sweep_gradient(&mut self, binding: &Binding, is_moved: bool) {
        let level = Level::new();
        let patches = &binding.patches;
        let (skinned, moves) = (&self.skinned, &self.moves);
        let place = |slot: usize| if is_moved { add(skinned.at(slot), widened(moves[slot].by)) } else { skinned.at(slot) };
        let (sources, giant_sources) = self.sources.split_at_mut(patches.patch_source_count());
        let arrays = (ragged(&mut self.gradient, &patches.slot_offsets), Ragged::new(sources, &patches.source_offsets));
        for_each_piece(patches.list.len(), arrays, &|index, (gradient, sources)| {
            let patch = &patches.list[index];
            let (mut p, mut by_point): (Buffer, Buffer) = ([lanes::ZERO; PATCH_POINTS], [lanes::ZERO; PATCH_POINTS]);
            for (p, &slot) in p.iter_mut().zip(&patches.local[patch.local.clone()]) {
                *p = place(slot as usize);
            }
            let gradient = gradient.map(|row| row.values);
            dispatch!(level, simd => {
                sweeps::volume_and_gradient(simd, patches, patch, &p, &mut by_point);
                keep_gradient(simd, binding, patch, &by_point, gradient, sources.values);
            });
        });
        sweep_giants(binding, &mut self.giant_volumes, giant_sources, place);
    }
}
