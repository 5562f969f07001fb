//! Whose volume is it: what each joint's turn takes from each component, by telescoping over joints [MATH §3].
//!
//! Parents first, one joint after the other turns with all below it following rigidly; the volumes before and after give
//! its loss. Faces that a turn carries whole change by a closed form of their volume and area vector. Faces that it
//! deforms change by a closed form too where skinning is linear (`closed_form`), else they are swept (`staged`).

use std::collections::HashSet;

use glam::DVec3;

use crate::skinning::blend::Mode;
use crate::skinning::motions::Motions;
use crate::volume_losses::closed_form::VolumeForms;
use crate::volume_losses::job::{Anatomy, Change, Job, Moment, Portions, find_job, moved_volume};
use crate::volume_losses::staged::Stages;

/// Everything about the telescoping that does not change from frame to frame.
pub(crate) struct LossPlan {
    pub jobs: Vec<Job>,
    /// How portions are skinned joint by joint.
    pub stages: Stages,
    staged: Portions,
    /// Losses in closed form: linear skinning of one rest shape; not of bodies that frames bring.
    pub forms: Option<VolumeForms>,
    formed: Portions,
}

impl LossPlan {
    /// `has_shapes`: the rest shape changes from frame to frame.
    pub fn new(anatomy: &Anatomy, mode: Mode, has_shapes: bool) -> Self {
        let Anatomy { topology, joints, tree, .. } = *anatomy;
        let mut jobs: Vec<Job> = Vec::new();
        let mut carried: HashSet<(u32, u32)> = HashSet::new();
        for ((&component, &top), below) in topology.component_of_face.iter().zip(&joints.tops).zip(joints.below.rows()) {
            // All that carry a face carry the others under the same joint.
            let is_new = carried.insert((component, top));
            let carrying = tree.chain(top as usize).take_while(|_| is_new).map(|j| j as u32);
            jobs.extend(carrying.chain(below.iter().map(|&j| u32::from(j))).map(|joint| Job { joint, component }));
            if jobs.len() > 4 * topology.faces.len() {
                jobs.sort_unstable();
                jobs.dedup();
            }
        }
        jobs.sort_unstable();
        jobs.dedup();
        let mut formed = Portions::default();
        let has_forms = mode == Mode::Linear && !has_shapes;
        let forms = if has_forms { VolumeForms::new(anatomy, &jobs, &mut formed) } else { None };
        let stages = Stages::new(anatomy, &jobs);
        let mut staged = stages.portions(anatomy);
        for portions in [&mut staged, &mut formed] {
            for (&component, &top) in portions.components.iter().zip(&portions.tops) {
                portions.jobs_above.push_row(tree.chain(top as usize).filter_map(|j| find_job(&jobs, j, component)));
            }
        }
        Self { jobs, stages, staged, forms, formed }
    }

    /// Faces that are carried whole, by stages or in closed form.
    pub fn portions(&self, by_stages: bool) -> &Portions {
        if by_stages { &self.staged } else { &self.formed }
    }

    /// What every joint did to every component by carrying portions whole.
    pub fn carry(&self, motions: &Motions, moments: &[Moment], changes: &mut [Change]) {
        for (change, (job, moment)) in changes.iter_mut().zip(self.jobs.iter().zip(moments)) {
            let joint = job.joint as usize;
            *change = Change::default();
            if motions.is_still_in(job.component, joint) {
                continue;
            }
            let volume = |motion: usize| moved_volume(motions.palette.alone(motion), *moment);
            let before = volume(motions.above(job.component, joint));
            let stretched = motions.intent(job.component, joint).map_or(before, volume);
            *change = Change { intent: stretched - before, loss: stretched - volume(joint) };
        }
    }

    /// What was done to whole shells before their joints turned against their bases, added to the first of these.
    pub fn carry_shells(&self, motions: &Motions, by_stages: bool, of_portion: &[Moment], changes: &mut [Change]) {
        for base in motions.active_bases() {
            let portions =
                of_portion.iter().zip(&self.portions(by_stages).components).filter(|(_, component)| **component == base.component);
            let moment = portions.fold((0.0, DVec3::ZERO), |sum: Moment, (moment, _)| (sum.0 + moment.0, sum.1 + moment.1));
            let volume = |motion: usize| moved_volume(motions.palette.alone(motion), moment);
            let [whole, carrier, unturned] = std::array::from_fn(|place| volume(base.first_motion + place));
            if let Some(job) = find_job(&self.jobs, base.members[0].0, base.component) {
                let before = volume(base.top);
                let intent = if motions.keeps_intent { unturned - before + whole - carrier } else { 0.0 };
                changes[job as usize].join(&Change { intent, loss: before + intent - whole });
            }
        }
    }

    pub fn memory_bytes(&self) -> usize {
        let forms = self.forms.as_ref().map_or(0, VolumeForms::memory_bytes);
        size_of_val(&*self.jobs) + self.staged.memory_bytes() + self.stages.memory_bytes() + self.formed.memory_bytes() + forms
    }
}
