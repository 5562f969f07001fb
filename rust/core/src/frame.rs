//! One frame: pose, skin, losses, fields, residual. Buffers are made once; nothing is allocated and nothing is remembered.

use glam::{DAffine3, DMat4, DVec3};
use rayon::prelude::*;

use crate::binding::Binding;
use crate::correction::{Field, FieldFrame, Hold};
use crate::error::{Error, Result};
use crate::joint::{Joint, Shares};
use crate::report::Report;
use crate::skinning::{CHUNK, check_object, check_pose};
use crate::supports::Supports;
use crate::surface::SurfaceBuffers;
use crate::volume::VolumeCubic;
use crate::volume_loss::{Change, Moment, Motions};

/// Relative error at which residual steps end.
const RESIDUAL_DONE: f64 = 1e-13;
/// The first step is exact to rounding unless fields are as large as the mesh.
const RESIDUAL_STEPS: usize = 3;
/// Losses below this part of a component's volume share a residual with the whole shell instead of taking all of it.
const LOSS_FLOOR: f64 = 1e-3;

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

/// Buffers of one frame.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(crate) motions: Motions,
    pub(crate) object: DAffine3,
    channels: Vec<DAffine3>,
    rest: Vec<DVec3>,
    moments: Vec<Moment>,
    group_moments: Vec<Moment>,
    group_volumes: Vec<f64>,
    group_cubics: Vec<VolumeCubic>,
    component_cubics: Vec<VolumeCubic>,
    /// Skinned; empty where sites and points are the same.
    sites: Vec<DVec3>,
    /// Skinned.
    pub(crate) points: Vec<DVec3>,
    gradient: Vec<DVec3>,
    pub(crate) corrected: Vec<DVec3>,
    residual: Vec<DVec3>,
    surface: SurfaceBuffers,
    fringe: Vec<Change>,
    changes: Vec<Change>,
    jobs: Vec<JobState>,
    components: Vec<ComponentState>,
    chunks: Vec<ChunkBuffers>,
    pub(crate) report: Report,
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
    /// Σ |volume to give back| over joints, and the floor under it.
    spread: f64,
    floor: f64,
    /// Volume for the field of the whole shell, its hold, its coefficient, and that per unit of the residual.
    wide: f64,
    wide_hold: f64,
    wide_field: f64,
    wide_residual: f64,
    /// Step along the residual field.
    step: f64,
}

/// What one chunk of points needs for itself.
#[derive(Debug, Clone, Default)]
struct ChunkBuffers {
    holds: Vec<Hold>,
    gammas: Vec<(f32, f32)>,
    wide_holds: Vec<f64>,
    largest_squared: f64,
}

impl Workspace {
    pub(crate) fn new(binding: &Binding, supports: &Supports) -> Self {
        let points = binding.topology.point_count;
        let groups = binding.surface.group_count();
        let jobs = binding.plan.jobs.len();
        let chunks = (0..points.div_ceil(CHUNK)).map(|chunk| {
            let gammas = (chunk * CHUNK..((chunk + 1) * CHUNK).min(points)).map(|p| supports.holds.row(p).len()).sum();
            ChunkBuffers {
                holds: vec![Hold::default(); supports.jobs_of_chunk.row(chunk).len()],
                gammas: vec![(0.0, 0.0); gammas],
                wide_holds: vec![0.0; supports.components_of_chunk.row(chunk).len()],
                largest_squared: 0.0,
            }
        });
        let mut workspace = Self {
            motions: binding.motions.clone(),
            object: DAffine3::IDENTITY,
            channels: vec![DAffine3::IDENTITY; binding.bone_count],
            rest: if binding.shape_deltas.is_empty() { Vec::new() } else { binding.sites.rest.clone() },
            moments: vec![(0.0, DVec3::ZERO); jobs],
            group_moments: binding.rest_moments.clone(),
            group_volumes: vec![0.0; groups],
            group_cubics: vec![VolumeCubic::default(); groups],
            component_cubics: vec![VolumeCubic::default(); binding.topology.components.len()],
            sites: if binding.sites.is_identity() { Vec::new() } else { vec![DVec3::ZERO; binding.sites.len()] },
            points: vec![DVec3::ZERO; points],
            gradient: vec![DVec3::ZERO; points],
            corrected: vec![DVec3::ZERO; points],
            residual: vec![DVec3::ZERO; points],
            surface: binding.surface.buffers(),
            fringe: vec![Change::default(); binding.plan.fringe_len()],
            changes: vec![Change::default(); jobs],
            jobs: vec![JobState::default(); jobs],
            components: vec![ComponentState::default(); binding.topology.components.len()],
            chunks: chunks.collect(),
            report: Report::new(binding.topology.components.len(), binding.motions.tree.len()),
        };
        binding.plan.rigid_moments(&binding.rest_moments, &mut workspace.moments);
        workspace
    }

