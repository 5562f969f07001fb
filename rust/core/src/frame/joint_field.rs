//! The field of one joint in one pose, for those who draw it.

use glam::DVec3;

use super::buffers::Posed;
use super::{Bound, Problem, Workspace, flesh};
use crate::fields::field::{FieldFrame, axes_of_bend, axes_of_no_bend};
use crate::fields::profile_weights;
use crate::fields::supports::Support;

/// How one joint's field lies in object space, and how much of it each vertex has [MATH §3–4].
#[derive(Debug, Clone, PartialEq)]
pub struct JointField {
    /// The joint.
    pub origin: DVec3,
    /// e0 along the parent, e1 axis of the bend, e2 inside of the bend. The place x of the profiles lies at
    /// origin + length · Σ xᵢ eᵢ: unit vectors where the object is scaled evenly.
    pub axes: [DVec3; 3],
    /// w: part of the volume that goes along the axes; 0 for a straight pose, which leaves e1 and e2 open.
    pub axes_share: f64,
    /// Unit of the profiles.
    pub length: f64,
    /// Per vertex, γ before it is divided by the vertex's area: w of the profiles and 1 − w of the bell, of its vicinity,
    /// times what the mask leaves.
    pub gamma: Vec<f32>,
}

impl Workspace {
    /// The field of a joint, after `skin`.
    pub(crate) fn joint_field(&self, bound: Bound, joint: usize) -> JointField {
        self.problem(bound).joint_field(&self.posed, joint)
    }
}

impl Problem<'_> {
    fn joint_field(self, posed: &Posed, joint: usize) -> JointField {
        let Bound { binding, supports, settings } = self.bound;
        let mut frame = FieldFrame::new(&posed.motions, joint, &settings[joint], supports, 0.0);
        (frame.axes, frame.frame_part) = match axes_of_bend(&posed.motions, joint) {
            (_, 0.0) => (axes_of_no_bend(&posed.motions, joint), 0.0),
            bent => bent,
        };
        flesh::halve(self.flesh, binding, posed, joint, &mut frame);
        let (axes, axes_share) = (frame.axes, frame.frame_part);
        let growth = posed.object.matrix3.determinant().abs().cbrt();
        let of_slot = self.gamma_of_slots(joint);
        JointField {
            origin: posed.object.transform_point3(frame.origin + posed.motions.palette.origin),
            axes: axes.map(|e| posed.object.matrix3 * e / growth),
            axes_share,
            length: growth / frame.inverse_length,
            gamma: binding.slot_of_vertex.iter().map(|&slot| of_slot.get(slot as usize).copied().unwrap_or(0.0)).collect(),
        }
    }

    fn gamma_of_slots(self, joint: usize) -> Vec<f32> {
        let Bound { binding, supports, settings } = self.bound;
        let patches = &binding.patches;
        let mut gamma = vec![0.0; patches.slot_count()];
        for (index, patch) in patches.list.iter().enumerate() {
            let slots = patch.start..patches.slot_offsets[index + 1] as usize;
            let is_mine = |support: &Support| binding.plan.jobs[support.job].joint as usize == joint;
            let Some(support) = supports.of_patch(index).find(is_mine) else { continue };
            let frame = &self.targets.jobs[support.job].frame;
            let places = self.skinned.places.near.each_ref().map(|row| &row[slots.clone()]);
            let areas = &binding.inverse_areas[slots.clone()];
            let mask = self.mask.map(|mask| &mask.of_slot[slots.clone()]);
            let profiles = settings[joint].profiles.as_ref().filter(|_| frame.has_axes());
            let gamma = &mut gamma[slots];
            let drawn_part = if profiles.is_some() { frame.frame_part as f32 } else { 0.0 };
            for (place, bell, drawn) in profile_weights::of_points(support, places, frame, profiles) {
                let height = drawn * drawn_part + bell * (1.0 - drawn_part);
                gamma[place] = height / areas[place] * mask.map_or(1.0, |mask| mask[place]);
            }
        }
        gamma
    }
}
