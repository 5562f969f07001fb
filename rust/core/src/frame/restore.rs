//! The volume restored once more, with some points held where they stand.

use super::buffers::{ComponentOutcome, ComponentTarget, Correction, JobOutcome, Solution, Targets};
use super::local::Local;
use super::pass::{Pass, Restart};
use super::{Bound, Mask, Problem, widened};
use crate::fields::patch_sums::Move;
use crate::numeric::lanes;
use crate::surface::patches::NO_SLOT;

/// Volumes estimated by first derivatives are trusted within this factor of what is really missing.
const ESTIMATE_MAX: f64 = 2.0;

/// What a solved frame does, so that a failed repair can be undone.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    pub moves: Vec<Move>,
    jobs: Vec<JobOutcome>,
    components: Vec<ComponentOutcome>,
}

impl Correction {
    pub(super) fn outcome(&self) -> Outcome {
        Outcome { moves: self.moves.clone(), jobs: self.jobs.clone(), components: self.components.clone() }
    }

    pub(super) fn go_back_to(&mut self, outcome: &Outcome) {
        self.moves.clone_from(&outcome.moves);
        self.jobs.clone_from(&outcome.jobs);
        self.components.clone_from(&outcome.components);
    }
}

impl Solution {
    /// From the `first` outcome: takes each point to its share of the displacement it had there, and gives the volume back
    /// with points as free as said, both per point. Components in which all is as it was are left alone, to the last bit.
    ///
    /// True when all components have their volume as exactly as they had it, or as `exact` relatively.
    pub(super) fn restore(&mut self, problem: Problem, first: &Outcome, (shares, freedom): (&[f64], &[f64]), exact: f64) -> bool {
        let Problem { bound: Bound { binding, .. }, targets, .. } = problem;
        self.correction.go_back_to(first);
        let mut concerns = vec![false; targets.components.len()];
        let mut of_slot = vec![(1.0, 1.0); binding.patches.slot_count()];
        for (&slot, (&share, &free)) in
            binding.patches.slot_of_point.iter().zip(shares.iter().zip(freedom)).filter(|(slot, _)| **slot != NO_SLOT)
        {
            of_slot[slot as usize] = (share, free);
        }
        for (index, patch) in binding.patches.list.iter().enumerate() {
            let slots = patch.start..binding.patches.slot_offsets[index + 1] as usize;
            concerns[patch.component as usize] |= of_slot[slots].iter().any(|held| *held != (1.0, 1.0));
        }
        self.correction.stand(problem, &concerns, &of_slot);
        let states = targets.components.iter().zip(&self.correction.components);
        let gaps = states.map(|(target, state)| target.target - state.cubic.0[0]).collect();
        let again = Restart { is_affected: concerns, gaps, moves: self.correction.moves.clone() };
        let targets = self.share_gaps(problem, first, &again, &of_slot);
        let mask = held(problem, &of_slot);
        let problem = Problem { mask: Some(&mask), targets: &targets, ..problem };
        let pass = Pass::Again(&again);
        let Self { gradient, fields, correction } = &mut *self;
        fields.sum_capacities(problem, gradient, pass);
        fields.solve(problem, &mut correction.jobs, pass);
        fields.add(problem, gradient, correction, pass, |old, new| {
            *old = Move { by: std::array::from_fn(|i| old.by[i] + new.by[i]), residual: new.residual };
        });
        self.remove_residual(problem, pass);
        let error = |state: &ComponentOutcome, target: &ComponentTarget| ((state.corrected - target.target) / target.target).abs();
        let states = self.correction.components.iter().zip(&first.components).zip(&targets.components);
        let states = states.zip(&again.is_affected).filter(|(_, concerned)| **concerned).map(|(states, _)| states);
        states.map(|((now, before), target)| (error(now, target), error(before, target))).all(|(now, before)| now <= exact.max(before))
    }

