//! What losses are told in: joints in shells, what each did, and faces that are carried whole.

use glam::{DMat3, DVec3};

use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, Columns, V4};
use crate::skinning::joint_tree::JointTree;
use crate::skinning::sites::Sites;
use crate::surface::patches::Patches;
use crate::surface::topology::Topology;

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

impl Change {
    pub fn join(&mut self, other: &Self) {
        self.intent += other.intent;
        self.loss += other.loss;
    }
}

/// Volume and area vector of faces that move as a whole.
pub(crate) type Moment = (f64, DVec3);

/// Joints that move a face: the nearest above all its influences, and those below it that deform it, parents first.
#[derive(Debug, Clone)]
pub(crate) struct FaceJoints {
    pub tops: Vec<u32>,
    pub below: Csr<u16>,
}

impl FaceJoints {
    pub fn new(topology: &Topology, bones_of_point: &Csr<u16>, tree: &JointTree) -> Self {
        let mut result = Self { tops: Vec::new(), below: Csr::default() };
        for face in topology.faces.rows() {
            let bones = || face.iter().flat_map(|&p| bones_of_point.row(p as usize)).map(|&b| usize::from(b));
            let (top, below) = joints_of(bones, tree);
            result.tops.push(top as u32);
            result.below.push_row(below);
        }
        result
    }
}

/// The joint nearest above all `bones`, and those between it and them.
pub(crate) fn joints_of<I: Iterator<Item = usize>>(bones: impl Fn() -> I, tree: &JointTree) -> (usize, Vec<u16>) {
    let top = bones().reduce(|a, b| tree.common_ancestor(a, b)).unwrap_or(tree.world());
    let mut below: Vec<u16> = bones().flat_map(|b| tree.chain(b).take_while(|&j| j != top)).map(|j| j as u16).collect();
    below.sort_unstable();
    below.dedup();
    (top, below)
}

/// Faces that share the joints above them: carried whole by these.
#[derive(Debug, Clone, Default)]
pub(crate) struct Portions {
    pub components: Vec<u32>,
    pub tops: Vec<u32>,
    /// At rest, about the rest centre, rest space.
    pub rest_moments: Vec<Moment>,
    /// Jobs of `tops` and what is above.
    pub(super) jobs_above: Csr<u32>,
}

impl Portions {
    pub fn push(&mut self, component: u32, top: u32, rest_moment: Moment) {
        self.components.push(component);
        self.tops.push(top);
        self.rest_moments.push(rest_moment);
    }

    /// Sums the moments of portions into those of the jobs whose turn carries them whole.
    pub fn rigid_moments(&self, of_portion: &[Moment], of_job: &mut [Moment]) {
        of_job.fill((0.0, DVec3::ZERO));
        for (moment, jobs) in of_portion.iter().zip(self.jobs_above.rows()) {
            for &job in jobs {
                of_job[job as usize].0 += moment.0;
                of_job[job as usize].1 += moment.1;
            }
        }
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.components) + size_of_val(&*self.tops) + size_of_val(&*self.rest_moments) + self.jobs_above.memory_bytes()
    }
}

/// What the plan is made from.
#[derive(Clone, Copy)]
pub(crate) struct Anatomy<'a> {
    pub topology: &'a Topology,
    pub patches: &'a Patches,
    pub sites: &'a Sites,
    pub joints: &'a FaceJoints,
    pub tree: &'a JointTree,
    /// Place of each joint at rest, and of the world, rest space.
    pub heads: &'a [V4],
}

/// Index of a job.
pub(crate) fn find_job(jobs: &[Job], joint: usize, component: u32) -> Option<u32> {
    jobs.binary_search(&Job { joint: joint as u32, component }).ok().map(|index| index as u32)
}

/// Volume of a moment's faces after an affine map.
pub(crate) fn moved_volume(m: &Columns, (volume, area): Moment) -> f64 {
    let [x, y, z, translation] = m.map(lanes::to);
    let cofactor = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    x.dot(y.cross(z)) * volume + translation.dot(cofactor * area) / 3.0
}
