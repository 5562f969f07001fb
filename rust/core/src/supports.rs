//! Which points each joint may move, and how much of them: its vicinity on the body, fixed at bind.
//!
//! A joint acts on skin that follows its own bone, its parent or its children, near it at rest. Nearness in the pose is
//! not enough: a hand that rests on a belly must not swell with it.

use glam::DVec3;

use crate::csr::Csr;
use crate::joint::Joint;
use crate::profile::BELL_WIDTH;
use crate::sites::Sites;
use crate::skeleton::JointTree;
use crate::skinning::CHUNK;
use crate::topology::{NO_COMPONENT, Topology};
use crate::volume_loss::Job;

/// Reach at rest, in joint lengths.
const REACH: f64 = 1.25;
/// A joint is at least this many times as long as the skin that blends at it is far from it, so that bells reach the skin…
const LENGTH_MIN: f64 = 1.0 / BELL_WIDTH;
/// …and at most this many times, so that a correction stays at its joint on long thin limbs.
const LENGTH_MAX: f64 = 2.0 * LENGTH_MIN;

/// One joint's hold on one point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hold {
    /// Index into the jobs of the point's chunk.
    pub slot: u16,
    /// Vicinity in 0..1, over the point's rest area (MATH §2, density).
    pub weight: f32,
}

/// Holds of all points.
#[derive(Debug, Clone)]
pub(crate) struct Supports {
    pub holds: Csr<Hold>,
    /// Jobs that appear in each chunk of points.
    pub jobs_of_chunk: Csr<u32>,
    /// Sound components that appear in each chunk.
    pub components_of_chunk: Csr<u32>,
    /// Job that gives back each job's loss: itself, else the nearest above that holds anything; `None`: the whole shell.
    pub heirs: Vec<Option<u32>>,
    /// Length of each joint, armature space: the unit of its profiles. 0: no extent, no support.
    pub lengths: Vec<f64>,
}

impl Supports {
    /// `rest` per site and `inverse_areas` per point in armature space; `settings` per joint.
    pub fn new(
        topology: &Topology,
        sites: &Sites,
        tree: &JointTree,
        jobs: &[Job],
        rest: &[DVec3],
        inverse_areas: &[f32],
        settings: &[Joint],
    ) -> Self {
        let lengths: Vec<f64> = automatic_lengths(tree, sites, rest).iter().zip(settings).map(|(l, s)| l * s.size).collect();
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); tree.len()];
        for joint in 0..tree.len() {
            if let Some(parent) = tree.parent(joint) {
                children[parent].push(joint);
            }
        }
        let mut holds = Csr::default();
        let mut jobs_of_chunk = Csr::default();
        let mut components_of_chunk = Csr::default();
        let mut has_hold = vec![false; jobs.len()];
        let mut near: Vec<(usize, f64)> = Vec::new();
        for chunk in 0..topology.point_count.div_ceil(CHUNK) {
            let mut chunk_jobs: Vec<u32> = Vec::new();
            let mut chunk_components: Vec<u32> = Vec::new();
            let points = chunk * CHUNK..((chunk + 1) * CHUNK).min(topology.point_count);
            for (point, &inverse_area) in points.clone().zip(&inverse_areas[points]) {
                let component = topology.component_of_point[point];
                let sound = component != NO_COMPONENT && topology.components[component as usize].is_sound();
                if !sound || inverse_area <= 0.0 {
                    holds.push_row([]);
                    continue;
                }
                if !chunk_components.contains(&component) {
                    chunk_components.push(component);
                }
                near.clear();
                let mut place = DVec3::ZERO;
                sites.visit(point, |site, share| {
                    place += rest[site] * share;
                    let (bones, weights) = sites.influences.of(site);
                    for (&bone, &weight) in bones.iter().zip(weights) {
                        vicinity(tree, &children, bone as usize, |joint| near.push((joint, weight * share)));
                    }
                });
                near.sort_by_key(|n| n.0);
                let mut row = Vec::new();
                for same in near.chunk_by(|a, b| a.0 == b.0) {
                    let joint = same[0].0;
                    let belongs = same.iter().map(|n| n.1).sum::<f64>().min(1.0);
                    let distance = place.distance(tree.heads[joint]) / (REACH * lengths[joint]);
                    if distance >= 1.0 || distance.is_nan() {
                        continue;
                    }
                    let weight = belongs * belongs * (3.0 - 2.0 * belongs) * (1.0 - distance * distance).powi(2);
                    let Ok(job) = jobs.binary_search(&Job { joint: joint as u32, component }) else { continue };
                    let weight = weight as f32 * inverse_area;
                    if weight <= 0.0 || !weight.is_finite() {
                        continue;
                    }
                    has_hold[job] = true;
                    let slot = chunk_jobs.iter().position(|&j| j == job as u32).unwrap_or_else(|| {
                        chunk_jobs.push(job as u32);
                        chunk_jobs.len() - 1
                    });
                    row.push(Hold { slot: slot as u16, weight });
                }
                holds.push_row(row);
            }
            jobs_of_chunk.push_row(chunk_jobs);
            components_of_chunk.push_row(chunk_components);
        }
        let heirs = jobs
            .iter()
            .map(|job| {
                tree.chain(job.joint as usize)
                    .filter_map(|j| jobs.binary_search(&Job { joint: j as u32, component: job.component }).ok())
                    .find(|&j| has_hold[j])
                    .map(|j| j as u32)
            })
            .collect();
        Self { holds, jobs_of_chunk, components_of_chunk, heirs, lengths }
    }

    pub fn memory_bytes(&self) -> usize {
        self.holds.memory_bytes() + self.jobs_of_chunk.memory_bytes() + size_of_val(&*self.heirs) + size_of_val(&*self.lengths)
    }
}

/// Joints in whose vicinity skin of `bone` lies: its own, its children's and its parent's.
fn vicinity(tree: &JointTree, children: &[Vec<usize>], bone: usize, mut visit: impl FnMut(usize)) {
    if bone == tree.world() {
        (0..tree.len()).filter(|&j| tree.parent(j).is_none()).for_each(visit);
        return;
    }
    visit(bone);
    if let Some(parent) = tree.parent(bone) {
        visit(parent);
    }
    children[bone].iter().for_each(|&child| visit(child));
}

/// The bone's length, kept between bounds by how far from the joint the skin lies that blends there.
fn automatic_lengths(tree: &JointTree, sites: &Sites, rest: &[DVec3]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); tree.len()];
    let mut below: Vec<(usize, f64)> = Vec::new();
    for (site, &p) in rest.iter().enumerate() {
        let (bones, weights) = sites.influences.of(site);
        below.clear();
        for (&bone, &weight) in bones.iter().zip(weights) {
            below.extend(tree.chain(bone as usize).map(|joint| (joint, weight)));
        }
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
                Some(length) if radius > 0.0 => length.clamp(LENGTH_MIN * radius, LENGTH_MAX * radius),
                Some(length) => length,
                None => LENGTH_MIN * radius,
            }
        })
        .collect()
}
