//! One frame: pose, skin, losses, fields, residual. Buffers are made once; nothing is allocated and nothing is remembered.

use std::cell::RefCell;

use fearless_simd::{Level, Simd, dispatch};
use glam::{DAffine3, DMat4, DVec3};
use rayon::prelude::*;

use crate::binding::Binding;
use crate::correction::{Field, FieldFrame, Hold};
use crate::error::{Error, Result};
use crate::fields::{self, PatchFields, Row};
use crate::joint::{Joint, Shares};
use crate::lanes::{self, V4, add, add_scaled, scale};
use crate::motions::Motions;
use crate::patches::{PATCH_POINTS, Patch, Patches};
use crate::report::Report;
use crate::skinning::{CHUNK, Columns, check_object, check_pose, columns};
use crate::split::{Ragged, for_each_piece};
use crate::stages::{Body, ROWS, Rows, giant_moment, giant_volume};
use crate::supports::Supports;
use crate::sweeps::{self, Buffer, GRADIENT_PARTS, mean_and_cross, polygon_cubic, polygon_gradient};
use crate::volume::VolumeCubic;
use crate::volume_forms::{FormBuffers, VolumeForms};
use crate::volume_loss::{Change, Moment};

/// A component this near its target, relatively, has it: what is left is rounding.
const RESIDUAL_DONE: f64 = 1e-14;
/// Losses below this part of a component's volume share a residual with the whole shell instead of taking all of it.
const LOSS_FLOOR: f64 = 1e-3;
/// A residual field that must be scaled beyond this has lost its meaning; the whole shell then takes the residual.
const RESIDUAL_STEP_MAX: f64 = 1.0;

/// One frame's input.
#[derive(Debug, Clone, Copy)]
pub struct Pose<'a> {
    /// Per bone pose · rest⁻¹, armature space.
    pub matrices: &'a [DMat4],
    /// Armature space to object space.
    pub object_from_armature: DMat4,
    /// Value of each shape key; missing ones count as 0.
    pub shape_values: &'a [f64],
    /// Factor on the target volume.
    pub target_scale: f64,
    /// Strength of each bone's joint, in place of its setting.
    pub strengths: Option<&'a [f64]>,
}

impl<'a> Pose<'a> {
    /// A pose with armature and object in one space, no shape keys, and the rest volume as target.
    pub fn new(matrices: &'a [DMat4]) -> Self {
        Self { matrices, object_from_armature: DMat4::IDENTITY, shape_values: &[], target_scale: 1.0, strengths: None }
    }
}

/// Three coordinates of all slots.
type Coordinates = [Vec<f32>; 3];

/// Buffers of one frame.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(crate) motions: Motions,
    pub(crate) object: DAffine3,
    channels: Vec<DAffine3>,
    /// Per site, with shape keys mixed in; empty without shape keys.
    rest: Vec<V4>,
    body_moments: Vec<Moment>,
    job_moments: Vec<Moment>,
    changes: Vec<Change>,
    forms: Option<FormBuffers>,
    stage_changes: Vec<Change>,
    giant_positions: Vec<V4>,
    giant_room: Vec<f64>,
    /// Per slot, about the palette's origin.
    skinned: Vec<V4>,
    places: Coordinates,
    /// In units of the mean area.
    gradient: Coordinates,
    /// Per slot.
    moves: Vec<Move>,
    /// Gradients as sweeps leave them, per local point of patches and corner of giants.
    sources: Vec<V4>,
    /// Weight times profile, as in `Supports::weights`; empty while no joint has profiles.
    profiled: Vec<f32>,
    holds: Vec<Hold>,
    patches: Vec<PatchSums>,
    giant_volumes: Vec<f64>,
    jobs: Vec<JobState>,
    components: Vec<ComponentState>,
    pub(crate) report: Report,
}

/// How one point moves: (x, y, z, 0) each.
#[derive(Debug, Clone, Copy, Default)]
struct Move {
    /// By the fields.
    by: [f32; 4],
    /// By a unit of the residual's field.
    residual: [f32; 4],
}

/// What the sweeps find in one patch.
#[derive(Debug, Clone, Copy, Default)]
struct PatchSums {
    volume: f64,
    cubic: VolumeCubic,
    wide_hold: f64,
    gap_squared: f64,
}

/// One joint in one component, in one frame.
#[derive(Debug, Clone, Copy, Default)]
struct JobState {
    /// To be given back.
    volume: f64,
    frame: FieldFrame,
    hold: Hold,
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
    /// Volume for the field of the whole shell, its hold, its coefficient, and that of the residual's field.
    wide: f64,
    wide_hold: f64,
    wide_field: f64,
    wide_residual: f64,
    /// Whether the residual is left to the whole shell.
    is_wide_only: bool,
    /// Step along the residual's field; NaN where nothing may move.
    step: f64,
}

