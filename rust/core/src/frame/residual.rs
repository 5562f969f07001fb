//! What the fields leave: removed by the exact cubic of the volume along one more field.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};

use super::buffers::{ComponentField, ComponentOutcome, ComponentTarget, Correction, Fields, Solution};
use super::pass::Pass;
use super::places::Places;
use super::scratch::{Scratch, with_scratch};
use super::{Problem, widened};
use crate::fields::patch_sums::Move;
use crate::numeric::block_rows::LANES;
use crate::numeric::lanes::add;
use crate::parallel::split::for_each_piece;
use crate::surface::patches::Patches;
use crate::surface::sweeps::{self, polygon_cubic};
use crate::surface::volume::VolumeCubic;

/// A component this near its target, relatively, has it: what is left is rounding.
const RESIDUAL_DONE: f64 = 1e-14;
/// A residual field that must be scaled beyond this has lost its meaning; the whole shell then takes the residual.
const RESIDUAL_STEP_MAX: f64 = 1.0;
/// A step of the whole shell that is worth so many times what is to be given back is past a summit of the cubic.
const BENT_MAX: f64 = 2.0;
/// Nearer to its target, relatively, a component comes unless the root lies at a summit, where digits are lost.
const SUMMIT_ERROR: f64 = 1e-13;

impl Solution {
    /// Steps along the residual's field until every component has its target, by the exact cubic.
    pub(super) fn remove_residual(&mut self, problem: Problem, pass: Pass) {
        let Self { gradient, fields, correction } = self;
        correction.find_steps(problem, fields, pass);
        if correction.components.iter().any(|state| state.is_wide_only) {
            // Fields that fight each other, or far too little skin: the whole shell takes what is left.
            fields.add(
                problem,
                gradient,
                correction,
                pass,
                #[inline(always)]
                |old, new| old.residual = new.residual,
            );
            correction.find_steps(problem, fields, pass);
        }
        if correction.components.iter().any(|state| state.is_linear_only) {
            correction.step_linearly(problem, gradient, fields, pass);
            correction.find_steps(problem, fields, pass);
        }
    }
}

impl Correction {
    fn find_steps(&mut self, problem: Problem, fields: &Fields, pass: Pass) {
        self.sweep_cubics(problem);
        let states = self.components.iter_mut().zip(&problem.targets.components).zip(&fields.components);
        for (_, ((state, target), field)) in (0..).zip(states).filter(|(component, _)| !pass.passes_over(*component)) {
            state.find_step(target, field, problem.mask.is_some());
        }
    }

    /// V(P + tR) of every component, P the points as moved so far and R the residual's field.
    pub(super) fn sweep_cubics(&mut self, problem: Problem) {
        let level = Level::new();
        let patches = &problem.bound.binding.patches;
        let (skinned, moves) = (&problem.skinned.places, &self.moves);
        for_each_piece(patches.list.len(), &mut *self.cubics, &|index, cubic| {
            cubic[0] = with_scratch(|scratch| dispatch!(level, simd => cubic_of_patch(simd, patches, index, skinned, moves, scratch)));
        });
        for state in &mut self.components {
            state.cubic = VolumeCubic::default();
        }
        for (patch, cubic) in patches.list.iter().zip(&self.cubics) {
            self.components[patch.component as usize].cubic.join(cubic);
        }
        for giant in &patches.giants {
            let corners = giant.corners.iter().map(|&slot| {
                let slot = slot as usize;
                (add(skinned.at(slot), widened(moves[slot].by)), widened(moves[slot].residual))
            });
            self.components[giant.component as usize].cubic.join(&polygon_cubic(corners));
        }
    }
}

impl ComponentOutcome {
    /// Finds the step along the residual's field, or whose field it must be instead.
    fn find_step(&mut self, target: &ComponentTarget, field: &ComponentField, is_masked: bool) {
        let state = self;
        let gap = target.target - state.cubic.0[0];
        let is_near = gap.abs() <= RESIDUAL_DONE * target.target.abs();
        let root = if is_near { Some(0.0) } else { state.cubic.root_nearest_zero(target.target) };
        let may_give_up = is_masked && !state.is_linear_only;
        // What a step of the shell adds by the slope at the skinned surface, against what is to be given back.
        let worth = |step: f64| step.abs() * (target.floor + field.wide.abs());
        let whole = target.spread + (target.target - target.skinned).abs();
        let is_exact = |step: f64| (state.cubic.at(step) - target.target).abs() <= SUMMIT_ERROR * target.target.abs();
        let is_within = |step: f64| {
            if state.is_wide_only { !may_give_up || worth(step) <= BENT_MAX * whole } else { step.abs() <= RESIDUAL_STEP_MAX }
        };
        let is_meant = |step: f64| is_within(step) && (!may_give_up || is_exact(step));
        match root.filter(|&step| is_meant(step)) {
            Some(step) => state.step = step,
            None if !state.is_wide_only => state.is_wide_only = true,
            None if may_give_up && field.wide_capacity > 0.0 => state.is_linear_only = true,
            None if state.cubic.0[0].is_finite() => state.step = 0.0,
            // Beyond all numbers: as skinned.
            None => state.step = f64::NAN,
        }
        state.corrected = if state.step == 0.0 { state.cubic.0[0] } else { state.cubic.at(state.step) };
        if state.step.is_nan() {
            state.corrected = target.skinned;
        }
    }
}

/// V(P + tR) of a patch, P the points as moved so far and R the residual's field.
#[inline(always)]
fn cubic_of_patch<S: Simd>(
    simd: S,
    patches: &Patches,
    index: usize,
    skinned: &Places,
    moves: &[Move],
    scratch: &mut Scratch,
) -> VolumeCubic {
    let patch = &patches.list[index];
    let Scratch { first: p, second: u, .. } = scratch;
    // Padding is 0, and foreign points come after it.
    let own = patch.start..patch.start + patch.owned.next_multiple_of(LANES);
    let rows = p.as_chunks_mut::<LANES>().0.iter_mut().zip(u.as_chunks_mut::<LANES>().0);
    for (number, (eight, (p, u))) in moves[own].as_chunks::<LANES>().0.iter().zip(rows).enumerate() {
        let [early, late] = skinned.eight(simd, patch.start / LANES + number);
        let (early, late) = (early.rows(simd), late.rows(simd));
        for i in 0..LANES {
            let (by, residual) = eight[i].lanes(simd).widen();
            let place = if i < 4 { early[i] } else { late[i - 4] };
            (p[i], u[i]) = ((place + by).into(), residual.into());
        }
    }
    for (i, &slot) in patches.local[patch.local.clone()].iter().enumerate().skip(patch.owned) {
        let point = moves[slot as usize];
        (p[i], u[i]) = (add(skinned.at(slot as usize), widened(point.by)), widened(point.residual));
    }
    sweeps::volume_cubic(simd, patches, patch, p, u)
}
