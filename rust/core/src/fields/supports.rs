//! Which points each joint may move, and how much of them: its vicinity on the body, fixed at bind.
//!
//! A joint acts on skin that follows its own bone, its parent or its children, near it at rest. Nearness in the pose is
//! not enough: a hand that rests on a belly must not swell with it.

use std::ops::Range;

use glam::DVec3;

use crate::fields::extents::Extents;
use crate::fields::joint::{Fields, Joint};
use crate::numeric::block_rows::{Block, BlockRows, LANES, Present};
use crate::numeric::csr::Csr;
use crate::skinning::joint_tree::JointTree;
use crate::skinning::sites::Sites;
use crate::surface::patches::Patches;
use crate::volume_losses::job::{Job, find_job};

/// Skin with less weight than this is not of the joint: stray weights would only make supports larger.
const STRAY_WEIGHT: f64 = 0.02;

/// Weights of all joints on all points.
#[derive(Debug, Clone)]
pub(crate) struct Supports {
    /// Jobs with weights in each patch.
    pub jobs_of_patch: Csr<u32>,
    /// Per patch and one past the last: where its blocks of weights start.
    pub block_offsets: Vec<u32>,
    /// A row per job of each patch: vicinity in 0..1, over the point's rest area (MATH §2, density).
    weights: BlockRows<f32>,
    /// Job that gives back each job's loss: itself, else the nearest above with weights; `None`: the whole shell.
    pub heirs: Vec<Option<u32>>,
    /// Length of each joint, armature space: the unit of its profiles. 0: no extent, no support.
    pub lengths: Vec<f64>,
    pub extents: &'static Extents,
    /// Whether fields are even: see `Fields`.
    pub is_even: bool,
}

/// What one joint may move of a patch.
#[derive(Clone, Copy)]
pub(crate) struct Support<'a> {
    pub job: usize,
    pub present: Present,
    pub weights: &'a [Block<f32>],
    /// Place of the first block among those of the patch.
    start: usize,
}

impl Support<'_> {
    /// Where anything lies that is kept for each weight of the patch.
    #[inline(always)]
    pub fn blocks(&self) -> Range<usize> {
        self.start..self.start + self.weights.len()
    }

    /// Weight of an owned point of the patch.
    pub fn weight(&self, place: usize) -> f32 {
        self.present.rank(place / LANES).map_or(0.0, |block| self.weights[block][place % LANES])
    }
}

impl Supports {
    /// `rest` per site in armature space, `inverse_areas` per slot, `settings` per joint.
    pub fn new(
        patches: &Patches,
        sites: &Sites,
        tree: &JointTree,
        jobs: &[Job],
        rest: &[DVec3],
        inverse_areas: &[f32],
        (settings, fields): (&[Joint], Fields),
    ) -> Self {
        let is_even = fields == Fields::Even;
        let extents = fields.extents();
        let lengths: Vec<f64> = automatic_lengths(tree, sites, rest, fields).iter().zip(settings).map(|(l, s)| l * s.size).collect();
        let vicinities = tree.vicinities();
        let mut jobs_of_patch = Csr::default();
        let mut block_offsets = vec![0];
        let mut weights = BlockRows::default();
        let mut has_hold = vec![false; jobs.len()];
        let mut near: Vec<(usize, f64)> = Vec::new();
        let mut rows: Vec<(u32, Vec<f32>)> = Vec::new();
        for patch in &patches.list {
            rows.clear();
            for (place, slot) in (patch.start..patch.start + patch.owned).enumerate() {
                let mut rest_place = DVec3::ZERO;
                near.clear();
                for site in sites.of_slot(slot) {
                    rest_place += rest[site] * sites.share(site);
                    let (bones, influences) = sites.influences.of(site);
                    for (&bone, &weight) in bones.iter().zip(influences) {
                        near.extend(vicinities.row(usize::from(bone)).iter().map(|&joint| (joint, weight * sites.share(site))));
                    }
                }
                near.sort_by_key(|n| n.0);
                for same in near.chunk_by(|a, b| a.0 == b.0) {
                    let joint = same[0].0;
                    let distance = rest_place.distance(tree.heads[joint]) / (extents.reach * lengths[joint]);
                    let belongs = (same.iter().map(|n| n.1).sum::<f64>() - STRAY_WEIGHT) / (1.0 - STRAY_WEIGHT);
                    if distance >= 1.0 || distance.is_nan() || belongs <= 0.0 {
                        continue;
                    }
                    let belongs = belongs.min(1.0);
                    let near = if is_even { even_nearness(distance, extents.reach) } else { (1.0 - distance * distance).powi(2) };
                    let vicinity = belongs * belongs * (3.0 - 2.0 * belongs) * near;
                    let weight = vicinity as f32 * inverse_areas[slot];
                    let Some(job) = find_job(jobs, joint, patch.component) else { continue };
                    if weight <= 0.0 || !weight.is_finite() {
                        continue;
                    }
                    let row = rows.iter().position(|r| r.0 == job).unwrap_or_else(|| {
                        rows.push((job, vec![0.0; patch.owned]));
                        rows.len() - 1
                    });
                    rows[row].1[place] = weight;
                }
            }
            rows.sort_by_key(|row| row.0);
            for (job, row) in &rows {
                has_hold[*job as usize] = true;
                weights.push_row(row);
            }
            block_offsets.push(weights.block_count() as u32);
            jobs_of_patch.push_row(rows.iter().map(|row| row.0));
        }
        weights.shrink_to_fit();
        let heirs = jobs
            .iter()
            .map(|job| tree.chain(job.joint as usize).filter_map(|j| find_job(jobs, j, job.component)).find(|&j| has_hold[j as usize]))
            .collect();
        Self { jobs_of_patch, block_offsets, weights, heirs, lengths, extents, is_even }
    }

