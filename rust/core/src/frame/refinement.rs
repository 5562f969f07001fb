//! Where, and how finely, a mesh should have more points: where joints give volume back [RHC09 §4.3].

use super::buffers::Posed;
use super::{Bound, Problem, Workspace};
use crate::binding::Binding;
use crate::fields::joint::{Joint, Profiles};
use crate::fields::profile;
use crate::fields::profile_weights;

/// From this part of its vicinity's volume on a loss counts in full, below it in proportion.
const LOSS_IN_FULL: f64 = 0.02;
/// What straight edges may miss of a profile, as a part of its height.
const EDGE_ERROR: f64 = 0.05;

/// Per vertex, of many poses.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinementNeed {
    /// Largest γ of all joints, with profiles of height 1 whose folds are filled in, times how far their loss counts: 0..1.
    pub gamma: Vec<f32>,
    /// Length of edges that still show what the joints' profiles draw there, object space; infinite where they draw nothing.
    pub edge_lengths: Vec<f32>,
}

/// What is the same in all poses: of each joint, its profiles with folds filled in, and how fine they are.
pub(crate) struct Details(Vec<Detail>);

struct Detail {
    envelope: Option<Profiles>,
    /// Edges per joint length, squared: of the bell, the profiles, and what they turn into.
    bell: f64,
    plain: f64,
    folded: f64,
}

/// The largest found so far, per slot.
pub(crate) struct Needs {
    gamma: Vec<f32>,
    /// Edges per length of object space, squared, as `gamma` asks for.
    fineness: Vec<f32>,
}

impl Details {
    pub fn new(settings: &[Joint]) -> Self {
        let fineness = |length: f64| (length * length).recip();
        let bell = fineness(profile::bell().chord_length(EDGE_ERROR));
        let finest =
            |axes: &[crate::fields::profile::Profile; 3]| axes.iter().map(|p| fineness(p.chord_length(EDGE_ERROR))).fold(0.0, f64::max);
        let detail = |joint: &Joint| {
            let Some(profiles) = &joint.profiles else { return Detail { envelope: None, bell, plain: bell, folded: bell } };
            let plain = finest(&profiles.axes);
            let folded = profiles.folded.as_ref().map_or(plain, |(folded, _)| finest(folded));
            Detail { envelope: Some(profiles.envelope()), bell, plain, folded }
        };
        Self(settings.iter().map(detail).collect())
    }
}

impl Needs {
    pub fn new(binding: &Binding) -> Self {
        let slots = binding.patches.slot_count();
        Self { gamma: vec![0.0; slots], fineness: vec![0.0; slots] }
    }

    /// Per vertex.
    pub fn of_vertices(&self, binding: &Binding) -> RefinementNeed {
        let of = |slots: &[f32]| -> Vec<f32> {
            binding.slot_of_vertex.iter().map(|&slot| slots.get(slot as usize).copied().unwrap_or(0.0)).collect()
        };
        let edge_lengths = of(&self.fineness).into_iter().map(|fineness| fineness.sqrt().recip()).collect();
        RefinementNeed { gamma: of(&self.gamma), edge_lengths }
    }

    /// Joins what was found in other poses.
    pub fn join(&mut self, other: &Self) {
        for (rows, others) in [(&mut self.gamma, &other.gamma), (&mut self.fineness, &other.fineness)] {
            for (value, &found) in rows.iter_mut().zip(others) {
                *value = value.max(found);
            }
        }
    }
}

impl Workspace {
    /// Adds the pose to `needs`, after `skin`.
    pub(crate) fn add_needs(&self, bound: Bound, details: &Details, needs: &mut Needs) {
        self.problem(bound).add_needs(&self.posed, details, needs);
    }
}

impl Problem<'_> {
    fn add_needs(self, posed: &Posed, details: &Details, needs: &mut Needs) {
        let Bound { binding, supports, .. } = self.bound;
        let patches = &binding.patches;
        let object_from_armature = posed.object.matrix3.determinant().abs().cbrt();
        for (index, patch) in patches.list.iter().enumerate() {
            let slots = patch.start..patches.slot_offsets[index + 1] as usize;
            let places = self.skinned.places.near.each_ref().map(|row| &row[slots.clone()]);
            let areas = &binding.inverse_areas[slots.clone()];
            let mask = self.mask.map(|mask| &mask.of_slot[slots.clone()]);
            for support in supports.of_patch(index) {
                let state = &self.targets.jobs[support.job];
                if !state.frame.is_active {
                    continue;
                }
                let joint = binding.plan.jobs[support.job].joint as usize;
                let (detail, frame) = (&details.0[joint], &state.frame);
                let counts = (frame.relative(state.volume) / LOSS_IN_FULL).min(1.0) as f32;
                let per_length = (object_from_armature * supports.lengths[joint]).powi(-2);
                let drawn_fineness = ((detail.plain + (detail.folded - detail.plain) * frame.folded()) * per_length) as f32;
                let bell_fineness = (detail.bell * per_length) as f32;
                let envelope = detail.envelope.as_ref().filter(|_| frame.has_axes());
                let drawn_part = if envelope.is_some() { frame.frame_part as f32 } else { 0.0 };
                for (place, bell, drawn) in profile_weights::of_points(support, places, frame, envelope) {
                    let share = counts * mask.map_or(1.0, |mask| mask[place]) / areas[place];
                    let (drawn, round) = (drawn * drawn_part * share, bell * (1.0 - drawn_part) * share);
                    let slot = slots.start + place;
                    needs.gamma[slot] = needs.gamma[slot].max(drawn + round);
                    needs.fineness[slot] = needs.fineness[slot].max(drawn * drawn_fineness + round * bell_fineness);
                }
            }
        }
    }
}
