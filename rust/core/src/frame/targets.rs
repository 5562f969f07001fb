//! What each joint has lost, and what each component is to have.

use super::{ComponentState, JobState, Pose, Workspace};
use crate::binding::Binding;
use crate::fields::field::FieldFrame;
use crate::fields::joint::Joint;
use crate::fields::supports::Supports;
use crate::volume_losses::hung::hand_on;

/// Losses below this part of a component's volume share a residual with the whole shell instead of taking all of it.
const LOSS_FLOOR: f64 = 1e-3;

impl Workspace {
    /// Losses that no skinned point is needed for.
    pub(crate) fn measure_forms(&mut self, binding: &Binding) {
        let is_staged = self.is_staged(binding);
        if let (false, Some(forms), Some(buffers)) = (is_staged, &binding.plan.forms, &mut self.forms) {
            forms.measure(&self.motions, buffers);
        }
    }

    /// Losses, targets, and the volume each job is to give back.
    pub(crate) fn measure(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint], pose: &Pose) {
        binding.plan.carry(&self.motions, &self.job_moments, &mut self.changes);
        let is_staged = self.is_staged(binding);
        match (is_staged, &binding.plan.forms, &self.forms) {
            (false, Some(forms), Some(buffers)) => forms.gather(buffers, &mut self.changes),
            _ => binding.plan.stages.gather(&self.stage_changes, &mut self.changes),
        }
        binding.plan.carry_shells(&self.motions, is_staged, &self.portion_moments, &mut self.changes);
        hand_on(&binding.plan.jobs, &self.motions, &mut self.changes);
        self.components.fill(ComponentState::default());
        // Moments are about the rest mesh in object space.
        let armature_from_object = self.object.matrix3.determinant().recip();
        for (moment, &component) in self.portion_moments.iter().zip(&binding.plan.portions(is_staged).components) {
            self.components[component as usize].rest += moment.0 * armature_from_object;
        }
        for (patch, sums) in binding.patches.list.iter().zip(&self.patches) {
            self.components[patch.component as usize].skinned += sums.volume;
        }
        for (giant, volume) in binding.patches.giants.iter().zip(&self.giant_volumes) {
            self.components[giant.component as usize].skinned += volume;
        }
        for state in &mut self.components {
            state.target = state.rest;
        }
        self.jobs.fill(JobState::default());
        for (index, (job, change)) in binding.plan.jobs.iter().zip(&self.changes).enumerate() {
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
        self.share_added_losses(binding, supports, settings, pose);
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
            self.jobs[index].frame = FieldFrame::new(&self.motions, joint, &settings[joint], supports.lengths[joint], volume);
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
