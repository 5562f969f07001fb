//! Joints that hang where their skin blends, and whose loss it is when they do what something else does.
//!
//! The tree says what such a joint moves against, and weights cannot always tell that. A shoulder that was hung on the arm stays
//! with the chest as the arm turns: it moves against what it hangs on, but it is the arm that turns. So a joint that moves
//! like a bone with which it blends, or like the bone above all of them, hands its loss on to the joints between.

use std::collections::HashSet;

use glam::DAffine3;

use crate::skinning::cut_chains::{Hanging, Weighted};
use crate::skinning::joint_tree::JointTree;
use crate::skinning::moments::Moments;

/// A bone that shares less than this part of a joint's blends is none to compare it with.
const SHARE_MIN: f64 = 0.02;
/// A joint that is less than this part as far, squared, from another bone as from what it hangs on begins to go with it.
const LIKENESS: f64 = 0.25;
/// Where those between that keep what is theirs are less than this part of all between, a joint begins to keep its loss.
const TAKERS_MIN: f64 = 0.1;

/// What a joint may move like.
#[derive(Debug, Clone, Copy)]
enum Like {
    Joint(u16),
    /// The bone, without weight, above the joint and what it hangs on; without one the armature.
    Above(Option<u32>),
}

#[derive(Debug, Clone)]
struct Other {
    like: Like,
    /// Part of the joint's blends.
    share: f64,
    /// Joints that move what the joint hangs on against `like`, as places in `HungJoint::between`.
    path: Vec<usize>,
}

/// A joint that hangs where its skin blends.
#[derive(Debug, Clone)]
pub(crate) struct HungJoint {
    pub joint: u16,
    /// Joints that may be given its loss.
    pub between: Vec<u16>,
    blend: Moments,
    others: Vec<Other>,
}

impl HungJoint {
    /// `shared`: joints of other trees with which it shares skin, and how much; `above`: the bone above it and what it hangs on.
    fn new(tree: &JointTree, joint: usize, blend: Moments, shared: &[(usize, f64)], above: Option<u32>) -> Option<Self> {
        let onto = tree.parent(joint)?;
        let whole: f64 = shared.iter().map(|s| s.1).sum();
        let mut result = Self { joint: joint as u16, between: Vec::new(), blend, others: Vec::new() };
        let below = joint..usize::from(tree.ends[joint]);
        for &(other, amount) in shared.iter().filter(|s| s.0 != onto && !below.contains(&s.0) && s.1 >= SHARE_MIN * whole) {
            let top = tree.common_ancestor(onto, other);
            let path = [onto, other].into_iter().flat_map(|joint| tree.chain(joint).take_while(|&j| j != top));
            result.push(Like::Joint(other as u16), amount / whole, path);
        }
        // Not further down: a foot that is planted stands still too, and its ankle loses all the same.
        if tree.parent(onto).is_none() {
            result.push(Like::Above(above), 1.0, std::iter::once(onto));
        }
        (!result.others.is_empty()).then_some(result)
    }

    fn push(&mut self, like: Like, share: f64, path: impl Iterator<Item = usize>) {
        let place = |joint: usize| {
            self.between.iter().position(|&j| usize::from(j) == joint).unwrap_or_else(|| {
                self.between.push(joint as u16);
                self.between.len() - 1
            })
        };
        let path: Vec<usize> = path.map(place).collect();
        if !path.is_empty() {
            self.others.push(Other { like, share, path });
        }
    }

    /// Part of its loss that is the joint's own, and in `parts` what else its loss may be of, up to a factor.
    fn own_part(&self, tree: &JointTree, channels: &[DAffine3], pose: &[DAffine3], parts: &mut [f64]) -> f64 {
        let own = &channels[usize::from(self.joint)];
        let from_onto = self.blend.apart(own, &channels[usize::from(tree.parents[usize::from(self.joint)])]);
        parts.fill(0.0);
        let mut whole = 1.0;
        for other in &self.others {
            let like = match other.like {
                Like::Joint(joint) => &channels[usize::from(joint)],
                Like::Above(bone) => bone.map_or(&DAffine3::IDENTITY, |bone| &pose[bone as usize]),
            };
            let likeness = self.blend.apart(own, like) / (LIKENESS * from_onto);
            // Also where nothing moves against anything.
            if likeness.is_nan() || likeness >= 1.0 {
                continue;
            }
            let own_part = eased(likeness);
            whole *= own_part;
            for &place in &other.path {
                let joint = usize::from(self.between[place]);
                let above = match (tree.parent(joint), other.like) {
                    (None, Like::Above(_)) => like,
                    _ => &channels[usize::from(tree.parents[joint])],
                };
                parts[place] += (1.0 - own_part) * other.share * self.blend.apart(&channels[joint], above);
            }
        }
        whole
    }
}