    /// Weights of the jobs that have any in a patch.
    #[inline(always)]
    pub fn of_patch(&self, patch: usize) -> impl Iterator<Item = Support<'_>> {
        let first = self.jobs_of_patch.offsets()[patch] as usize;
        let mut start = 0;
        self.jobs_of_patch.row(patch).iter().enumerate().map(move |(row, &job)| {
            let (present, weights) = self.weights.row(first + row);
            let support = Support { job: job as usize, present, weights, start };
            start += weights.len();
            support
        })
    }

    /// Blocks of all weights.
    pub fn block_count(&self) -> usize {
        self.weights.block_count()
    }

    pub fn memory_bytes(&self) -> usize {
        self.jobs_of_patch.memory_bytes() + self.weights.memory_bytes() + size_of_val(&*self.heirs) + size_of_val(&*self.lengths)
    }
}

/// Nearness to a joint, by distance over reach: 1 as far as its profiles are drawn, so that they act as they are drawn.
fn even_nearness(distance: f64, reach: f64) -> f64 {
    let beyond = ((distance * reach - 1.0) / (reach - 1.0)).clamp(0.0, 1.0);
    1.0 - beyond * beyond * (3.0 - 2.0 * beyond)
}

/// The bone's length, kept between bounds by how far from the joint the skin lies that blends there.
pub(crate) fn automatic_lengths(tree: &JointTree, sites: &Sites, rest: &[DVec3], fields: Fields) -> Vec<f64> {
    let [least, most] = fields.extents().radii;
    let mut sums = vec![(0.0, 0.0); tree.len()];
    let mut below: Vec<(usize, f64)> = Vec::new();
    for (site, &p) in rest.iter().enumerate() {
        let (bones, weights) = sites.influences.of(site);
        below.clear();
        let joints = || bones.iter().zip(weights).map(|(&bone, &weight)| (usize::from(bone), weight)).filter(|j| j.0 != tree.world());
        let top = joints().map(|j| j.0).reduce(|a, b| tree.common_ancestor(a, b)).unwrap_or(tree.world());
        for (joint, weight) in joints() {
            below.extend(tree.chain(joint).take_while(|&j| j != top).map(|joint| (joint, weight)));
        }
        // All of the skin hangs on what is above all of its bones, mostly to 1: nothing blends there.
        let part = joints().map(|j| j.1).sum::<f64>();
        below.extend(tree.chain(top).take_while(|_| part < 1.0).map(|joint| (joint, part)));
        below.sort_by_key(|b| b.0);
        for same in below.chunk_by(|a, b| a.0 == b.0) {
            let part = same.iter().map(|b| b.1).sum::<f64>().min(1.0);
            let blend = 4.0 * part * (1.0 - part);
            let sum = &mut sums[same[0].0];
            sum.0 += blend * p.distance(tree.heads[same[0].0]);
            sum.1 += blend;
        }
    }
    (0..tree.len())
        .map(|joint| {
            let bone_length = tree.along_own[joint].map(DVec3::length);
            let (sum, weight) = sums[joint];
            let radius = if weight > 1e-9 { sum / weight } else { 0.0 };
            match bone_length {
                Some(length) if radius > 0.0 => length.clamp(least * radius, most * radius),
                Some(length) => length,
                None => least * radius,
            }
        })
        .collect()
}