impl Workspace {
    pub(crate) fn new(binding: &Binding, supports: &Supports, settings: &[Joint]) -> Self {
        let slots = binding.patches.slot_count();
        let jobs = binding.plan.jobs.len();
        let coordinates = || std::array::from_fn(|_| vec![0.0; slots]);
        let forms = binding.plan.forms.as_ref().map(VolumeForms::buffers);
        let stage_changes = vec![Change::default(); if forms.is_some() { 0 } else { binding.plan.stages.change_count() }];
        let giants = &binding.patches.giants;
        let giant_points = giants.iter().map(|g| g.corners.len()).max().unwrap_or(0);
        let has_profiles = settings.iter().any(|joint| joint.profiles.is_some());
        let mut workspace = Self {
            motions: binding.motions.clone(),
            object: DAffine3::IDENTITY,
            channels: vec![DAffine3::IDENTITY; binding.bone_count],
            rest: if binding.shape_deltas.is_empty() { Vec::new() } else { binding.sites.rest.clone() },
            body_moments: binding.plan.bodies.rest_moments.clone(),
            job_moments: vec![(0.0, DVec3::ZERO); jobs],
            changes: vec![Change::default(); jobs],
            forms,
            stage_changes,
            giant_positions: vec![lanes::ZERO; giant_points],
            giant_room: vec![0.0; ROWS * giant_points],
            skinned: vec![lanes::ZERO; slots],
            places: coordinates(),
            gradient: coordinates(),
            moves: vec![Move::default(); slots],
            sources: vec![lanes::ZERO; binding.patches.source_count()],
            profiled: vec![0.0; if has_profiles { supports.weights.len() } else { 0 }],
            holds: vec![Hold::default(); supports.jobs_of_patch.values().len()],
            patches: vec![PatchSums::default(); binding.patches.list.len()],
            giant_volumes: vec![0.0; giants.len()],
            jobs: vec![JobState::default(); jobs],
            components: vec![ComponentState::default(); binding.components.len()],
            report: Report::new(binding.components.len(), binding.motions.tree.len()),
        };
        binding.plan.bodies.rigid_moments(&workspace.body_moments, &mut workspace.job_moments);
        workspace
    }

    /// Heap memory that grows with the mesh.
    pub fn memory_bytes(&self) -> usize {
        let coordinates = [&self.places, &self.gradient];
        let vectors = [&self.rest, &self.giant_positions, &self.skinned, &self.sources];
        coordinates.iter().flat_map(|c| c.iter()).map(|c| size_of_val(&**c)).sum::<usize>()
            + vectors.iter().map(|v| size_of_val(&***v)).sum::<usize>()
            + size_of_val(&*self.moves)
            + size_of_val(&*self.profiled)
            + size_of_val(&*self.holds)
            + size_of_val(&*self.patches)
            + size_of_val(&*self.stage_changes)
    }

    /// Checks and takes a pose.
    pub(crate) fn take(&mut self, binding: &Binding, pose: &Pose, keep_bone_scale: bool) -> Result<()> {
        if let Some(strengths) = pose.strengths {
            if strengths.len() != binding.bone_count {
                return Err(Error::Length { what: "strengths", found: strengths.len(), needed: binding.bone_count });
            }
            if let Some(&found) = strengths.iter().find(|s| !(**s >= 0.0 && s.is_finite())) {
                return Err(Error::Value { what: "strengths", found, needed: "numbers of 0 or more" });
            }
        }
        if !(pose.target_scale > 0.0 && pose.target_scale.is_finite()) {
            return Err(Error::Value { what: "target_scale", found: pose.target_scale, needed: "a number above 0" });
        }
        if pose.shape_values.len() > binding.shape_deltas.len() {
            return Err(Error::Length { what: "shape_values", found: pose.shape_values.len(), needed: binding.shape_deltas.len() });
        }
        if let Some(row) = pose.shape_values.iter().position(|v| !v.is_finite()) {
            return Err(Error::NotFinite { what: "shape_values", row });
        }
        check_pose(pose.matrices, &mut self.channels)?;
        self.object = check_object(&pose.object_from_armature)?;
        let armature_from_rest = self.object.inverse() * DAffine3::from_translation(binding.rest_centre);
        // Near the mean of the skinned points: sums about it keep their digits far from the world's origin.
        let mut origin = DVec3::ZERO;
        let mut total = 0.0;
        for (joint, &(mass, centre)) in binding.masses.iter().enumerate() {
            let bone = binding.motions.tree.bones.get(joint);
            let channel = bone.map_or(DAffine3::IDENTITY, |&bone| self.channels[bone as usize]);
            origin += (channel * armature_from_rest).transform_point3(centre) * mass;
            total += mass;
        }
        if total > 0.0 {
            origin /= total;
        }
        self.motions.set(&self.channels, armature_from_rest, origin, binding.size, keep_bone_scale);
        if !self.rest.is_empty() {
            binding.mix_shapes(pose.shape_values, &mut self.rest);
        }
        Ok(())
    }

