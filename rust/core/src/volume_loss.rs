//! Whose volume is it: what each joint's turn takes from each component, by telescoping over joints [MATH §3].
//!
//! Parents first, one joint after the other turns with all below it following rigidly; the volumes before and after give
//! its loss. Only faces that the turn deforms are looked at. Faces that move as a whole change by a closed form.

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use crate::csr::Csr;
use crate::patches::{PATCH_POINTS, Patches};
use crate::sites::Sites;
use crate::skeleton::JointTree;
use crate::skinning::{Columns, Mode, Palette};
use crate::topology::Topology;

/// Stretch and shift below this are the noise of single-precision matrices, not the animator's intent.
const INTENT_NOISE: f64 = 1e-5;
/// From here on, stretch and shift count in full.
const INTENT_FULL: f64 = 1e-4;

/// One joint in one component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Job {
    pub joint: u32,
    pub component: u32,
}

/// What one joint did to one component.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Change {
    /// By shift and stretch: the animator's intent; positive = gained.
    pub intent: f64,
    /// By the turn; positive = lost.
    pub loss: f64,
}

/// Volume and area vector of the faces that move as a whole.
pub(crate) type Moment = (f64, DVec3);

/// Everything about the telescoping that does not change from frame to frame.
#[derive(Debug, Clone)]
pub(crate) struct LossPlan {
    pub jobs: Vec<Job>,
    /// Jobs whose rigid part holds each group of the surface.
    jobs_of_group: Csr<u32>,
    /// Faces that a joint's turn deforms, grouped by job.
    fringe: Patches,
    /// Per joint, what each bone follows before it turns.
    stages: Vec<Vec<u16>>,
}

/// A surface's faces sorted by (component, nearest joint above all their influences).
pub(crate) struct FaceGroups {
    /// Group of each face.
    pub of_face: Vec<u32>,
    /// Component of each group.
    pub components: Vec<u32>,
    joints: Vec<usize>,
}

impl FaceGroups {
    pub fn new(topology: &Topology, bones_of_point: &Csr<u16>, tree: &JointTree) -> Self {
        let keys: Vec<(u32, usize)> = topology
            .faces
            .rows()
            .zip(&topology.component_of_face)
            .map(|(face, &component)| {
                let mut bones = face.iter().flat_map(|&p| bones_of_point.row(p as usize)).map(|&b| usize::from(b));
                let first = bones.next().unwrap_or(tree.world());
                (component, bones.fold(first, |a, b| tree.common_ancestor(a, b)))
            })
            .collect();
        let mut groups = keys.clone();
        groups.sort_unstable();
        groups.dedup();
        let of_face = keys.iter().map(|key| groups.partition_point(|g| g < key) as u32).collect();
        Self { of_face, components: groups.iter().map(|g| g.0).collect(), joints: groups.iter().map(|g| g.1).collect() }
    }
}

impl LossPlan {
    pub fn new(topology: &Topology, groups: &FaceGroups, bones_of_point: &Csr<u16>, tree: &JointTree, rest: &[DVec3]) -> Self {
        let mut fringe: Vec<(Job, usize)> = Vec::new();
        let mut touched = Vec::new();
        for (index, face) in topology.faces.rows().enumerate() {
            let group = groups.of_face[index] as usize;
            let (component, top) = (groups.components[group], groups.joints[group]);
            touched.clear();
            for &bone in face.iter().flat_map(|&p| bones_of_point.row(p as usize)) {
                touched.extend(tree.chain(bone as usize).take_while(|&j| j != top).map(|j| j as u32));
            }
            touched.sort_unstable();
            touched.dedup();
            fringe.extend(touched.iter().map(|&joint| (Job { joint, component }, index)));
        }
        let mut jobs: Vec<Job> = fringe.iter().map(|f| f.0).collect();
        for (&component, &top) in groups.components.iter().zip(&groups.joints) {
            jobs.extend(tree.chain(top).map(|j| Job { joint: j as u32, component }));
        }
        jobs.sort_unstable();
        jobs.dedup();
        let job_index = |job: &Job| jobs.partition_point(|j| j < job) as u32;
        let faces: Vec<(u32, &[u32])> = fringe.iter().map(|(job, face)| (job_index(job), topology.faces.row(*face))).collect();
        let mut jobs_of_group = Csr::default();
        for (&component, &top) in groups.components.iter().zip(&groups.joints) {
            jobs_of_group.push_row(tree.chain(top).map(|j| job_index(&Job { joint: j as u32, component })));
        }
        Self {
            fringe: Patches::new(&faces, rest),
            stages: (0..tree.len()).map(|joint| tree.stage_before(joint)).collect(),
            jobs_of_group,
            jobs,
        }
    }

