//! What each joint has lost, and what each component is to have.

use super::buffers::{ComponentTarget, JobTarget, Losses, Posed, Skinned, Staged, Targets};
use super::{Bound, Pose, flesh};
use crate::binding::Binding;
use crate::fields::field::FieldFrame;
use crate::flesh::shape::Shape;
use crate::volume_losses::hung::hand_on;

/// Losses below this part of a component's volume share a residual with the whole shell instead of taking all of it.
const LOSS_FLOOR: f64 = 1e-3;

impl Losses {
    /// Those that no skinned point is needed for.
    pub(super) fn measure_forms(&mut self, binding: &Binding, posed: &Posed, flesh: &Shape) {
        if let (false, Some(forms), Some(buffers)) = (posed.body.is_staged(binding), &binding.plan.forms, &mut self.forms) {
            forms.measure(flesh.of_losses(&posed.motions), buffers);
        }
    }

    /// All of them.
    pub(super) fn gather(&mut self, binding: &Binding, posed: &Posed, flesh: &Shape, staged: &Staged) {
        let (motions, changes) = (flesh.of_losses(&posed.motions), &mut self.changes);
        let is_staged = posed.body.is_staged(binding);
        binding.plan.carry(motions, &staged.job_moments, changes);
        match (is_staged, &binding.plan.forms, &self.forms) {
            (false, Some(forms), Some(buffers)) => forms.gather(buffers, changes),
            _ => binding.plan.stages.gather(&staged.changes, changes),
        }
        binding.plan.carry_shells(motions, is_staged, &staged.portion_moments, changes);
        hand_on(&binding.plan.jobs, motions, changes);
    }
}

impl Targets {
    /// Volumes at rest and as skinned.
    pub(super) fn weigh(&mut self, binding: &Binding, posed: &Posed, flesh: &Shape, skinned: &Skinned, staged: &Staged) {
        self.components.fill(ComponentTarget::default());
        // Moments are about the rest mesh in object space.
        let armature_from_object = posed.object.matrix3.determinant().recip();
        let portions = binding.plan.portions(posed.body.is_staged(binding));
        for (moment, &component) in staged.portion_moments.iter().zip(&portions.components) {
            self.components[component as usize].rest += moment.0 * armature_from_object;
        }
        for (patch, found) in binding.patches.list.iter().zip(&skinned.patches) {
            let state = &mut self.components[patch.component as usize];
            state.skinned += found.volume;
            state.bare += found.bare;
        }
        for (giant, volume) in binding.patches.giants.iter().zip(&skinned.giant_volumes) {
            let state = &mut self.components[giant.component as usize];
            state.skinned += volume;
            state.bare += volume;
        }
        self.take_flesh_from_giants(binding, flesh, skinned);
    }

    /// What each component is to have, and the volume each job is to give back.
    pub(super) fn measure(&mut self, bound: Bound, pose: &Pose, (posed, flesh, skinned, losses): (&Posed, &Shape, &Skinned, &Losses)) {
        let Bound { binding, supports, settings } = bound;
        for state in &mut self.components {
            state.target = state.rest;
        }
        self.jobs.fill(JobTarget::default());
        for (index, (job, change)) in binding.plan.jobs.iter().zip(&losses.changes).enumerate() {
            let joint = job.joint as usize;
            let bone = binding.motions.tree.bones[joint] as usize;
            if pose.is_fleshed.is_some_and(|bones| bones[bone]) {
                self.components[job.component as usize].target += change.intent;
                continue;
            }
            let strength = pose.strengths.map_or(settings[joint].strength, |s| s[bone]);
            let given_back = strength * change.loss;
            let state = &mut self.components[job.component as usize];
            state.target += change.intent + (given_back - change.loss);
            match supports.heirs[index] {
                Some(heir) => self.jobs[heir as usize].volume += given_back,
                None => state.wide += given_back,
            }
        }
        let missing = || missing_by_component(binding, &self.components, losses);
        if self.local.find(bound, pose, &skinned.places, (&skinned.offsets, posed.added.rounding), missing) {
            for (&job, volume) in supports.jobs_of_patch.values().iter().zip(self.local.of_joints()) {
                self.jobs[job as usize].volume += volume;
            }
        }
        for (state, job) in self.jobs.iter().zip(&binding.plan.jobs) {
            self.components[job.component as usize].spread += state.volume.abs();
        }
        for state in &mut self.components {
            state.floor = LOSS_FLOOR * state.rest.abs();
            state.spread += state.floor;
        }
        if pose.target_scale != 1.0 {
            self.breathe(binding, pose.target_scale);
        }
        for (index, job) in binding.plan.jobs.iter().enumerate() {
            let joint = job.joint as usize;
            let volume = self.jobs[index].volume;
            let mut frame = FieldFrame::new(&posed.motions, joint, &settings[joint], supports, volume);
            flesh::halve(flesh, binding, posed, joint, &mut frame);
            self.jobs[index].frame = frame;
        }
    }

    /// Spreads a change of target by what each joint gives back anyway, the rest over the whole shell.
    fn breathe(&mut self, binding: &Binding, target_scale: f64) {
        for (state, job) in self.jobs.iter_mut().zip(&binding.plan.jobs) {
            let component = &self.components[job.component as usize];
            if component.spread > 0.0 {
                state.volume += component.target * (target_scale - 1.0) * state.volume.abs() / component.spread;
            }
        }
        for state in &mut self.components {
            let change = state.target * (target_scale - 1.0);
            if state.spread > 0.0 {
                state.wide += change * state.floor / state.spread;
            }
            state.target += change;
        }
    }
}

/// Per component, how much less there is with what is added than as skinned.
fn missing_by_component(binding: &Binding, components: &[ComponentTarget], losses: &Losses) -> Vec<f64> {
    let mut missing: Vec<f64> = components.iter().map(|state| state.rest - state.skinned).collect();
    for (job, change) in binding.plan.jobs.iter().zip(&losses.changes) {
        missing[job.component as usize] += change.intent - change.loss;
    }
    missing
}
