//! One frame: pose, skin, losses, fields, residual. Buffers are made once and nothing is remembered; only what a frame brings
//! along and the repair of folds allocate what grows with the mesh.

mod added;
mod body;
mod carried;
mod joint_field;
mod linear_step;
mod local;
mod mask;
mod offsets;
mod pass;
mod refinement;
mod repair;
mod residual;
mod restore;
mod scratch;
mod sequential;
mod simultaneous;
mod skin;
mod targets;

use std::sync::Arc;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f64x4};
use glam::{DAffine3, DMat4, DVec3};

use self::added::Added;
use self::body::Body;
pub use self::joint_field::JointField;
use self::local::Local;
pub(crate) use self::mask::Mask;
pub use self::refinement::RefinementNeed;
pub(crate) use self::refinement::{Details, Needs};
use crate::binding::Binding;
use crate::error::{Error, LARGEST, Result};
use crate::fields::field::{Capacity, Field, FieldFrame};
use crate::fields::joint::{FACTOR_MAX, Joint, check_strengths};
use crate::fields::patch_sums::Move;
use crate::fields::supports::Supports;
use crate::numeric::block_rows::{Block, LANES};
use crate::numeric::lanes::{self, Four, V4, add_scaled};
use crate::parallel::split::Ragged;
use crate::report::Report;
use crate::skinning::blend::{check_object, check_pose};
use crate::skinning::motions::Motions;
use crate::surface::volume::VolumeCubic;
use crate::volume_losses::closed_form::{FormBuffers, VolumeForms};
use crate::volume_losses::job::{Change, Moment};
use crate::volume_losses::staged::ROWS;

/// One frame's input.
#[derive(Debug, Clone, Copy)]
pub struct Pose<'a> {
    /// Per bone pose · rest⁻¹, armature space.
    pub matrices: &'a [DMat4],
    /// Armature space to object space.
    pub object_from_armature: DMat4,
    /// Value of each shape key; missing ones count as 0.
    pub shape_values: &'a [f64],
    /// Per vertex, object space: the body of this frame, in place of the bound rest positions with shape keys mixed in. Losses and
    /// volumes at rest are its own; topology, weights and how far joints reach stay as bound.
    pub rest_positions: Option<&'a [[f32; 3]]>,
    /// Factor on the target volume.
    pub target_scale: f64,
    /// Strength of each bone's joint, in place of its setting.
    pub strengths: Option<&'a [f64]>,
    /// Per vertex, object space: what another deformer adds to the skin before its volume is looked at.
    pub added_offsets: Option<&'a [[f32; 3]]>,
    /// Per bone, whether that deformer moves its flesh: what skinning loses there is not missing.
    pub is_fleshed: Option<&'a [bool]>,
    /// Whether folds of the correction are repaired.
    pub repair_folds: bool,
}

impl<'a> Pose<'a> {
    /// A pose with armature and object in one space, no shape keys, and the rest volume as target.
    pub fn new(matrices: &'a [DMat4]) -> Self {
        Self {
            matrices,
            object_from_armature: DMat4::IDENTITY,
            shape_values: &[],
            rest_positions: None,
            target_scale: 1.0,
            strengths: None,
            added_offsets: None,
            is_fleshed: None,
            repair_folds: false,
        }
    }
}

/// Three coordinates of all slots.
type Coordinates = [Vec<f32>; 3];

/// Skinned positions of all slots about the palette's origin, each the sum of two: what fields need, and the rest of its
/// digits, to about 2⁻⁴⁹.
#[derive(Debug, Clone)]
struct Places {
    near: Coordinates,
    rest: Coordinates,
}

impl Places {
    #[inline(always)]
    fn at(&self, slot: usize) -> V4 {
        let [x, y, z] = std::array::from_fn(|axis| f64::from(self.near[axis][slot]) + f64::from(self.rest[axis][slot]));
        [x, y, z, 0.0]
    }