/// All hung joints that may move like something else than what they hang on, in the order of joints.
pub(crate) fn hung_joints(tree: &JointTree, bones: &Weighted, hanging: &Hanging) -> Vec<HungJoint> {
    let is_hung = &tree.is_hung;
    if !is_hung.contains(&true) {
        return Vec::new();
    }
    let mut joint_of: Vec<usize> = vec![tree.world(); bones.skeleton.len() + 1];
    let mut first_of: Vec<usize> = Vec::with_capacity(tree.len());
    for (joint, &bone) in tree.bones.iter().enumerate() {
        joint_of[bone as usize] = joint;
        let above = tree.parent(joint).filter(|_| !is_hung[joint]);
        first_of.push(above.map_or(joint, |above| first_of[above]));
    }
    // A chain's first joint is compared by its own skin where that blends, else by that of its chain.
    let mut blends_itself = vec![false; tree.len()];
    for (a, _) in hanging.shared.keys() {
        blends_itself[joint_of[*a as usize]] = true;
    }
    let compared_of = |joint: usize| if blends_itself[first_of[joint]] { joint } else { first_of[joint] };
    let mut shared = vec![Vec::new(); tree.len()];
    for (&(a, b), of_both) in &hanging.shared {
        shared[compared_of(joint_of[a as usize])].push((joint_of[b as usize], of_both.amount));
    }
    let mut skin = vec![Vec::new(); tree.len()];
    for (vertex, (&p, area)) in bones.rest.iter().zip(bones.areas).enumerate() {
        let (row, weights) = bones.influences.of(vertex);
        let joints = || row.iter().zip(weights).map(|(&bone, weight)| (joint_of[usize::from(bone)], weight)).filter(|j| j.0 < tree.len());
        for (joint, weight) in joints() {
            let compared = compared_of(joint);
            let others: f64 = joints().filter(|j| first_of[j.0] != first_of[joint]).map(|j| j.1).sum();
            if is_hung[compared] && others > 0.0 {
                skin[compared].push((weight * others * area, p));
            }
        }
    }
    let hung_joint = |joint: usize| {
        let shared = &mut shared[joint];
        shared.sort_by_key(|s| s.0);
        let shared: Vec<(usize, f64)> =
            shared.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, same.iter().map(|s| s.1).sum())).collect();
        let above_onto: HashSet<u32> = bones.skeleton.ancestors(tree.bones[tree.parent(joint)?]).collect();
        let above = bones.skeleton.ancestors(tree.bones[joint]).find(|bone| above_onto.contains(bone));
        HungJoint::new(tree, joint, Moments::new(&skin[joint]), &shared, above)
    };
    (0..tree.len()).filter(|&joint| is_hung[joint]).filter_map(hung_joint).collect()
}

/// What each hung joint hands on in one frame.
#[derive(Debug, Clone)]
pub(crate) struct HandedOn {
    /// Part of its loss that each keeps.
    pub kept: Vec<f64>,
    /// What of the rest those between are given, up to a factor.
    pub parts: Vec<Vec<f64>>,
    own: Vec<f64>,
}

impl HandedOn {
    pub fn new(hung: &[HungJoint]) -> Self {
        let parts = hung.iter().map(|hung| vec![0.0; hung.between.len()]).collect();
        Self { kept: vec![1.0; hung.len()], parts, own: vec![1.0; hung.len()] }
    }

    /// Continuous in the pose. Nobody is given what is not its own either: the order of joints means nothing.
    pub(super) fn set(&mut self, tree: &JointTree, hung_joints: &[HungJoint], channels: &[DAffine3], pose: &[DAffine3]) {
        for ((hung, own), parts) in hung_joints.iter().zip(&mut self.own).zip(&mut self.parts) {
            *own = hung.own_part(tree, channels, pose, parts);
        }
        for (index, (hung, parts)) in hung_joints.iter().zip(&mut self.parts).enumerate() {
            self.kept[index] = 1.0;
            let all: f64 = parts.iter().sum();
            if self.own[index] == 1.0 || all == 0.0 {
                continue;
            }
            for (part, joint) in parts.iter_mut().zip(&hung.between) {
                let taker = hung_joints.binary_search_by_key(joint, |other| other.joint);
                *part *= taker.map_or(1.0, |taker| self.own[taker]) / all;
            }
            let takers = eased((parts.iter().sum::<f64>() / TAKERS_MIN).min(1.0));
            self.kept[index] = 1.0 - (1.0 - self.own[index]) * takers;
        }
    }
}

/// From 0 to 1, smooth at both ends.
fn eased(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}
