//! Volume that added offsets take goes back where it was lost: to the joint whose vicinity that is, the rest by the skin itself
//! [MATH §9].

use super::places::Places;
use super::{Bound, Pose, in_single_precision};
use crate::binding::Binding;
use crate::cores::following::Room;
use crate::fields::profile::{BELL_END, BELL_WIDTH};
use crate::fields::supports::{Support, Supports};
use crate::numeric::block_rows::{LANES, PATCH_POINTS};
use crate::numeric::lanes;
use crate::parallel::split::{Ragged, for_each_piece};
use crate::skinning::joint_tree::JointTree;

/// A joint shares what is lost around it with the skin itself evenly where this is left of its field.
const SHARED: f64 = 0.1;
/// Largest displacement by the skin itself, in balls under it.
const DISPLACEMENT_MAX: f64 = 0.5;
/// Flesh of the bone above a fleshed joint counts as fleshed up to the first of these, in joint lengths, and less up to the other.
const FLESHED_NEAR: f64 = 0.75;
const FLESHED_FAR: f64 = 1.5;

/// What the skin gives back without any joint, and room to find it.
#[derive(Debug, Clone, Default)]
pub(super) struct Local {
    pub is_used: bool,
    /// Per slot, in units of the mean area: a length. Positive is to be given.
    pub volumes: Vec<f32>,
    /// Per slot, largest displacement.
    pub bounds: Vec<f32>,
    room: Room,
    /// Per cell.
    shown: Vec<f64>,
    skinned: Vec<f64>,
    lengthening: Vec<f32>,
    densities: Vec<f64>,
    /// For each support of each patch.
    of_joints: Vec<f64>,
}

impl Local {
    pub fn memory_bytes(&self) -> usize {
        self.room.memory_bytes() + size_of_val(&*self.volumes) + size_of_val(&*self.bounds) + size_of_val(&*self.of_joints)
    }

    /// Finds where `offsets` that are not of `rounding` alone took volume: `missing` per component. True where there are any.
    pub fn find(
        &mut self,
        bound: Bound,
        pose: &Pose,
        places: &Places,
        (offsets, rounding): (&[[f32; 3]], f64),
        missing: impl FnOnce() -> Vec<f64>,
    ) -> bool {
        let Bound { binding, supports, settings } = bound;
        let is_moved = |offset: &[f32; 3]| offset.iter().any(|x| f64::from(x.abs()) > rounding);
        self.is_used = offsets.iter().any(is_moved);
        if !self.is_used {
            return false;
        }
        let (core, patches) = (binding.core(), &binding.patches);
        let Local { volumes, bounds, room, shown, skinned, lengthening, densities, of_joints, .. } = self;
        let bare = |slot: usize| {
            let [x, y, z] = offsets[slot].map(f64::from);
            lanes::sub(places.at(slot), [x, y, z, 0.0])
        };
        core.begin(patches, |slot| is_moved(&offsets[slot]), room);
        core.volumes(patches, bare, room, skinned, lengthening);
        core.volumes(patches, |slot| places.at(slot), room, shown, lengthening);
        core.densities(room, skinned, shown, missing(), densities);
        volumes.resize(patches.slot_count(), 0.0);
        bounds.resize(patches.slot_count(), 0.0);
        of_joints.resize(supports.jobs_of_patch.values().len(), 0.0);
        let flesh = Flesh::new(&binding.motions.tree, pose.is_fleshed);
        let claim = |job: usize| {
            let joint = binding.plan.jobs[job].joint as usize;
            let bone = binding.motions.tree.bones[joint] as usize;
            let strength = pose.strengths.map_or(settings[joint].strength, |strengths| strengths[bone]);
            if flesh.is_fleshed(joint) { 0.0 } else { strength.min(1.0) }
        };
        let (room, densities, lengthening) = (&*room, &*densities, &*lengthening);
        for_each_piece(
            patches.list.len(),
            (
                Ragged::new(volumes, &patches.slot_offsets),
                Ragged::new(bounds, &patches.slot_offsets),
                Ragged::new(of_joints, supports.jobs_of_patch.offsets()),
            ),
            &|index, (volumes, bounds, of_joints)| {
                volumes.values.fill(0.0);
                if !room.concerns(index) {
                    of_joints.values.fill(0.0);
                    return;
                }
                let (patch, cells) = (&patches.list[index], core.cells_of_patch.row(index));
                let (mut lost, mut weights) = ([0.0; PATCH_POINTS], [0.0; PATCH_POINTS]);
                for (place, lost) in lost.iter_mut().enumerate().take(patch.owned) {
                    let slot = patch.start + place;
                    let (mut density, mut longer) = (0.0, 0.0);
                    for share in core.shares_of(patch, place) {
                        let cell = cells[usize::from(share.cell)] as usize;
                        density += f64::from(share.part) * densities[cell];
                        longer += share.part * lengthening[cell];
                    }
                    *lost = density * core.areas[slot] * (1.0 - flesh.part(binding, supports, slot));
                    bounds.values[place] = DISPLACEMENT_MAX as f32 * core.radii[slot] * longer;
                }
                let visit = |support: &Support, visit: &mut dyn FnMut(usize, f64)| {
                    let joint = binding.plan.jobs[support.job].joint as usize;
                    let (claim, head) = (claim(support.job), lanes::from(binding.motions.tree.heads[joint]));
                    let narrowness = 1.0 / (BELL_WIDTH * BELL_WIDTH * BELL_END * supports.lengths[joint].powi(2));
                    for (number, block) in support.present.numbered(support.weights).filter(|_| claim > 0.0) {
                        for (lane, weight) in block.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                            let (place, slot) = (number * LANES + lane, patch.start + number * LANES + lane);
                            let away = lanes::sub(core.rest(slot), head);
                            let bell = (1.0 - lanes::sum(lanes::mul(away, away)) * narrowness).max(0.0).powi(8);
                            visit(place, claim * f64::from(weight / binding.inverse_areas[slot]) * bell);
                        }
                    }
                };
                for support in supports.of_patch(index) {
                    visit(&support, &mut |place, weight| weights[place] += weight);
                }
                for (support, sum) in supports.of_patch(index).zip(of_joints.values) {
                    *sum = 0.0;
                    visit(&support, &mut |place, weight| *sum += lost[place] * weight / (weights[place] + SHARED));
                }
                for place in 0..patch.owned {
                    let left = lost[place] * SHARED / (weights[place] + SHARED);
                    volumes.values[place] = in_single_precision(left / binding.area_unit) as f32;
                }
            },
        );
        true
    }

    /// What each job is to give back of it, for each support of each patch.
    pub fn of_joints(&self) -> &[f64] {
        &self.of_joints
    }
}

