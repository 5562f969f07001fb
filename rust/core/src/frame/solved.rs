//! A solved frame, as others read it: places and displacements of vertices, figures.

use glam::DVec3;

use super::buffers::{Correction, Losses, Posed, Skinned};
use super::{Bound, Problem, widened};
use crate::binding::Binding;
use crate::flesh::shape::Shape;
use crate::numeric::lanes::{self, add_scaled};
use crate::report::Report;

/// A frame as it was solved, to be read.
#[derive(Clone, Copy)]
pub(crate) struct Solved<'a> {
    pub(super) binding: &'a Binding,
    pub(super) posed: &'a Posed,
    pub(super) flesh: &'a Shape,
    pub(super) skinned: &'a Skinned,
    pub(super) correction: &'a Correction,
}

impl Solved<'_> {
    /// A place of armature space in object space.
    pub(crate) fn in_object(&self, place: DVec3) -> DVec3 {
        self.posed.object.transform_point3(place)
    }

    /// What the law of flesh adds to a vertex, armature space.
    pub(crate) fn flesh_offset(&self, slot: u32) -> DVec3 {
        let has_slot = (slot as usize) < self.correction.moves.len();
        if has_slot { lanes::to(widened(self.flesh.offset(slot as usize))) } else { DVec3::ZERO }
    }

    /// Skinned position of a vertex in armature space, with what is added to it but for the law of flesh.
    pub(crate) fn skinned_vertex(&self, vertex: usize) -> DVec3 {
        let Self { binding, posed, skinned, .. } = *self;
        if let Some(place) = posed.added.place_of_vertex(vertex) {
            return lanes::to(place) + posed.motions.palette.origin;
        }
        let slot = binding.slot_of_vertex[vertex] as usize;
        // A point whose vertices are skinned alike is where the frame has left it.
        if slot < self.correction.moves.len() && binding.sites.of_slot(slot).len() == 1 && !posed.body.is_split() {
            let place = lanes::to(skinned.places.at(slot)) - self.flesh_offset(slot as u32) + posed.motions.palette.origin;
            let is_moved = !posed.added.is_empty();
            return if is_moved { place + (posed.added.of_vertex(vertex) - lanes::to(posed.added.of_slot(binding, slot))) } else { place };
        }
        let site = binding.sites.site_of_vertex[vertex] as usize;
        let rest = posed.body.rest_of_vertex(binding, vertex);
        let place = lanes::to(posed.motions.palette.skin(&binding.sites.influences, site, rest));
        place + posed.added.of_vertex(vertex) + posed.motions.palette.origin
    }

    /// Corrected − skinned of a vertex in double precision, armature space; the law of flesh is part of what is skinned.
    pub(crate) fn displacement(&self, slot: u32, component: u32) -> DVec3 {
        self.correction.displacement(slot, component)
    }
}

impl Correction {
    /// Corrected − skinned of a vertex in double precision, armature space.
    pub(super) fn displacement(&self, slot: u32, component: u32) -> DVec3 {
        self.moves.get(slot as usize).map_or(DVec3::ZERO, |point| {
            let step = self.components[component as usize].step;
            if step.is_nan() { DVec3::ZERO } else { lanes::to(add_scaled(widened(point.by), widened(point.residual), step)) }
        })
    }

    /// Figures of the frame, in object space.
    pub(super) fn fill_report(&self, problem: Problem, posed: &Posed, losses: &Losses, report: &mut Report) {
        let Problem { bound: Bound { binding, .. }, mask, skinned, targets, .. } = problem;
        let object_from_armature = posed.object.matrix3.determinant();
        for (index, (target, state)) in targets.components.iter().zip(&self.components).enumerate() {
            report.skinned_volumes[index] = target.bare * object_from_armature;
            report.flesh_volumes[index] = target.skinned * object_from_armature;
            report.target_volumes[index] = target.target * object_from_armature;
            report.corrected_volumes[index] = state.corrected * object_from_armature;
            report.component_is_pinned[index] = mask.is_some_and(|mask| mask.is_pinned[index]);
        }
        report.joint_losses.fill(0.0);
        report.joint_regained.fill(0.0);
        report.joint_displacements.fill(0.0);
        report.joint_is_capped.fill(false);
        for (index, job) in binding.plan.jobs.iter().enumerate() {
            let (joint, state) = (job.joint as usize, &self.jobs[index]);
            // Inside-out components lose negative volume: figures are those of their flesh.
            let sign = targets.components[job.component as usize].rest.signum() * object_from_armature.abs();
            report.joint_losses[joint] += losses.changes[index].loss * sign;
            report.joint_regained[joint] += state.regained * sign;
            report.joint_displacements[joint] = report.joint_displacements[joint].max(state.displacement);
            report.joint_is_capped[joint] |= state.is_capped;
        }
        let gap = skinned.patches.iter().map(|p| p.gap_squared).fold(0.0, f64::max).sqrt();
        report.seam_gap = gap * object_from_armature.abs().cbrt();
    }
}