    /// Skins all points; volume and gradient of the skinned surface, and stages on the way to it.
    pub(crate) fn skin(&mut self, binding: &Binding) {
        let level = Level::new();
        let patches = &binding.patches;
        let count = patches.list.len();
        let has_shapes = !self.rest.is_empty();
        let rest = if has_shapes { &self.rest } else { &binding.sites.rest };
        let stages = if binding.plan.forms.is_none() { Some(&binding.plan.stages) } else { None };
        let motions = &self.motions;
        let change_offsets = stages.map_or(&*patches.no_rows, |stages| &stages.change_offsets()[..=count]);
        let moment_offsets = if stages.is_some() { &patches.numbers } else { &patches.no_rows };
        let (changes, giant_changes) = self.stage_changes.split_at_mut(change_offsets[count] as usize);
        let (moments, giant_moments) = self.body_moments.split_at_mut(moment_offsets[count] as usize);
        let (sources, giant_sources) = self.sources.split_at_mut(patches.patch_source_count());
        for_each_piece(
            count,
            (
                (Ragged::new(&mut self.skinned, &patches.slot_offsets), ragged(&mut self.places, &patches.slot_offsets)),
                ragged(&mut self.gradient, &patches.slot_offsets),
                Ragged::new(sources, &patches.source_offsets),
                &mut *self.patches,
                (Ragged::new(changes, change_offsets), Ragged::new(moments, moment_offsets)),
            ),
            &|index, ((skinned, places), gradient, sources, sums, (changes, moment))| {
                let from = Skinner { binding, motions, rest, has_shapes, index };
                let into = Skinned {
                    positions: skinned.values,
                    places: places.map(|row| row.values),
                    gradient: gradient.map(|row| row.values),
                    sources: sources.values,
                    sums: &mut sums[0],
                    changes: changes.values,
                    moment: moment.values.first_mut(),
                };
                with_scratch(|scratch| dispatch!(level, simd => skin_patch(simd, from, into, scratch)));
            },
        );
        sweep_giants(binding, &mut self.giant_volumes, giant_sources, |slot| self.skinned[slot]);
        let Some(stages) = stages else { return };
        let mut giant_changes = giant_changes;
        for (index, (giant, moment)) in patches.giants.iter().zip(giant_moments).enumerate() {
            let body = Body { index: count + index, slots: &giant.corners, sites: &binding.sites, rest, motions };
            let corners = giant.corners.len();
            let mut positions = &mut self.giant_positions[..corners];
            if has_shapes {
                for (p, &slot) in positions.iter_mut().zip(&giant.corners) {
                    *p = binding.sites.mean(slot as usize, |site| rest[site]);
                }
                *moment = giant_moment(positions);
            }
            let (changes, rest_of_them) = giant_changes.split_at_mut(stages.joint_count(count + index));
            let rows = Rows::new(&mut self.giant_room, corners);
            if let Some(last) = stages.measure(body, *moment, rows, &mut positions, |p| giant_volume(p), changes) {
                changes[last].loss -= self.giant_volumes[index];
            }
            giant_changes = rest_of_them;
        }
        if has_shapes {
            binding.plan.bodies.rigid_moments(&self.body_moments, &mut self.job_moments);
        }
    }

