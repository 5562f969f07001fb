//! Joint after joint, axis after axis, each on the mesh so far: the order of \[RHC09\].

use fearless_simd::{Level, dispatch};

use super::buffers::{Gradient, JobOutcome, Solution};
use super::pass::Pass;
use super::places::ragged;
use super::skin::{keep_gradient, sweep_giants};
use super::{Bound, Problem, widened};
use crate::fields::field::Field;
use crate::fields::patch_sums::Move;
use crate::numeric::block_rows::PATCH_POINTS;
use crate::numeric::lanes::{self, add};
use crate::parallel::split::{Ragged, for_each_piece};
use crate::surface::sweeps::{self, Buffer};

impl Solution {
    /// The paper's order: parents first, axis after axis, each on the mesh so far. The residual's field stays as
    /// `correct_simultaneously` made it.
    pub(super) fn correct_sequentially(&mut self, problem: Problem) {
        let Problem { bound: Bound { binding, .. }, targets, .. } = problem;
        let Self { gradient, fields, correction } = self;
        fields.add(
            problem,
            gradient,
            correction,
            Pass::Shell,
            #[inline(always)]
            |old, new| old.by = new.by,
        );
        for joint in 0..binding.motions.tree.len() {
            let is_mine = |job: usize| binding.plan.jobs[job].joint as usize == joint && targets.jobs[job].frame.is_active;
            let mine: Vec<usize> = (0..targets.jobs.len()).filter(|&job| is_mine(job)).collect();
            if mine.is_empty() {
                continue;
            }
            for job in &mine {
                correction.jobs[*job] = JobOutcome::default();
            }
            let shares: Vec<[f64; 4]> =
                mine.iter().map(|&job| targets.jobs[job].frame.ordered_shares(&fields.jobs[job].capacity)).collect();
            for step in 0..4 {
                if shares.iter().all(|s| s[step] == 0.0) {
                    continue;
                }
                gradient.sweep(problem, Some(&correction.moves));
                fields.sum_capacities(problem, gradient, Pass::Some(&mine));
                for (&job, shares) in mine.iter().zip(&shares) {
                    let (target, state) = (&targets.jobs[job], &mut fields.jobs[job]);
                    let shell = fields.components[binding.plan.jobs[job].component as usize].wide_capacity;
                    state.field =
                        Field::new(&target.frame.for_step(step, shares[step]), &state.capacity, shell, target.volume * shares[step]);
                    correction.jobs[job].count(&state.field);
                }
                fields.add(
                    problem,
                    gradient,
                    correction,
                    Pass::Some(&mine),
                    #[inline(always)]
                    |old, new| {
                        old.by = std::array::from_fn(|i| old.by[i] + new.by[i]);
                    },
                );
            }
        }
        // What is left starts from the skinned surface, if it must.
        gradient.sweep(problem, None);
        fields.sum_capacities(problem, gradient, Pass::Shell);
    }
}

impl Gradient {
    /// Of the surface moved so far; as skinned without moves.
    fn sweep(&mut self, problem: Problem, moves: Option<&[Move]>) {
        let level = Level::new();
        let (binding, skinned) = (problem.bound.binding, &problem.skinned.places);
        let patches = &binding.patches;
        let place = |slot: usize| moves.map_or(skinned.at(slot), |moves| add(skinned.at(slot), widened(moves[slot].by)));
        let (sources, giant_sources) = self.sources.split_at_mut(patches.patch_source_count());
        let arrays = (ragged(&mut self.rows, &patches.slot_offsets), Ragged::new(sources, &patches.source_offsets));
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
        sweep_giants(binding, giant_sources, place, |_, _| {});
    }
}