    /// The same of eight slots side by side, the first of them a multiple of eight.
    #[inline(always)]
    fn eight<S: Simd>(&self, simd: S, number: usize) -> [Four<S>; 2] {
        let Self { near, rest } = self;
        let (x, y, z) =
            (sums(simd, &near[0], &rest[0], number), sums(simd, &near[1], &rest[1], number), sums(simd, &near[2], &rest[2], number));
        [Four::of_lanes([x.0, y.0, z.0]), Four::of_lanes([x.1, y.1, z.1])]
    }
}

#[inline(always)]
fn sums<S: Simd>(simd: S, near: &[f32], rest: &[f32], number: usize) -> (f64x4<S>, f64x4<S>) {
    let of = |row: &[f32]| f32x8::simd_from(simd, row.as_chunks::<LANES>().0[number]).widen();
    let (near, rest) = (of(near), of(rest));
    (near.0 + rest.0, near.1 + rest.1)
}

/// Buffers of one frame.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(crate) motions: Motions,
    pub(crate) object: DAffine3,
    channels: Vec<DAffine3>,
    body: Body,
    portion_moments: Vec<Moment>,
    job_moments: Vec<Moment>,
    changes: Vec<Change>,
    forms: Option<FormBuffers>,
    stage_changes: Vec<Change>,
    giant_positions: Vec<V4>,
    giant_room: Vec<f64>,
    skinned: Places,
    added: Added,
    local: Local,
    /// In units of the mean area.
    gradient: Coordinates,
    /// Unit vectors; empty unless fields are even.
    carried: Coordinates,
    carries_normals: bool,
    /// Per slot.
    moves: Vec<Move>,
    /// Gradients as sweeps leave them, per local point of patches and corner of giants.
    sources: Vec<V4>,
    /// Weight times profile, for each weight of `Supports`; empty while no joint has profiles.
    profiled: Vec<Block<f32>>,
    pub(crate) mask: Option<Arc<Mask>>,
    capacities: Vec<Capacity>,
    patches: Vec<PatchSums>,
    giant_volumes: Vec<f64>,
    jobs: Vec<JobState>,
    components: Vec<ComponentState>,
    pub(crate) report: Report,
}

/// What the sweeps find in one patch.
#[derive(Debug, Clone, Copy, Default)]
struct PatchSums {
    volume: f64,
    cubic: VolumeCubic,
    wide_capacity: f64,
    gap_squared: f64,
}

/// One joint in one component, in one frame.
#[derive(Debug, Clone, Copy, Default)]
struct JobState {
    /// To be given back.
    volume: f64,
    frame: FieldFrame,
    capacity: Capacity,
    field: Field,
    /// Given back by all fields of the job, and the bound on what they move.
    regained: f64,
    displacement: f64,
    is_capped: bool,
}

/// One component in one frame, armature space.
#[derive(Debug, Clone, Copy, Default)]
struct ComponentState {
    rest: f64,
    skinned: f64,
    target: f64,
    corrected: f64,
    cubic: VolumeCubic,
    /// Σ |volume to give back| over joints, and the floor under it.
    spread: f64,
    floor: f64,
    /// Volume for the field of the whole shell, its capacity, its coefficient, and that of the residual's field.
    wide: f64,
    wide_capacity: f64,
    wide_field: f64,
    wide_residual: f64,
    /// Whether the residual is left to the whole shell.
    is_wide_only: bool,
    /// Whether fields are given up for one step along which the volume is linear.
    is_linear_only: bool,
    /// Step along the residual's field; NaN where nothing may move.
    step: f64,
}

