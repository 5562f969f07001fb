//! What each phase of a frame writes. Made once, for frames of any kind.

use glam::{DAffine3, DVec3};

use super::Bound;
use super::added::Added;
use super::body::Body;
use super::local::Local;
use super::places::{Coordinates, Places};
use crate::fields::field::{Capacity, Field, FieldFrame};
use crate::fields::patch_sums::Move;
use crate::numeric::block_rows::{Block, LANES};
use crate::numeric::lanes::{self, V4};
use crate::skinning::motions::Motions;
use crate::surface::volume::VolumeCubic;
use crate::volume_losses::closed_form::{FormBuffers, VolumeForms};
use crate::volume_losses::job::{Change, Moment};
use crate::volume_losses::staged::ROWS;

/// A pose that was checked, and what it brings along.
#[derive(Debug, Clone)]
pub(super) struct Posed {
    pub object: DAffine3,
    pub channels: Vec<DAffine3>,
    pub motions: Motions,
    pub body: Body,
    pub added: Added,
}

/// The surface before its correction.
#[derive(Debug, Clone)]
pub(super) struct Skinned {
    pub places: Places,
    pub carried: Carried,
    /// Per slot, what is added to the skin, armature space; empty where nothing is.
    pub offsets: Vec<[f32; 3]>,
    pub patches: Vec<SkinnedPatch>,
    pub giant_volumes: Vec<f64>,
}

/// Normals at rest as the pose carries them along: unit vectors per slot, armature space. Empty unless fields are even.
#[derive(Debug, Clone)]
pub(super) struct Carried {
    pub rows: Coordinates,
    pub is_used: bool,
}

/// What skinning finds in one patch.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SkinnedPatch {
    pub volume: f64,
    /// Without the law of flesh.
    pub bare: f64,
    pub gap_squared: f64,
}

/// Gradient of the surface moved so far.
#[derive(Debug, Clone)]
pub(super) struct Gradient {
    /// In units of the mean area. What patches share is summed where capacities are.
    pub rows: Coordinates,
    /// As sweeps leave them, per local point of patches and corner of giants.
    pub sources: Vec<V4>,
}

/// Moments of the body, and what joints change on the way to the skinned surface where that is measured by stages.
#[derive(Debug, Clone)]
pub(super) struct Staged {
    pub portion_moments: Vec<Moment>,
    pub job_moments: Vec<Moment>,
    /// Whether moments are those of the bound rest positions.
    pub has_bound_moments: bool,
    pub changes: Vec<Change>,
    pub giant_positions: Vec<V4>,
    pub giant_room: Vec<f64>,
}

/// What each job has lost.
#[derive(Debug, Clone)]
pub(super) struct Losses {
    pub forms: Option<FormBuffers>,
    pub changes: Vec<Change>,
}

/// What each job is to give back, and what each component is to have.
#[derive(Debug, Clone)]
pub(super) struct Targets {
    pub jobs: Vec<JobTarget>,
    pub components: Vec<ComponentTarget>,
    pub local: Local,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JobTarget {
    /// To be given back.
    pub volume: f64,
    pub frame: FieldFrame,
}

/// One component, armature space.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ComponentTarget {
    pub rest: f64,
    pub skinned: f64,
    /// As skinned, without the law of flesh.
    pub bare: f64,
    pub target: f64,
    /// Σ |volume to give back| over joints, and the floor under it.
    pub spread: f64,
    pub floor: f64,
    /// To be given back by no job: volume for the field of the whole shell.
    pub wide: f64,
}

/// Of what is to be solved: the gradient, how much of each field, and what they do.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub gradient: Gradient,
    pub fields: Fields,
    pub correction: Correction,
}

/// How much of each field.
#[derive(Debug, Clone)]
pub(super) struct Fields {
    pub jobs: Vec<JobField>,
    pub components: Vec<ComponentField>,
    /// Weight times profile, for each weight of `Supports`; empty while no joint has profiles.
    pub profiled: Vec<Block<f32>>,
    /// Of the jobs of each patch, and of the whole shell in each patch.
    pub capacities: Vec<Capacity>,
    pub wide_capacities: Vec<f64>,
    /// Per patch, what it adds along its normals, and would add along its gradient.
    pub evenness: Vec<[f64; 2]>,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JobField {
    pub capacity: Capacity,
    pub field: Field,
}

/// Volume for the field of the whole shell, its capacity, its coefficient, and that of the residual's field. Where fields are even:
/// what normals and what the gradient would add, and how much of each direction is the gradient's.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ComponentField {
    pub wide: f64,
    pub wide_capacity: f64,
    pub wide_field: f64,
    pub wide_residual: f64,
    pub evenness: [f64; 2],
    pub gradient_share: f32,
}

