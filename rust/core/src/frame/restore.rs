//! The volume restored once more, with some points held where they stand.

use std::sync::Arc;

use super::pass::{Pass, Restart};
use super::{ComponentState, JobState, Mask, Workspace, widened};
use crate::binding::Binding;
use crate::fields::joint::Joint;
use crate::fields::patch_sums::Move;
use crate::fields::supports::Supports;
use crate::numeric::lanes;
use crate::surface::patches::NO_SLOT;

/// Volumes estimated by first derivatives are trusted within this factor of what is really missing.
const ESTIMATE_MAX: f64 = 2.0;

/// A snapshot of a solved frame, so that a failed repair can be undone.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    pub moves: Vec<Move>,
    components: Vec<ComponentState>,
    jobs: Vec<JobState>,
}

impl Workspace {
    pub(super) fn outcome(&self) -> Outcome {
        Outcome { moves: self.moves.clone(), components: self.components.clone(), jobs: self.jobs.clone() }
    }

    pub(super) fn go_back_to(&mut self, outcome: &Outcome) {
        self.moves.clone_from(&outcome.moves);
        self.components.clone_from(&outcome.components);
        self.jobs.clone_from(&outcome.jobs);
    }

    /// From the `first` outcome: takes each point to its share of the displacement it had there, and gives the volume back
    /// with points as free as said, both per point. Components in which all is as it was are left alone, to the last bit.
    ///
    /// True when all components have their volume as exactly as they had it, or as `exact` relatively.
    pub(super) fn restore(
        &mut self,
        binding: &Binding,
        supports: &Supports,
        settings: &[Joint],
        first: &Outcome,
        (shares, freedom): (&[f64], &[f64]),
        exact: f64,
    ) -> bool {
        self.go_back_to(first);
        let mut concerns = vec![false; self.components.len()];
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
        self.stand(binding, &concerns, &of_slot);
        let gaps = self.components.iter().map(|state| state.target - state.cubic.0[0]).collect();
        let again = Restart { is_affected: concerns, gaps, moves: self.moves.clone() };
        self.share_gaps(binding, supports, first, &again, &of_slot);
        self.mask = Some(Arc::new(self.held(&of_slot)));
        let pass = Pass::Again(&again);
        self.sum_capacities(binding, supports, settings, pass);
        self.solve(binding, pass);
        self.add_fields(binding, supports, settings, pass, |old, new| {
            *old = Move { by: std::array::from_fn(|i| old.by[i] + new.by[i]), residual: new.residual };
        });
        self.remove_residual_of(binding, supports, settings, pass);
        let error = |state: &ComponentState| ((state.corrected - state.target) / state.target).abs();
        let states = self.components.iter().zip(&first.components).zip(&again.is_affected).filter(|(_, concerned)| **concerned);
        states.map(|(states, _)| states).all(|(now, before)| error(now) <= exact.max(error(before)))
    }

    /// Points at their shares of their displacements; the volume there, as the cubics' constants.
    fn stand(&mut self, binding: &Binding, concerns: &[bool], of_slot: &[(f64, f64)]) {
        for (index, patch) in binding.patches.list.iter().enumerate().filter(|(_, patch)| concerns[patch.component as usize]) {
            let state = &mut self.components[patch.component as usize];
            let step = if state.step.is_nan() { 0.0 } else { state.step };
            let slots = patch.start..binding.patches.slot_offsets[index + 1] as usize;
            for (point, &(share, _)) in self.moves[slots.clone()].iter_mut().zip(&of_slot[slots]) {
                let moved = lanes::scale(lanes::add_scaled(widened(point.by), widened(point.residual), step), share);
                *point = Move { by: std::array::from_fn(|i| moved[i] as f32), residual: [0.0; 4] };
            }
        }
        for (state, _) in self.components.iter_mut().zip(concerns).filter(|(_, concerned)| **concerned) {
            (state.is_wide_only, state.is_linear_only, state.step) = (false, false, 0.0);
        }
        self.sweep_cubics(binding);
    }

    /// What each joint is to give again: of each point's part of the gap, by the volumes that they gave there at first.
    fn share_gaps(&mut self, binding: &Binding, supports: &Supports, first: &Outcome, again: &Restart, of_slot: &[(f64, f64)]) {
        let mut lost = vec![0.0; self.jobs.len()];
        let mut lost_by_shell = vec![0.0; self.components.len()];
        let mut weights: Vec<(usize, f64)> = Vec::new();
        for (index, patch) in binding.patches.list.iter().enumerate().filter(|(_, patch)| again.is_affected[patch.component as usize]) {
            let (start, end) = (patch.start, binding.patches.slot_offsets[index + 1] as usize);
            for slot in (start..end).filter(|&slot| of_slot[slot].0 < 1.0) {
                let step = first.components[patch.component as usize].step;
                let point = &first.moves[slot];
                let moved = lanes::add_scaled(widened(point.by), widened(point.residual), if step.is_nan() { 0.0 } else { step });
                let slope = [0, 1, 2].map(|axis| f64::from(self.gradient[axis][slot]) * moved[axis]);
                let part = (1.0 - of_slot[slot].0) * slope.iter().sum::<f64>() * binding.area_unit;
                weights.clear();
                for support in supports.of_patch(index) {
                    let state = &self.jobs[support.job];
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
        for ((state, job), lost) in self.jobs.iter_mut().zip(&binding.plan.jobs).zip(lost) {
            let component = job.component as usize;
            if again.is_affected[component] {
                state.volume = lost * scales[component];
                state.regained -= state.volume;
                state.frame = state.frame.after(state.displacement);
            }
        }
        for (component, state) in self.components.iter_mut().enumerate().filter(|(component, _)| again.is_affected[*component]) {
            let given = (sums[component] - lost_by_shell[component]) * scales[component];
            state.wide = again.gaps[component] - given;
        }
    }

    /// What the artist leaves of each point's weight, and holding it.
    fn held(&self, of_slot: &[(f64, f64)]) -> Mask {
        let is_pinned = self.mask.as_ref().map_or_else(|| vec![false; self.components.len()], |mask| mask.is_pinned.clone());
        let of_artist = |slot: usize| self.mask.as_ref().map_or(1.0, |mask| mask.of_slot[slot]);
        Mask { of_slot: of_slot.iter().enumerate().map(|(slot, held)| of_artist(slot) * held.1 as f32).collect(), is_pinned }
    }
}

fn trusted(scale: f64) -> f64 {
    if (ESTIMATE_MAX.recip()..=ESTIMATE_MAX).contains(&scale) { scale } else { f64::from(u8::from(scale > 0.0)) }
}