impl Workspace {
    pub(crate) fn new(binding: &Binding, supports: &Supports, settings: &[Joint]) -> Self {
        let slots = binding.patches.slot_count();
        let jobs = binding.plan.jobs.len();
        let coordinates = || std::array::from_fn(|_| vec![0.0; slots]);
        let forms = binding.plan.forms.as_ref().map(VolumeForms::buffers);
        let is_staged = forms.is_none();
        let stage_changes = vec![Change::default(); if is_staged { binding.plan.stages.change_count() } else { 0 }];
        let giants = &binding.patches.giants;
        let giant_points = giants.iter().map(|g| g.corners.len().next_multiple_of(LANES)).max().unwrap_or(0);
        let has_profiles = settings.iter().any(|joint| joint.profiles.is_some());
        Self {
            motions: binding.motions.clone(),
            object: DAffine3::IDENTITY,
            channels: vec![DAffine3::IDENTITY; binding.bone_count],
            body: Body::default(),
            portion_moments: Vec::new(),
            job_moments: vec![(0.0, DVec3::ZERO); jobs],
            changes: vec![Change::default(); jobs],
            forms,
            stage_changes,
            giant_positions: vec![lanes::ZERO; giant_points],
            giant_room: vec![0.0; ROWS * giant_points],
            added: Added::default(),
            local: Local::default(),
            skinned: Places { near: coordinates(), rest: coordinates() },
            gradient: coordinates(),
            carried: if supports.is_even { coordinates() } else { Coordinates::default() },
            carries_normals: false,
            moves: vec![Move::default(); slots],
            sources: vec![lanes::ZERO; binding.patches.source_count()],
            profiled: vec![[0.0; LANES]; if has_profiles { supports.block_count() } else { 0 }],
            mask: None,
            capacities: vec![Capacity::default(); supports.jobs_of_patch.values().len()],
            patches: vec![PatchSums::default(); binding.patches.list.len()],
            giant_volumes: vec![0.0; giants.len()],
            jobs: vec![JobState::default(); jobs],
            components: vec![ComponentState::default(); binding.components.len()],
            report: Report::new(binding.components.len(), binding.motions.tree.len()),
        }
    }

    /// Heap memory that grows with the mesh.
    pub fn memory_bytes(&self) -> usize {
        let coordinates = [&self.skinned.near, &self.skinned.rest, &self.gradient, &self.carried];
        let vectors = [&self.giant_positions, &self.sources];
        coordinates.iter().flat_map(|c| c.iter()).map(|c| size_of_val(&**c)).sum::<usize>()
            + vectors.iter().map(|v| size_of_val(&***v)).sum::<usize>()
            + self.body.memory_bytes()
            + self.added.memory_bytes()
            + self.local.memory_bytes()
            + size_of_val(&*self.moves)
            + size_of_val(&*self.profiled)
            + size_of_val(&*self.capacities)
            + size_of_val(&*self.patches)
            + size_of_val(&*self.stage_changes)
    }

    /// Checks a pose and sets the frame to it.
    pub(crate) fn set_pose(&mut self, binding: &Binding, pose: &Pose, keep_bone_scale: bool) -> Result<()> {
        if let Some(strengths) = pose.strengths {
            if strengths.len() != binding.bone_count {
                return Err(Error::Length { what: "strengths", found: strengths.len(), needed: binding.bone_count });
            }
            check_strengths("strengths", strengths)?;
        }
        if let Some(is_fleshed) = pose.is_fleshed.filter(|bones| bones.len() != binding.bone_count) {
            return Err(Error::Length { what: "fleshed", found: is_fleshed.len(), needed: binding.bone_count });
        }
        if !(pose.target_scale > 0.0 && pose.target_scale <= FACTOR_MAX) {
            return Err(Error::Value { what: "target_scale", found: pose.target_scale, needed: "a number above 0, up to 1e9" });
        }
        let (rest_centre, radius) = self.set_body(binding, pose)?;
        check_pose(pose.matrices, &mut self.channels)?;
        self.object = check_object(&pose.object_from_armature)?;
        let armature_from_rest = self.object.inverse() * DAffine3::from_translation(rest_centre);
        // Near the mean of the skinned points: sums about it keep their digits far from the world's origin.
        let mut origin = DVec3::ZERO;
        let mut total = 0.0;
        for (joint, &(mass, centre)) in binding.masses.iter().enumerate() {
            let bone = binding.motions.tree.bones.get(joint);
            let channel = bone.map_or(DAffine3::IDENTITY, |&bone| self.channels[bone as usize]);
            let armature_from_rest = channel * armature_from_rest;
            if mass > 0.0 {
                let reach = reach(&armature_from_rest, radius).max(reach(&(self.object * armature_from_rest), radius));
                // What is no number is too far too.
                if !(0.0..=LARGEST).contains(&reach) {
                    return Err(Error::TooFar { bone: bone.map_or(0, |&bone| bone as usize), reach });
                }
            }
            origin += armature_from_rest.transform_point3(centre) * mass;
            total += mass;
        }
        if total > 0.0 {
            origin /= total;
        }
        origin += self.set_added(binding, pose.added_offsets)?;
        self.motions.set(&self.channels, armature_from_rest, origin, binding.size, keep_bone_scale);
        Ok(())
    }