    /// Losses, targets, and the volume each job is to give back.
    pub(crate) fn measure(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint], pose: &Pose) {
        binding.plan.carry(&self.motions, &self.job_moments, &mut self.changes);
        match (&binding.plan.forms, &mut self.forms) {
            (Some(forms), Some(buffers)) => forms.measure(&self.motions, buffers, &mut self.changes),
            _ => binding.plan.stages.gather(&self.stage_changes, &mut self.changes),
        }
        self.components.fill(ComponentState::default());
        // Moments are about the rest mesh in object space.
        let armature_from_object = self.object.matrix3.determinant().recip();
        for (moment, &component) in self.body_moments.iter().zip(&binding.plan.bodies.components) {
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
            let strength = pose.strengths.map_or(settings[joint].strength, |s| s[binding.motions.tree.bones[joint] as usize]);
            let given_back = strength * change.loss;
            let state = &mut self.components[job.component as usize];
            state.target += change.intent + (given_back - change.loss);
            match supports.heirs[index] {
                Some(heir) => self.jobs[heir as usize].volume += given_back,
                None => state.wide += given_back,
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

    /// Reads the gradient and sums what each field could do with it.
    pub(crate) fn hold(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint], pass: Pass) {
        let (patches, jobs, sources) = (&binding.patches, &self.jobs, &self.sources);
        let (places, has_profiles) = (self.places.each_ref().map(|c| &**c), !self.profiled.is_empty());
        let profile_offsets = if has_profiles { &supports.weight_offsets } else { &patches.no_rows };
        for_each_piece(
            patches.list.len(),
            (
                ragged(&mut self.gradient, &patches.slot_offsets),
                Ragged::new(&mut self.profiled, profile_offsets),
                Ragged::new(&mut self.holds, supports.jobs_of_patch.offsets()),
                &mut *self.patches,
            ),
            &|index, (gradient, profiled, holds, sums)| {
                let patch = &patches.list[index];
                let slots = patch.start..patches.slot_offsets[index + 1] as usize;
                let mut gradient = gradient.map(|row| row.values);
                import_gradient(binding, index, sources, &mut gradient);
                let gradient = gradient.map(|row| &*row);
                let (mut volumes, mut lengths, mut bell): (Row, Row, Row) = ([0.0; PATCH_POINTS], [0.0; PATCH_POINTS], [0.0; PATCH_POINTS]);
                let mut directions: [Row; 3] = [[0.0; PATCH_POINTS]; 3];
                let areas = &binding.inverse_areas[slots.clone()];
                fields::directions(gradient, areas, &mut directions, &mut volumes, &mut lengths);
                let places = places.map(|row| &row[slots.clone()]);
                sums[0].wide_hold = fields::sum_and_most(areas, &volumes, &lengths).0;
                let row_length = slots.len();
                for (row, (&job, hold)) in supports.jobs_of_patch.row(index).iter().zip(holds.values).enumerate() {
                    let state = &jobs[job as usize];
                    *hold = Hold::default();
                    if !state.frame.is_active || !pass.concerns(job as usize) {
                        continue;
                    }
                    let at = row * row_length..(row + 1) * row_length;
                    let weights = &supports.weights[supports.weight_offsets[index] as usize..][at.clone()];
                    let profiles =
                        settings[binding.plan.jobs[job as usize].joint as usize].profiles.as_ref().filter(|_| state.frame.has_axes());
                    let bell = &mut bell[..row_length];
                    fields::bell_heights(weights, places, &state.frame, bell);
                    if let (Pass::All, Some(profiles)) = (pass, profiles) {
                        for (i, profiled) in profiled.values[at.clone()].iter_mut().enumerate() {
                            let p = places.map(|row| f64::from(row[i]));
                            *profiled = weights[i] * state.frame.height(profiles, DVec3::from_array(p)) as f32;
                        }
                    }
                    (hold.all, hold.all_most) = fields::sum_and_most(weights, &volumes, &lengths);
                    (hold.bell, hold.bell_most) = fields::sum_and_most(bell, &volumes, &lengths);
                    if state.frame.has_axes() {
                        let shape = if profiles.is_some() { &profiled.values[at] } else { &*bell };
                        for (axis, e) in state.frame.axes.iter().enumerate() {
                            (hold.along[axis], hold.along_most[axis]) =
                                fields::sum_and_most_along(shape, gradient, &directions, e.as_vec3().to_array());
                        }
                    }
                }
            },
        );
        for (index, job) in self.jobs.iter_mut().enumerate().filter(|(index, _)| pass.concerns(*index)) {
            debug_assert!(index < binding.plan.jobs.len());
            job.hold = Hold::default();
        }
        for (&job, hold) in supports.jobs_of_patch.values().iter().zip(&self.holds) {
            if pass.concerns(job as usize) {
                self.jobs[job as usize].hold.join(hold, binding.area_unit);
            }
        }
        for state in &mut self.components {
            state.wide_hold = 0.0;
        }
        for (patch, sums) in patches.list.iter().zip(&self.patches) {
            self.components[patch.component as usize].wide_hold += sums.wide_hold * binding.area_unit;
        }
    }

    /// How much of each field.
    pub(crate) fn solve(&mut self, binding: &Binding, settings: &[Joint]) {
        for (state, job) in self.jobs.iter_mut().zip(&binding.plan.jobs) {
            let component = &mut self.components[job.component as usize];
            if !state.frame.is_active {
                component.wide += state.volume;
                continue;
            }
            let field = Field::new(&state.frame, &state.hold, component.wide_hold, settings[job.joint as usize].shares, state.volume);
            component.wide += state.volume - field.volume;
            state.take(field);
        }
        for state in &mut self.components {
            if state.wide_hold > 0.0 {
                state.wide_field = in_single_precision(state.wide / state.wide_hold);
                state.wide_residual = in_single_precision((state.floor + state.wide.abs()) / state.wide_hold);
            }
        }
    }

    /// Displacements by all fields at once, and the field of the residual: the same with every joint giving, none taking.
    pub(crate) fn apply(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint]) {
        self.add_fields(binding, supports, settings, Pass::All, |old, new| *old = new);
    }

    /// Computes the fields of some jobs in each patch; `keep` takes what they make of each point's move.
    fn add_fields(
        &mut self,
        binding: &Binding,
        supports: &Supports,
        settings: &[Joint],
        pass: Pass,
        keep: impl Fn(&mut Move, Move) + Sync,
    ) {
        let (jobs, components, patches) = (&self.jobs, &self.components, &binding.patches);
        let (gradient, places, profiled) = (self.gradient.each_ref().map(|c| &**c), self.places.each_ref().map(|c| &**c), &self.profiled);
        for_each_piece(patches.list.len(), Ragged::new(&mut self.moves, &patches.slot_offsets), &|index, moves| {
            let patch = &patches.list[index];
            let slots = patch.start..patches.slot_offsets[index + 1] as usize;
            let (gradient, places) = (gradient.map(|row| &row[slots.clone()]), places.map(|row| &row[slots.clone()]));
            let component = &components[patch.component as usize];
            let mut fields = PatchFields::new();
            if !matches!(pass, Pass::Some(_)) {
                fields.add_wide(&binding.inverse_areas[slots.clone()], component.wide_field, component.wide_residual);
            }
            let (mut unused, mut lengths, mut bell): (Row, Row, Row) = ([0.0; PATCH_POINTS], [0.0; PATCH_POINTS], [0.0; PATCH_POINTS]);
            let mut directions: [Row; 3] = [[0.0; PATCH_POINTS]; 3];
            fields::directions(gradient, &binding.inverse_areas[slots.clone()], &mut directions, &mut unused, &mut lengths);
            let bell = &mut bell[..slots.len()];
            for (row, &job) in supports.jobs_of_patch.row(index).iter().enumerate() {
                let state = &jobs[job as usize];
                if !state.frame.is_active || !pass.concerns(job as usize) {
                    continue;
                }
                let sign = if component.is_wide_only { 0.0 } else { state.volume.signum() as f32 };
                let at = supports.weight_offsets[index] as usize + row * slots.len();
                let at = at..at + slots.len();
                let weights = &supports.weights[at.clone()];
                fields::bell_heights(weights, places, &state.frame, bell);
                fields.add_round(&state.field, sign, weights, bell);
                if state.frame.has_axes() {
                    let has_profiles = settings[binding.plan.jobs[job as usize].joint as usize].profiles.is_some();
                    fields.add_shaped(&state.field, sign, if has_profiles { &profiled[at] } else { bell }, &directions);
                }
            }
            fields.add_along(&directions);
            for (i, old) in moves.values.iter_mut().enumerate() {
                keep(old, Move { by: fields.moved(i), residual: fields.residual(i) });
            }
        });
    }

    /// The paper's order: parents first, axis after axis, each on the mesh so far. The residual's field stays as `apply` made it.
    pub(crate) fn apply_in_order(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint]) {
        self.add_fields(binding, supports, settings, Pass::Shell, |old, new| old.by = new.by);
        for joint in 0..binding.motions.tree.len() {
            let is_mine = |job: usize, jobs: &[JobState]| binding.plan.jobs[job].joint as usize == joint && jobs[job].frame.is_active;
            let mine: Vec<usize> = (0..self.jobs.len()).filter(|&job| is_mine(job, &self.jobs)).collect();
            if mine.is_empty() {
                continue;
            }
            for job in &mine {
                let state = &mut self.jobs[*job];
                (state.regained, state.displacement, state.is_capped) = (0.0, 0.0, false);
            }
            let shares: Vec<[f64; 4]> =
                mine.iter().map(|&j| self.jobs[j].frame.ordered_shares(&self.jobs[j].hold, settings[joint].shares)).collect();
            for step in 0..4 {
                if shares.iter().all(|s| s[step] == 0.0) {
                    continue;
                }
                self.sweep_moved(binding);
                self.hold(binding, supports, settings, Pass::Some(&mine));
                for (&job, shares) in mine.iter().zip(&shares) {
                    let state = &mut self.jobs[job];
                    let axes = Shares::Axes(std::array::from_fn(|axis| f64::from(u8::from(axis == step))));
                    let shell = self.components[binding.plan.jobs[job].component as usize].wide_hold;
                    state.take(Field::new(&state.frame.for_step(step), &state.hold, shell, axes, state.volume * shares[step]));
                }
                self.add_fields(binding, supports, settings, Pass::Some(&mine), |old, new| {
                    old.by = std::array::from_fn(|i| old.by[i] + new.by[i]);
                });
            }
        }
    }

    /// Gradient of the surface moved so far.
    fn sweep_moved(&mut self, binding: &Binding) {
        let level = Level::new();
        let patches = &binding.patches;
        let (skinned, moves) = (&self.skinned, &self.moves);
        let place = |slot: usize| add(skinned[slot], widened(moves[slot].by));
        let (sources, giant_sources) = self.sources.split_at_mut(patches.patch_source_count());
        let arrays = (ragged(&mut self.gradient, &patches.slot_offsets), Ragged::new(sources, &patches.source_offsets));
        for_each_piece(patches.list.len(), arrays, &|index, (gradient, sources)| {
            let patch = &patches.list[index];
            let (mut p, mut by_point): (Buffer, Buffer) = ([lanes::ZERO; PATCH_POINTS], [lanes::ZERO; PATCH_POINTS]);
            for (p, &slot) in p.iter_mut().zip(&patches.local[patch.local.clone()]) {
                *p = place(slot as usize);
            }
            dispatch!(level, simd => sweeps::volume_and_gradient(simd, patches, patch, &p, &mut by_point));
            keep_gradient(binding, patch, &by_point, gradient.map(|row| row.values), sources.values);
        });
        sweep_giants(binding, &mut self.giant_volumes, giant_sources, place);
    }

    /// Steps along the residual's field until every component has its target, by the exact cubic.
    pub(crate) fn remove_residual(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint]) {
        self.find_steps(binding);
        if self.components.iter().any(|state| state.is_wide_only) {
            // Fields that fight each other, or far too little skin: the whole shell takes what is left.
            self.add_fields(binding, supports, settings, Pass::All, |old, new| old.residual = new.residual);
            self.find_steps(binding);
        }
    }

    fn find_steps(&mut self, binding: &Binding) {
        let level = Level::new();
        let patches = &binding.patches;
        let (skinned, moves) = (&self.skinned, &self.moves);
        for_each_piece(patches.list.len(), &mut *self.patches, &|index, sums| {
            sums[0].cubic = with_scratch(|scratch| dispatch!(level, simd => cubic_of_patch(simd, patches, index, skinned, moves, scratch)));
        });
        for state in &mut self.components {
            state.cubic = VolumeCubic::default();
        }
        for (patch, sums) in patches.list.iter().zip(&self.patches) {
            self.components[patch.component as usize].cubic.join(&sums.cubic);
        }
        for giant in &patches.giants {
            let corners = giant.corners.iter().map(|&slot| {
                let slot = slot as usize;
                (add(skinned[slot], widened(moves[slot].by)), widened(moves[slot].residual))
            });
            self.components[giant.component as usize].cubic.join(&polygon_cubic(corners));
        }
        for state in &mut self.components {
            let gap = state.target - state.cubic.0[0];
            let is_near = gap.abs() <= RESIDUAL_DONE * state.target.abs();
            let root = if is_near { Some(0.0) } else { state.cubic.root_nearest_zero(state.target) };
            match root.filter(|step| state.is_wide_only || step.abs() <= RESIDUAL_STEP_MAX) {
                Some(step) => state.step = step,
                None if !state.is_wide_only => state.is_wide_only = true,
                None if state.cubic.0[0].is_finite() => state.step = 0.0,
                // Beyond all numbers: as skinned.
                None => state.step = f64::NAN,
            }
            state.corrected = if state.step == 0.0 { state.cubic.0[0] } else { state.cubic.at(state.step) };
            if state.step.is_nan() {
                state.corrected = state.skinned;
            }
        }
    }

    /// Corrected − skinned of every vertex, object space.
    pub(crate) fn write_offsets(&mut self, binding: &Binding, offsets: &mut [[f32; 3]]) {
        let (moves, components, to_object) = (&self.moves, &self.components, columns(&self.object));
        let vertices = binding.slot_of_vertex.par_chunks(CHUNK).zip(binding.component_of_vertex.par_chunks(CHUNK));
        let offset_chunks = offsets.par_chunks_mut(CHUNK).with_min_len(3);
        let level = Level::new();
        let steps = |component: u32| components[component as usize].step;
        let largest_of = offset_chunks.zip(vertices).map(
            |(offsets, (slots, of_vertex))| dispatch!(level, simd => write_some(simd, moves, slots, of_vertex, steps, &to_object, offsets)),
        );
        let largest_squared = largest_of.reduce(|| 0.0, f64::max);
        self.report.max_displacement = largest_squared.sqrt();
    }

    /// Corrected − skinned of a vertex in double precision, armature space.
    pub(crate) fn displacement(&self, slot: u32, component: u32) -> DVec3 {
        self.moves.get(slot as usize).map_or(DVec3::ZERO, |point| {
            let step = self.components[component as usize].step;
            if step.is_nan() { DVec3::ZERO } else { lanes::to(add_scaled(widened(point.by), widened(point.residual), step)) }
        })
    }

    /// Skinned position of a site in armature space.
    pub(crate) fn skinned_site(&self, binding: &Binding, site: usize) -> DVec3 {
        let rest = if self.rest.is_empty() { &binding.sites.rest } else { &self.rest };
        lanes::to(self.motions.palette.skin(&binding.sites.influences, site, rest[site])) + self.motions.palette.origin
    }

    /// Figures of the frame, in object space.
    pub(crate) fn fill_report(&mut self, binding: &Binding) {
        let object_from_armature = self.object.matrix3.determinant();
        let report = &mut self.report;
        for (index, state) in self.components.iter().enumerate() {
            report.skinned_volumes[index] = state.skinned * object_from_armature;
            report.target_volumes[index] = state.target * object_from_armature;
            report.corrected_volumes[index] = state.corrected * object_from_armature;
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

/// Which jobs a sum is for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Pass<'a> {
    /// All, with heights sampled anew.
    All,
    /// These, with heights as they are.
    Some(&'a [usize]),
    /// None: only the field of the whole shell.
    Shell,
}

impl Pass<'_> {
    fn concerns(self, job: usize) -> bool {
        match self {
            Self::All => true,
            Self::Shell => false,
            Self::Some(jobs) => jobs.contains(&job),
        }
    }
}

impl JobState {
    /// Uses a field, and counts what it does.
    fn take(&mut self, field: Field) {
        self.regained += field.volume;
        self.displacement += field.displacement;
        self.is_capped |= field.is_capped;
        self.field = field;
    }
}

/// The number, or 0 where single precision cannot hold it: a shell flattened to nothing has no field.
fn in_single_precision(number: f64) -> f64 {
    if number.abs() < f64::from(f32::MAX) { number } else { 0.0 }
}

fn ragged<'a>(coordinates: &'a mut Coordinates, offsets: &'a [u32]) -> [Ragged<'a, f32>; 3] {
    coordinates.each_mut().map(|row| Ragged::new(row, offsets))
}