    pub fn fringe_len(&self) -> usize {
        self.fringe.len()
    }

    pub fn memory_bytes(&self) -> usize {
        self.fringe.memory_bytes()
            + self.jobs_of_group.memory_bytes()
            + size_of_val(&*self.jobs)
            + self.stages.iter().map(|s| size_of_val(&**s)).sum::<usize>()
    }

    /// Sums the moments of groups into those of the jobs whose turn carries them whole.
    pub fn rigid_moments(&self, of_group: &[Moment], of_job: &mut [Moment]) {
        of_job.fill((0.0, DVec3::ZERO));
        for (moment, jobs) in of_group.iter().zip(self.jobs_of_group.rows()) {
            for &job in jobs {
                of_job[job as usize].0 += moment.0;
                of_job[job as usize].1 += moment.1;
            }
        }
    }

    /// What every joint did to every component, in this frame's `motions`.
    pub fn measure(
        &self,
        motions: &Motions,
        sites: &Sites,
        rest: &[DVec3],
        moments: &[Moment],
        fringe: &mut [Change],
        changes: &mut [Change],
    ) {
        fringe.par_iter_mut().zip(self.fringe.patches()).for_each(|(change, patch)| {
            let joint = self.jobs[patch.group as usize].joint as usize;
            *change = Change::default();
            if motions.is_still[joint] {
                return;
            }
            let points = self.fringe.points_of(patch);
            let volume = |below: usize| {
                let mut p = [DVec3::ZERO; PATCH_POINTS];
                for (q, &point) in p.iter_mut().zip(points) {
                    *q = self.stage_position(motions, sites, rest, joint, below, point as usize);
                }
                self.fringe.volume(patch, &p)
            };
            let before = volume(motions.tree.parents[joint] as usize);
            let turned = volume(joint);
            let stretched = if motions.has_intent[joint] { volume(motions.stretched(joint)) } else { before };
            *change = Change { intent: stretched - before, loss: stretched - turned };
        });
        for (change, (job, moment)) in changes.iter_mut().zip(self.jobs.iter().zip(moments)) {
            let joint = job.joint as usize;
            *change = Change::default();
            if motions.is_still[joint] {
                continue;
            }
            let volume = |motion: usize| moved_volume(motions.palette.alone(motion), *moment);
            let before = volume(motions.tree.parents[joint] as usize);
            let stretched = if motions.has_intent[joint] { volume(motions.stretched(joint)) } else { before };
            *change = Change { intent: stretched - before, loss: stretched - volume(joint) };
        }
        for (change, patch) in fringe.iter().zip(self.fringe.patches()) {
            changes[patch.group as usize].intent += change.intent;
            changes[patch.group as usize].loss += change.loss;
        }
        for (job, corners) in self.fringe.giants() {
            let joint = self.jobs[*job as usize].joint as usize;
            if motions.is_still[joint] {
                continue;
            }
            let volume = |below: usize| {
                let at = |&p: &u32| self.stage_position(motions, sites, rest, joint, below, p as usize);
                let (mean, cross) = crate::volume::polygon_mean_and_cross(corners.iter().map(at));
                mean.dot(cross) / 6.0
            };
            let before = volume(motions.tree.parents[joint] as usize);
            let stretched = if motions.has_intent[joint] { volume(motions.stretched(joint)) } else { before };
            let change = &mut changes[*job as usize];
            change.intent += stretched - before;
            change.loss += stretched - volume(joint);
        }
    }

    /// A point when joint `joint` and all below follow motion `below`, and all others their own stage.
    #[inline]
    fn stage_position(&self, motions: &Motions, sites: &Sites, rest: &[DVec3], joint: usize, below: usize, point: usize) -> DVec3 {
        let stage = &self.stages[joint];
        let subtree = joint..motions.tree.ends[joint] as usize;
        sites.mean(point, |site| {
            motions.palette.skin(&sites.influences, site, rest[site], |bone| {
                let bone = bone as usize;
                if subtree.contains(&bone) { below } else { stage[bone] as usize }
            })
        })
    }
}