    /// Corrected − skinned of a vertex in double precision, armature space.
    pub(crate) fn displacement(&self, slot: u32, component: u32) -> DVec3 {
        self.moves.get(slot as usize).map_or(DVec3::ZERO, |point| {
            let step = self.components[component as usize].step;
            if step.is_nan() { DVec3::ZERO } else { lanes::to(add_scaled(widened(point.by), widened(point.residual), step)) }
        })
    }

    /// Skinned position of a vertex in armature space, with what is added to it.
    pub(crate) fn skinned_vertex(&self, binding: &Binding, vertex: usize) -> DVec3 {
        let slot = binding.slot_of_vertex[vertex] as usize;
        // A point whose vertices are skinned alike is where the frame has left it.
        if slot < self.moves.len() && binding.sites.of_slot(slot).len() == 1 && !self.body.is_split() {
            let skinned = lanes::to(self.skinned.at(slot)) + self.motions.palette.origin;
            let is_moved = !self.added.is_empty();
            return if is_moved {
                skinned + (self.added.of_vertex(vertex) - lanes::to(self.added.of_slot(binding, slot)))
            } else {
                skinned
            };
        }
        let site = binding.sites.site_of_vertex[vertex] as usize;
        let rest = self.body.rest_of_vertex(binding, vertex);
        let skinned = lanes::to(self.motions.palette.skin(&binding.sites.influences, site, rest));
        skinned + self.added.of_vertex(vertex) + self.motions.palette.origin
    }

    /// Figures of the frame, in object space.
    pub(crate) fn fill_report(&mut self, binding: &Binding) {
        let object_from_armature = self.object.matrix3.determinant();
        let report = &mut self.report;
        for (index, state) in self.components.iter().enumerate() {
            report.skinned_volumes[index] = state.skinned * object_from_armature;
            report.target_volumes[index] = state.target * object_from_armature;
            report.corrected_volumes[index] = state.corrected * object_from_armature;
            report.component_is_pinned[index] = self.mask.as_ref().is_some_and(|mask| mask.is_pinned[index]);
        }
        report.joint_losses.fill(0.0);
        report.joint_regained.fill(0.0);
        report.joint_displacements.fill(0.0);
        report.joint_is_capped.fill(false);
        for (index, job) in binding.plan.jobs.iter().enumerate() {
            let (joint, state) = (job.joint as usize, &self.jobs[index]);
            // Inside-out components lose negative volume: figures are those of their flesh.
            let sign = self.components[job.component as usize].rest.signum() * object_from_armature.abs();
            report.joint_losses[joint] += self.changes[index].loss * sign;
            report.joint_regained[joint] += state.regained * sign;
            report.joint_displacements[joint] = report.joint_displacements[joint].max(state.displacement);
            report.joint_is_capped[joint] |= state.is_capped;
        }
        let gap = self.patches.iter().map(|p| p.gap_squared).fold(0.0, f64::max).sqrt();
        report.seam_gap = gap * object_from_armature.abs().cbrt();
    }
}

/// How far from 0 a map takes what is within a radius of 0, at most.
fn reach(map: &DAffine3, radius: f64) -> f64 {
    map.translation.length() + radius * (map.x_axis.length() + map.y_axis.length() + map.z_axis.length())
}

fn ragged<'a>(coordinates: &'a mut Coordinates, offsets: &'a [u32]) -> [Ragged<'a, f32>; 3] {
    coordinates.each_mut().map(|row| Ragged::new(row, offsets))
}

/// The number, or 0 where single precision cannot hold it: a shell flattened to nothing has no field.
fn in_single_precision(number: f64) -> f64 {
    if number.abs() < f64::from(f32::MAX) { number } else { 0.0 }
}

/// The same in double precision.
#[inline(always)]
fn widened(v: [f32; 4]) -> V4 {
    v.map(f64::from)
}