    /// Heap memory that grows with the mesh.
    pub fn memory_bytes(&self) -> usize {
        let vectors = [&self.rest, &self.sites, &self.points, &self.gradient, &self.corrected, &self.residual];
        vectors.iter().map(|v| size_of_val(&***v)).sum::<usize>()
            + self.surface.memory_bytes()
            + self.chunks.iter().map(|c| size_of_val(&*c.holds) + size_of_val(&*c.gammas)).sum::<usize>()
    }

    /// Skinned positions per site, about the palette's origin.
    pub(crate) fn skinned_sites(&self) -> &[DVec3] {
        if self.sites.is_empty() { &self.points } else { &self.sites }
    }

    fn rest<'a>(&'a self, binding: &'a Binding) -> &'a [DVec3] {
        if self.rest.is_empty() { &binding.sites.rest } else { &self.rest }
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
            let rest = &self.rest;
            let sites = &binding.sites;
            self.points.iter_mut().enumerate().for_each(|(point, p)| *p = sites.mean(point, |site| rest[site]));
            binding.surface.moments(&self.points, &mut self.group_moments);
            binding.plan.rigid_moments(&self.group_moments, &mut self.moments);
        }
        Ok(())
    }

    /// Blend skinning of sites and points.
    pub(crate) fn skin(&mut self, binding: &Binding) {
        let sites = &binding.sites;
        let rest = if self.rest.is_empty() { &sites.rest } else { &self.rest };
        if sites.is_identity() {
            self.motions.palette.skin_all(&sites.influences, rest, &mut self.points);
            return;
        }
        self.motions.palette.skin_all(&sites.influences, rest, &mut self.sites);
        let skinned = &self.sites;
        self.points.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, points)| {
            for (i, p) in points.iter_mut().enumerate() {
                *p = sites.mean(chunk * CHUNK + i, |site| skinned[site]);
            }
        });
    }

    /// Losses, targets, and the volume each job is to give back.
    pub(crate) fn measure(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint], pose: &Pose) {
        let mut fringe = std::mem::take(&mut self.fringe);
        let mut changes = std::mem::take(&mut self.changes);
        binding.plan.measure(&self.motions, &binding.sites, self.rest(binding), &self.moments, &mut fringe, &mut changes);
        (self.fringe, self.changes) = (fringe, changes);
        binding.surface.volumes_and_gradient(&self.points, &mut self.surface, &mut self.group_volumes);
        self.components.fill(ComponentState::default());
        // Moments are about the rest mesh in object space.
        let armature_from_object = self.object.matrix3.determinant().recip();
        for (group, &component) in binding.component_of_group.iter().enumerate() {
            let state = &mut self.components[component as usize];
            state.rest += self.group_moments[group].0 * armature_from_object;
            state.skinned += self.group_volumes[group];
        }
        for state in &mut self.components {
            state.target = state.rest;
        }
        for job in &mut self.jobs {
            *job = JobState::default();
        }
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
    pub(crate) fn hold(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint], samples_profiles: bool) {
        let (surface, buffers, jobs, points) = (&binding.surface, &self.surface, &self.jobs, &self.points);
        self.chunks.par_iter_mut().zip(self.gradient.par_chunks_mut(CHUNK)).enumerate().for_each(|(chunk, (local, gradient))| {
            local.holds.fill(Hold::default());
            local.wide_holds.fill(0.0);
            let chunk_jobs = supports.jobs_of_chunk.row(chunk);
            let chunk_components = supports.components_of_chunk.row(chunk);
            let mut entry = 0;
            for (i, gradient) in gradient.iter_mut().enumerate() {
                let point = chunk * CHUNK + i;
                let g = surface.gradient_at(point, buffers);
                *gradient = g;
                let inverse_area = f64::from(binding.inverse_areas[point]);
                if inverse_area > 0.0 {
                    let component = binding.topology.component_of_point[point];
                    if let Some(slot) = chunk_components.iter().position(|&c| c == component) {
                        local.wide_holds[slot] += inverse_area * g.length_squared();
                    }
                }
                for hold in supports.holds.row(point) {
                    let job = chunk_jobs[hold.slot as usize] as usize;
                    let frame = &jobs[job].frame;
                    if frame.is_active {
                        if samples_profiles {
                            local.gammas[entry] = frame.gamma(&settings[binding.plan.jobs[job].joint as usize], points[point]);
                        }
                        local.holds[hold.slot as usize].add(frame, local.gammas[entry], hold.weight, g);
                    }
                    entry += 1;
                }
            }
        });
        for job in &mut self.jobs {
            job.hold = Hold::default();
        }
        for state in &mut self.components {
            state.wide_hold = 0.0;
        }
        for (chunk, local) in self.chunks.iter().enumerate() {
            for (&job, hold) in supports.jobs_of_chunk.row(chunk).iter().zip(&local.holds) {
                self.jobs[job as usize].hold.join(hold);
            }
            for (&component, hold) in supports.components_of_chunk.row(chunk).iter().zip(&local.wide_holds) {
                self.components[component as usize].wide_hold += hold;
            }
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
            let field = Field::new(&state.frame, &state.hold, settings[job.joint as usize].shares, state.volume);
            component.wide += state.volume - field.volume;
            state.take(field);
            state.field.residual = state.volume.signum() / component.spread;
        }
        for state in &mut self.components {
            if state.wide_hold > 0.0 {
                state.wide_field = state.wide / state.wide_hold;
                state.wide_residual = state.floor / (state.spread * state.wide_hold);
            }
        }
    }

    /// Corrected positions by all fields at once, and the field of the residual.
    pub(crate) fn apply(&mut self, binding: &Binding, supports: &Supports) {
        let (jobs, components, points, gradient) = (&self.jobs, &self.components, &self.points, &self.gradient);
        let outputs = self.corrected.par_chunks_mut(CHUNK).zip(self.residual.par_chunks_mut(CHUNK));
        outputs.zip(&self.chunks).enumerate().for_each(|(chunk, ((corrected, residual), local))| {
            let chunk_jobs = supports.jobs_of_chunk.row(chunk);
            let mut gammas = local.gammas.iter();
            for (i, (q, r)) in corrected.iter_mut().zip(residual).enumerate() {
                let point = chunk * CHUNK + i;
                let g = gradient[point];
                let (mut u, mut v) = (DVec3::ZERO, DVec3::ZERO);
                let inverse_area = f64::from(binding.inverse_areas[point]);
                if inverse_area > 0.0 {
                    let component = &components[binding.topology.component_of_point[point] as usize];
                    u = g * (inverse_area * component.wide_field);
                    v = g * (inverse_area * component.wide_residual);
                }
                for (hold, gamma) in supports.holds.row(point).iter().zip(&mut gammas) {
                    let job = &jobs[chunk_jobs[hold.slot as usize] as usize];
                    if job.frame.is_active {
                        let moved = job.field.displacement_at(*gamma, hold.weight, g);
                        u += moved;
                        v += moved * job.field.residual;
                    }
                }
                *q = points[point] + u;
                *r = v;
            }
        });
    }

    /// The paper's order: parents first, axis after axis, each on the mesh so far. The residual field stays as `apply` made it.
    pub(crate) fn apply_in_order(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint]) {
        self.corrected.copy_from_slice(&self.points);
        for joint in 0..binding.motions.tree.len() {
            let mine: Vec<usize> =
                (0..self.jobs.len()).filter(|&j| binding.plan.jobs[j].joint as usize == joint && self.jobs[j].frame.is_active).collect();
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
                binding.surface.volumes_and_gradient(&self.corrected, &mut self.surface, &mut self.group_volumes);
                self.hold(binding, supports, settings, false);
                for (&job, shares) in mine.iter().zip(&shares) {
                    let state = &mut self.jobs[job];
                    let axes = Shares::Axes(std::array::from_fn(|axis| f64::from(u8::from(axis == step))));
                    let frame = state.frame.for_step(step);
                    let field = Field::new(&frame, &state.hold, axes, state.volume * shares[step]);
                    let residual = state.field.residual;
                    state.take(field);
                    state.field.residual = residual;
                }
                self.move_by_jobs(supports, &mine);
            }
        }
    }

    /// Moves the corrected points by the fields of some jobs alone.
    fn move_by_jobs(&mut self, supports: &Supports, mine: &[usize]) {
        let (jobs, gradient) = (&self.jobs, &self.gradient);
        self.corrected.par_chunks_mut(CHUNK).zip(&self.chunks).enumerate().for_each(|(chunk, (corrected, local))| {
            let chunk_jobs = supports.jobs_of_chunk.row(chunk);
            let mut gammas = local.gammas.iter();
            for (i, q) in corrected.iter_mut().enumerate() {
                let point = chunk * CHUNK + i;
                for (hold, gamma) in supports.holds.row(point).iter().zip(&mut gammas) {
                    let job = chunk_jobs[hold.slot as usize] as usize;
                    if mine.contains(&job) {
                        *q += jobs[job].field.displacement_at(*gamma, hold.weight, gradient[point]);
                    }
                }
            }
        });
    }

    /// Steps along the residual field until every component has its target, by the exact cubic.
    pub(crate) fn remove_residual(&mut self, binding: &Binding) {
        for _ in 0..RESIDUAL_STEPS {
            binding.surface.cubics(&self.corrected, &self.residual, &mut self.surface, &mut self.group_cubics);
            self.component_cubics.fill(VolumeCubic::default());
            for (cubic, &component) in self.group_cubics.iter().zip(&binding.component_of_group) {
                self.component_cubics[component as usize].join(cubic);
            }
            for (state, cubic) in self.components.iter_mut().zip(&self.component_cubics) {
                state.step = cubic.root_nearest_zero(state.target).unwrap_or(0.0);
            }
            self.step(binding);
            binding.surface.volumes(&self.corrected, &mut self.surface, &mut self.group_volumes);
            for state in &mut self.components {
                state.corrected = 0.0;
            }
            for (volume, &component) in self.group_volumes.iter().zip(&binding.component_of_group) {
                self.components[component as usize].corrected += volume;
            }
            if self.components.iter().all(|c| (c.corrected - c.target).abs() <= RESIDUAL_DONE * c.target.abs()) {
                break;
            }
        }
    }

    /// Moves corrected points along the residual field by each component's step.
    fn step(&mut self, binding: &Binding) {
        let (points, residual, components) = (&self.points, &self.residual, &self.components);
        let to_object = self.object.matrix3;
        self.corrected.par_chunks_mut(CHUNK).zip(&mut self.chunks).enumerate().for_each(|(chunk, (corrected, local))| {
            local.largest_squared = 0.0;
            for (i, q) in corrected.iter_mut().enumerate() {
                let point = chunk * CHUNK + i;
                if let Some(component) = components.get(binding.topology.component_of_point[point] as usize) {
                    *q += residual[point] * component.step;
                }
                local.largest_squared = local.largest_squared.max((to_object * (*q - points[point])).length_squared());
            }
        });
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
        let largest = self.chunks.iter().map(|c| c.largest_squared).fold(0.0, f64::max);
        report.max_displacement = largest.sqrt();
        let scale = object_from_armature.abs().cbrt();
        report.seam_gap = if self.sites.is_empty() { 0.0 } else { binding.sites.largest_gap(&self.sites) * scale };
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