    /// What each joint is to give again: of each point's part of the gap, by the volumes that they gave there at first.
    fn share_gaps(&mut self, problem: Problem, first: &Outcome, again: &Restart, of_slot: &[(f64, f64)]) -> Targets {
        let Problem { bound: Bound { binding, supports, .. }, targets, .. } = problem;
        let mut lost = vec![0.0; targets.jobs.len()];
        let mut lost_by_shell = vec![0.0; targets.components.len()];
        let mut weights: Vec<(usize, f64)> = Vec::new();
        for (index, patch) in binding.patches.list.iter().enumerate().filter(|(_, patch)| again.is_affected[patch.component as usize]) {
            let (start, end) = (patch.start, binding.patches.slot_offsets[index + 1] as usize);
            for slot in (start..end).filter(|&slot| of_slot[slot].0 < 1.0) {
                let step = first.components[patch.component as usize].step;
                let point = &first.moves[slot];
                let moved = lanes::add_scaled(widened(point.by), widened(point.residual), if step.is_nan() { 0.0 } else { step });
                let slope = [0, 1, 2].map(|axis| f64::from(self.gradient.rows[axis][slot]) * moved[axis]);
                let part = (1.0 - of_slot[slot].0) * slope.iter().sum::<f64>() * binding.area_unit;
                weights.clear();
                for support in supports.of_patch(index) {
                    let state = &targets.jobs[support.job];
                    let weight = support.weight(slot - start);
                    if state.frame.is_active && weight > 0.0 {
                        weights.push((support.job, f64::from(weight) * state.volume.abs()));
                    }
                }
                let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
                for &(job, weight) in weights.iter().filter(|_| sum > 0.0) {
                    lost[job] += part * weight / sum;
                }
                if sum <= 0.0 {
                    lost_by_shell[patch.component as usize] += part;
                }
            }
        }
        let mut sums = lost_by_shell.clone();
        for (job, lost) in binding.plan.jobs.iter().zip(&lost) {
            sums[job.component as usize] += lost;
        }
        let scales: Vec<f64> = sums.iter().zip(&again.gaps).map(|(sum, gap)| trusted(*gap / *sum)).collect();
        let mut next = Targets { jobs: targets.jobs.clone(), components: targets.components.clone(), local: Local::default() };
        let states = next.jobs.iter_mut().zip(&mut self.correction.jobs).zip(&binding.plan.jobs);
        for (((target, outcome), job), lost) in states.zip(lost) {
            let component = job.component as usize;
            if again.is_affected[component] {
                target.volume = lost * scales[component];
                target.frame = target.frame.after(outcome.displacement);
                outcome.regained -= target.volume;
            }
        }
        for (component, state) in next.components.iter_mut().enumerate().filter(|(component, _)| again.is_affected[*component]) {
            let given = (sums[component] - lost_by_shell[component]) * scales[component];
            state.wide = again.gaps[component] - given;
        }
        next
    }
}

impl Correction {
    /// Points at their shares of their displacements; the volume there, as the cubics' constants.
    fn stand(&mut self, problem: Problem, concerns: &[bool], of_slot: &[(f64, f64)]) {
        let binding = problem.bound.binding;
        for (index, patch) in binding.patches.list.iter().enumerate().filter(|(_, patch)| concerns[patch.component as usize]) {
            let step = self.components[patch.component as usize].step;
            let step = if step.is_nan() { 0.0 } else { step };
            let slots = patch.start..binding.patches.slot_offsets[index + 1] as usize;
            for (point, &(share, _)) in self.moves[slots.clone()].iter_mut().zip(&of_slot[slots]) {
                let moved = lanes::scale(lanes::add_scaled(widened(point.by), widened(point.residual), step), share);
                *point = Move { by: std::array::from_fn(|i| moved[i] as f32), residual: [0.0; 4] };
            }
        }
        for (state, _) in self.components.iter_mut().zip(concerns).filter(|(_, concerned)| **concerned) {
            (state.is_wide_only, state.is_linear_only, state.step) = (false, false, 0.0);
        }
        self.sweep_cubics(problem);
    }
}

/// What the artist leaves of each point's weight, and holding it.
fn held(problem: Problem, of_slot: &[(f64, f64)]) -> Mask {
    let Problem { mask, targets, .. } = problem;
    let is_pinned = mask.map_or_else(|| vec![false; targets.components.len()], |mask| mask.is_pinned.clone());
    let of_artist = |slot: usize| mask.map_or(1.0, |mask| mask.of_slot[slot]);
    Mask { of_slot: of_slot.iter().enumerate().map(|(slot, held)| of_artist(slot) * held.1 as f32).collect(), is_pinned }
}

fn trusted(scale: f64) -> f64 {
    if (ESTIMATE_MAX.recip()..=ESTIMATE_MAX).contains(&scale) { scale } else { f64::from(u8::from(scale > 0.0)) }
}