/// What the fields do.
#[derive(Debug, Clone)]
pub(super) struct Correction {
    /// Per slot.
    pub moves: Vec<Move>,
    pub jobs: Vec<JobOutcome>,
    pub components: Vec<ComponentOutcome>,
    /// Per patch.
    pub cubics: Vec<VolumeCubic>,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JobOutcome {
    /// Given back by all fields of the job, and the bound on what they move.
    pub regained: f64,
    pub displacement: f64,
    pub is_capped: bool,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ComponentOutcome {
    pub corrected: f64,
    pub cubic: VolumeCubic,
    /// Whether the residual is left to the whole shell.
    pub is_wide_only: bool,
    /// Whether fields are given up for one step along which the volume is linear.
    pub is_linear_only: bool,
    /// Step along the residual's field; NaN where nothing may move.
    pub step: f64,
}

fn coordinates(bound: Bound) -> Coordinates {
    std::array::from_fn(|_| vec![0.0; bound.binding.patches.slot_count()])
}

impl Posed {
    pub fn new(bound: Bound) -> Self {
        Self {
            object: DAffine3::IDENTITY,
            channels: vec![DAffine3::IDENTITY; bound.binding.bone_count],
            motions: bound.binding.motions.clone(),
            body: Body::default(),
            added: Added::default(),
        }
    }

    pub fn memory_bytes(&self) -> usize {
        self.body.memory_bytes() + self.added.memory_bytes()
    }
}

impl Skinned {
    pub fn new(bound: Bound) -> Self {
        let patches = &bound.binding.patches;
        Self {
            places: Places { near: coordinates(bound), rest: coordinates(bound) },
            carried: Carried { rows: if bound.supports.is_even { coordinates(bound) } else { Coordinates::default() }, is_used: false },
            offsets: Vec::new(),
            patches: vec![SkinnedPatch::default(); patches.list.len()],
            giant_volumes: vec![0.0; patches.giants.len()],
        }
    }

    pub fn memory_bytes(&self) -> usize {
        let Self { places, carried, offsets, patches, .. } = self;
        let rows = [&places.near, &places.rest, &carried.rows];
        rows.map(memory_of).into_iter().sum::<usize>() + size_of_val(&**offsets) + size_of_val(&**patches)
    }
}

impl Staged {
    pub fn new(bound: Bound) -> Self {
        let plan = &bound.binding.plan;
        let change_count = if plan.forms.is_none() { plan.stages.change_count() } else { 0 };
        let giants = &bound.binding.patches.giants;
        let giant_points = giants.iter().map(|g| g.corners.len().next_multiple_of(LANES)).max().unwrap_or(0);
        Self {
            portion_moments: Vec::new(),
            job_moments: vec![(0.0, DVec3::ZERO); plan.jobs.len()],
            has_bound_moments: false,
            changes: vec![Change::default(); change_count],
            giant_positions: vec![lanes::ZERO; giant_points],
            giant_room: vec![0.0; ROWS * giant_points],
        }
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.giant_positions) + size_of_val(&*self.changes)
    }
}

impl Losses {
    pub fn new(bound: Bound) -> Self {
        let plan = &bound.binding.plan;
        Self { forms: plan.forms.as_ref().map(VolumeForms::buffers), changes: vec![Change::default(); plan.jobs.len()] }
    }
}

impl Targets {
    pub fn new(bound: Bound) -> Self {
        Self {
            jobs: vec![JobTarget::default(); bound.binding.plan.jobs.len()],
            components: vec![ComponentTarget::default(); bound.binding.components.len()],
            local: Local::default(),
        }
    }

    pub fn memory_bytes(&self) -> usize {
        self.local.memory_bytes()
    }
}

impl Solution {
    pub fn new(bound: Bound) -> Self {
        let Bound { binding, supports, settings } = bound;
        let (jobs, components, patches) = (binding.plan.jobs.len(), binding.components.len(), binding.patches.list.len());
        let has_profiles = settings.iter().any(|joint| joint.profiles.is_some());
        Self {
            gradient: Gradient { rows: coordinates(bound), sources: vec![lanes::ZERO; binding.patches.source_count()] },
            fields: Fields {
                jobs: vec![JobField::default(); jobs],
                components: vec![ComponentField::default(); components],
                profiled: vec![[0.0; LANES]; if has_profiles { supports.block_count() } else { 0 }],
                capacities: vec![Capacity::default(); supports.jobs_of_patch.values().len()],
                wide_capacities: vec![0.0; patches],
                evenness: vec![[0.0; 2]; patches],
            },
            correction: Correction {
                moves: vec![Move::default(); binding.patches.slot_count()],
                jobs: vec![JobOutcome::default(); jobs],
                components: vec![ComponentOutcome::default(); components],
                cubics: vec![VolumeCubic::default(); patches],
            },
        }
    }

    pub fn memory_bytes(&self) -> usize {
        let Self { gradient, fields, correction } = self;
        memory_of(&gradient.rows)
            + size_of_val(&*gradient.sources)
            + size_of_val(&*fields.profiled)
            + size_of_val(&*fields.capacities)
            + size_of_val(&*correction.moves)
            + size_of_val(&*correction.cubics)
    }
}

fn memory_of(coordinates: &Coordinates) -> usize {
    coordinates.iter().map(|row| size_of_val(&**row)).sum()
}