/// (x, y, z, 0) in double precision.
#[inline(always)]
fn widened(v: [f32; 4]) -> V4 {
    [f64::from(v[0]), f64::from(v[1]), f64::from(v[2]), f64::from(v[3])]
}

/// What a patch is skinned from.
#[derive(Clone, Copy)]
struct Skinner<'a> {
    binding: &'a Binding,
    motions: &'a Motions,
    rest: &'a [V4],
    has_shapes: bool,
    index: usize,
}

/// Room for one patch: one for each thread, so that it stays in its cache. No row crosses a cache line.
#[repr(align(64))]
struct Scratch {
    first: Buffer,
    second: Buffer,
    rows: [f64; ROWS * PATCH_POINTS],
}

fn with_scratch<R>(visit: impl FnOnce(&mut Scratch) -> R) -> R {
    thread_local! {
        static SCRATCH: RefCell<Box<Scratch>> = RefCell::new(Box::new(Scratch {
            first: [lanes::ZERO; PATCH_POINTS],
            second: [lanes::ZERO; PATCH_POINTS],
            rows: [0.0; ROWS * PATCH_POINTS],
        }));
    }
    SCRATCH.with_borrow_mut(|scratch| visit(scratch))
}

/// What skinning a patch leaves.
struct Skinned<'a> {
    positions: &'a mut [V4],
    places: [&'a mut [f32]; 3],
    gradient: [&'a mut [f32]; 3],
    sources: &'a mut [V4],
    sums: &'a mut PatchSums,
    changes: &'a mut [Change],
    moment: Option<&'a mut Moment>,
}

/// Skins the points a patch sees; keeps those it owns, the gradient of all, and what its joints lose.
#[inline(always)]
fn skin_patch<S: Simd>(simd: S, from: Skinner, into: Skinned, scratch: &mut Scratch) {
    let Skinner { binding, motions, rest, has_shapes, index } = from;
    let (patches, sites, palette, stages) = (&binding.patches, &binding.sites, &motions.palette, &binding.plan.stages);
    let patch = &patches.list[index];
    let slots = &patches.local[patch.local.clone()];
    let Scratch { first: p, second: by_point, rows } = scratch;
    let body = Body { index, slots, sites, rest, motions };
    let is_skinned = stages.ends_skinned(body);
    let mut last = None;
    if let Some(moment) = into.moment {
        if has_shapes {
            for (p, &slot) in p.iter_mut().zip(slots) {
                *p = sites.mean(slot as usize, |site| rest[site]);
            }
            let (volume, area) = sweeps::moment(simd, patches, patch, p);
            *moment = (volume, lanes::to(area));
        }
        let rows = Rows::new(rows, PATCH_POINTS);
        last = stages.measure(
            body,
            *moment,
            rows,
            p,
            #[inline(always)]
            |p| sweeps::volume(simd, patches, patch, p),
            into.changes,
        );
    } else if is_skinned {
        stages.skin(body, Rows::new(rows, PATCH_POINTS), p);
    }
    if !is_skinned {
        for (p, &slot) in p.iter_mut().zip(slots) {
            *p = sites.mean(slot as usize, |site| palette.skin(&sites.influences, site, rest[site]));
        }
    }
    by_point[..slots.len()].fill(lanes::ZERO);
    let volume = sweeps::volume_and_gradient(simd, patches, patch, p, by_point);
    if let Some(last) = last {
        into.changes[last].loss -= volume;
    }
    *into.sums = PatchSums { volume, ..PatchSums::default() };
    keep_gradient(binding, patch, by_point, into.gradient, into.sources);
    into.positions[..patch.owned].copy_from_slice(&p[..patch.owned]);
    for (axis, row) in into.places.into_iter().enumerate() {
        for (place, p) in row.iter_mut().zip(&p[..patch.owned]) {
            *place = p[axis] as f32;
        }
    }
    if sites.is_split() {
        for &slot in &slots[..patch.owned] {
            let mut twins = sites.of_slot(slot as usize).map(|site| palette.skin(&sites.influences, site, rest[site]));
            if let Some(first) = twins.next() {
                let gaps = twins.map(|twin| lanes::to(twin).distance_squared(lanes::to(first)));
                into.sums.gap_squared = gaps.fold(into.sums.gap_squared, f64::max);
            }
        }
    }
}

/// Keeps a patch's part of the gradient: whole for the points it alone uses, for others to be summed.
#[inline(always)]
fn keep_gradient(binding: &Binding, patch: &Patch, by_point: &Buffer, gradient: [&mut [f32]; 3], sources: &mut [V4]) {
    let (shared, foreign) = sources.split_at_mut(patch.shared);
    shared.copy_from_slice(&by_point[..patch.shared]);
    foreign.copy_from_slice(&by_point[patch.owned..patch.local.len()]);
    let per_area = 1.0 / (GRADIENT_PARTS * binding.area_unit);
    for (axis, row) in gradient.into_iter().enumerate() {
        for (g, by_point) in row.iter_mut().zip(&by_point[..patch.owned]) {
            *g = (by_point[axis] * per_area) as f32;
        }
    }
}

/// Sums the parts of the gradient at the points that a patch shares.
fn import_gradient(binding: &Binding, index: usize, sources: &[V4], gradient: &mut [&mut [f32]; 3]) {
    let patches = &binding.patches;
    let patch = &patches.list[index];
    let mut sum: Buffer = [lanes::ZERO; PATCH_POINTS];
    sum[..patch.shared].copy_from_slice(&sources[patches.source_offsets[index] as usize..][..patch.shared]);
    for import in patches.imports.row(index) {
        let sum = &mut sum[usize::from(import.owned)];
        *sum = add(*sum, sources[import.source as usize]);
    }
    let per_area = 1.0 / (GRADIENT_PARTS * binding.area_unit);
    for (axis, row) in gradient.iter_mut().enumerate() {
        for (g, sum) in row.iter_mut().zip(&sum[..patch.shared]) {
            *g = (sum[axis] * per_area) as f32;
        }
    }
}

/// V(P + tR) of a patch, P the points as moved so far and R the residual's field.
#[inline(always)]
fn cubic_of_patch<S: Simd>(simd: S, patches: &Patches, index: usize, skinned: &[V4], moves: &[Move], scratch: &mut Scratch) -> VolumeCubic {
    let patch = &patches.list[index];
    let Scratch { first: p, second: u, .. } = scratch;
    for ((p, u), &slot) in p.iter_mut().zip(u.iter_mut()).zip(&patches.local[patch.local.clone()]) {
        let slot = slot as usize;
        let point = moves[slot];
        (*p, *u) = (add(skinned[slot], widened(point.by)), widened(point.residual));
    }
    sweeps::volume_cubic(simd, patches, patch, p, u)
}

/// Offsets of some vertices; the largest squared length.
#[inline(always)]
fn write_some<S: Simd>(
    _: S,
    moves: &[Move],
    slots: &[u32],
    of_vertex: &[u32],
    step: impl Fn(u32) -> f64,
    to_object: &Columns,
    offsets: &mut [[f32; 3]],
) -> f64 {
    let mut largest = 0.0;
    for ((offset, &slot), &component) in offsets.iter_mut().zip(slots).zip(of_vertex) {
        let point = moves.get(slot as usize).map(|point| (point, step(component))).filter(|(_, step)| !step.is_nan());
        let Some((point, step)) = point else {
            *offset = [0.0; 3];
            continue;
        };
        let u = add_scaled(widened(point.by), widened(point.residual), step);
        let u = add_scaled(add_scaled(scale(to_object[0], u[0]), to_object[1], u[1]), to_object[2], u[2]);
        let squared = lanes::sum(lanes::mul(u, u));
        largest = if squared > largest { squared } else { largest };
        *offset = [u[0] as f32, u[1] as f32, u[2] as f32];
    }
    largest
}

/// Volume and gradient of faces too large for any patch.
fn sweep_giants(binding: &Binding, volumes: &mut [f64], sources: &mut [V4], place: impl Fn(usize) -> V4) {
    let mut sources = sources.iter_mut();
    for (giant, volume) in binding.patches.giants.iter().zip(volumes) {
        let count = giant.corners.len();
        let at = |i: usize| place(giant.corners[i % count] as usize);
        let (mean, area) = mean_and_cross((0..count).map(at));
        *volume = lanes::sum(lanes::mul(mean, area)) / 6.0;
        for (i, source) in (0..count).zip(&mut sources) {
            *source = polygon_gradient(mean, area, at(i + count - 1), at(i + 1), count);
        }
    }
}