/// Volume of a moment's faces after an affine map.
fn moved_volume(m: &Columns, (volume, area): Moment) -> f64 {
    let map = DAffine3::from_cols_array(m);
    let (x, y, z) = (map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis);
    let cofactor = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    x.dot(y.cross(z)) * volume + map.translation.dot(cofactor * area) / 3.0
}

/// The motions of one frame: joints, the world, and joints stretched and shifted but not yet turned.
#[derive(Debug, Clone)]
pub(crate) struct Motions {
    pub tree: JointTree,
    pub palette: Palette,
    /// Joint's motion, armature space: pose · rest⁻¹.
    pub channels: Vec<DAffine3>,
    pub has_intent: Vec<bool>,
    /// Joints that do exactly what their parent does.
    pub is_still: Vec<bool>,
    rest: Vec<DAffine3>,
}

impl Motions {
    /// `rest`: rest matrix of each joint.
    pub fn new(tree: JointTree, rest: Vec<DAffine3>, mode: Mode) -> Self {
        let count = tree.len();
        Self {
            palette: Palette::new(mode, 2 * count + 1),
            channels: vec![DAffine3::IDENTITY; count + 1],
            has_intent: vec![false; count],
            is_still: vec![true; count],
            rest,
            tree,
        }
    }

    /// Index of the motion of a joint that is stretched and shifted only.
    pub fn stretched(&self, joint: usize) -> usize {
        self.tree.len() + 1 + joint
    }

    /// Takes a pose. `size`: the mesh's, for what counts as a shift. `keep_bone_scale`: shift and stretch are intent.
    pub fn set(&mut self, pose: &[DAffine3], armature_from_rest: DAffine3, origin: DVec3, size: f64, keep_bone_scale: bool) {
        self.palette.armature_from_rest = armature_from_rest;
        self.palette.origin = origin;
        let world = self.tree.world();
        self.palette.set(world, &DAffine3::IDENTITY, &DAffine3::IDENTITY);
        for joint in 0..self.tree.len() {
            let channel = pose[self.tree.bones[joint] as usize];
            self.channels[joint] = channel;
            self.palette.set(joint, &self.rest[joint], &channel);
            let parent = self.channels[self.tree.parents[joint] as usize];
            self.is_still[joint] = parent == channel;
            let intent = if keep_bone_scale { intended(&parent, &channel, self.tree.heads[joint], size) } else { None };
            self.has_intent[joint] = intent.is_some();
            if let Some(stretched) = intent {
                let index = self.stretched(joint);
                self.palette.set(index, &self.rest[joint], &stretched);
            }
        }
    }
}

/// The shift and stretch of a joint against its parent without its turn; `None` when there is nothing but the turn.
fn intended(parent: &DAffine3, channel: &DAffine3, head: DVec3, size: f64) -> Option<DAffine3> {
    if parent.matrix3.determinant() == 0.0 {
        return Some(*channel);
    }
    let local = parent.inverse() * *channel;
    let shift = local.transform_point3(head) - head;
    let Some(stretch) = stretch_of(&local.matrix3) else {
        // Mirrored or flattened: no turn can be told from it.
        return Some(*channel);
    };
    let strain = stretch - DMat3::IDENTITY;
    let amount = strain.to_cols_array().iter().fold(0.0f64, |m, s| m.max(s.abs())) + shift.length() / size.max(f64::MIN_POSITIVE);
    let t = ((amount - INTENT_NOISE) / (INTENT_FULL - INTENT_NOISE)).clamp(0.0, 1.0);
    let part = t * t * (3.0 - 2.0 * t);
    if part == 0.0 {
        return None;
    }
    let matrix3 = DMat3::IDENTITY + strain * part;
    Some(*parent * DAffine3 { matrix3, translation: head + shift * part - matrix3 * head })
}

/// S of the polar decomposition A = R·S, by Newton's iteration for R; `None` unless A keeps its handedness.
fn stretch_of(a: &DMat3) -> Option<DMat3> {
    let size = a.x_axis.length() * a.y_axis.length() * a.z_axis.length();
    if a.determinant() <= 1e-9 * size {
        return None;
    }
    let mut r = *a;
    for _ in 0..30 {
        let next = (r + r.inverse().transpose()) * 0.5;
        let step = next - r;
        r = next;
        if step.to_cols_array().iter().all(|s| s.abs() < 1e-15) {
            break;
        }
    }
    let s = r.transpose() * *a;
    Some((s + s.transpose()) * 0.5)
}