/// Flesh that the deformer moves which added the offsets: what skinning would have lost there is no loss of anybody.
struct Flesh {
    /// Per joint and for the world; empty where nothing is fleshed.
    is_fleshed: Vec<bool>,
    /// Fleshed joints right below each.
    below: Vec<Vec<usize>>,
}

impl Flesh {
    fn new(tree: &JointTree, bones: Option<&[bool]>) -> Self {
        let is_fleshed: Vec<bool> = tree.bones.iter().map(|&bone| bones.is_some_and(|bones| bones[bone as usize])).chain([false]).collect();
        if !is_fleshed.contains(&true) {
            return Self { is_fleshed: Vec::new(), below: Vec::new() };
        }
        let mut below = vec![Vec::new(); is_fleshed.len()];
        for joint in (0..tree.len()).filter(|&joint| is_fleshed[joint]) {
            below[usize::from(tree.parents[joint])].push(joint);
        }
        Self { is_fleshed, below }
    }

    fn is_fleshed(&self, joint: usize) -> bool {
        self.is_fleshed.get(joint).copied().unwrap_or(false)
    }

    /// Of a point, in 0..1.
    fn part(&self, binding: &Binding, supports: &Supports, slot: usize) -> f64 {
        if self.is_fleshed.is_empty() {
            return 0.0;
        }
        let of_joint = |joint: usize| {
            let near = |&below: &usize| {
                let distance = binding.rest_distance(slot, below) / supports.lengths[below];
                let far = ((distance - FLESHED_NEAR) / (FLESHED_FAR - FLESHED_NEAR)).clamp(0.0, 1.0);
                1.0 - far * far * (3.0 - 2.0 * far)
            };
            if self.is_fleshed[joint] { 1.0 } else { self.below[joint].iter().map(near).fold(0.0, f64::max) }
        };
        let sites = &binding.sites;
        let of_site = |site: usize| {
            let (joints, weights) = sites.influences.of(site);
            joints.iter().zip(weights).map(|(&joint, weight)| weight * of_joint(usize::from(joint))).sum::<f64>() * sites.share(site)
        };
        sites.of_slot(slot).map(of_site).sum::<f64>().clamp(0.0, 1.0)
    }
}

impl Binding {
    /// From a joint's head to the point in a slot, at rest, armature space.
    fn rest_distance(&self, slot: usize, joint: usize) -> f64 {
        self.rest_in_armature(slot).distance(self.motions.tree.heads[joint])
    }
}
