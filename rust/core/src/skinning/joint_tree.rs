//! The joints that a mesh makes of bones: those that carry weight, in a tree, parents first.

use glam::DVec3;

use crate::numeric::csr::Csr;
use crate::skinning::blend::Influences;
use crate::skinning::cut_chains::{Hanging, Weighted};
use crate::skinning::hung_joints::{Blend, HungJoint};
use crate::skinning::skeleton::Skeleton;

/// Shorter than this part of the mesh's size is no direction.
const DIRECTION_MIN: f64 = 1e-6;

/// Joints in depth-first order, so that the joints below `j` are `j..end[j]`. The *world*, index `len`, is above all.
#[derive(Debug, Clone)]
pub(crate) struct JointTree {
    /// Bone of each joint.
    pub bones: Vec<u32>,
    /// Joint above, or `len` for the world.
    pub parents: Vec<u16>,
    /// One past the last joint below.
    pub ends: Vec<u16>,
    /// Joint's place at rest, armature space.
    pub heads: Vec<DVec3>,
    /// From the parent's joint to this one at rest; `None` where they coincide or there is no parent.
    pub along_parent: Vec<Option<DVec3>>,
    /// From this joint along its own body at rest; `None` where it has no extent.
    pub along_own: Vec<Option<DVec3>>,
    /// Joints of cut chains, which hang on a bone that is not above them.
    pub is_hung: Vec<bool>,
    /// First joint of each joint's body: itself, but for segments.
    pub bodies: Vec<u16>,
    /// Per bone, whether it is a segment of the one above.
    pub is_segment: Vec<bool>,
    /// Those of them that may move like something else than what they hang on.
    pub hung: Vec<HungJoint>,
    /// Bones that carry no weight between each joint and the one above, from above, and then the joint's own.
    pub links: Csr<u32>,
}

impl JointTree {
    /// Joints of the bones that carry weight. `rest` are the vertices in armature space, with their `areas`.
    ///
    /// A weighted bone hangs on its nearest weighted ancestor; one that has none as `cut_chains` says.
    pub fn new(skeleton: &Skeleton, influences: &Influences, rest: &[DVec3], areas: &[f64]) -> Self {
        let world = skeleton.len();
        let mut masses = vec![0.0; world + 1];
        let mut moments = vec![DVec3::ZERO; world + 1];
        for (vertex, &p) in rest.iter().enumerate() {
            let (bones, weights) = influences.of(vertex);
            for (&bone, &weight) in bones.iter().zip(weights) {
                masses[bone as usize] += weight;
                moments[bone as usize] += p * weight;
            }
        }
        let weighted = Weighted { skeleton, influences, masses: &masses, rest, areas, size: size_of(rest) };
        let hanging = Hanging::new(&weighted);
        let Hanging { parents, is_hung, .. } = &hanging;
        let mut children = vec![Vec::new(); world + 1];
        for bone in 0..world {
            if masses[bone] > 0.0 {
                children[parents[bone].map_or(world, |p| p as usize)].push(bone as u32);
            }
        }
        let mut tree = Self {
            bones: Vec::new(),
            parents: Vec::new(),
            ends: Vec::new(),
            heads: Vec::new(),
            along_parent: Vec::new(),
            along_own: Vec::new(),
            is_hung: Vec::new(),
            bodies: Vec::new(),
            is_segment: skeleton.is_segment.clone(),
            hung: Vec::new(),
            links: Csr::default(),
        };
        // Joints turn in this order: where chains are cut it follows from what hangs there, not from numbers of bones.
        for children in children.iter_mut().filter(|children| children.iter().any(|&child| is_hung[child as usize])) {
            let mass = |bone: u32| if is_hung[bone as usize] { masses[bone as usize] } else { f64::INFINITY };
            children.sort_by(|&a, &b| mass(b).total_cmp(&mass(a)));
        }
        let count = children.iter().map(Vec::len).sum::<usize>() as u16;
        let mut stack: Vec<(u32, u16)> = children[world].iter().rev().map(|&bone| (bone, count)).collect();
        while let Some((bone, parent)) = stack.pop() {
            let joint = tree.bones.len() as u16;
            tree.bones.push(bone);
            tree.parents.push(parent);
            tree.ends.push(joint + 1);
            tree.heads.push(skeleton.head(bone));
            tree.is_hung.push(is_hung[bone as usize]);
            let above = tree.parent(usize::from(joint)).filter(|&p| skeleton.body(tree.bones[p]) == skeleton.body(bone));
            tree.bodies.push(above.map_or(joint, |p| tree.bodies[p]));
            let has_above = parents[bone as usize].is_some() && !is_hung[bone as usize];
            let mut links: Vec<u32> = skeleton.ancestors(bone).take_while(|&b| has_above && masses[b as usize] <= 0.0).collect();
            links.reverse();
            tree.links.push_row(links.into_iter().chain([bone]));
            stack.extend(children[bone as usize].iter().rev().map(|&child| (child, joint)));
        }
        for joint in (0..tree.len()).rev() {
            if let Some(parent) = tree.parent(joint) {
                tree.ends[parent] = tree.ends[parent].max(tree.ends[joint]);
            }
        }
        tree.find_directions(&masses, &moments, weighted.size * DIRECTION_MIN);
        tree.hung = tree.hung_joints(&weighted, &hanging);
        tree
    }

    fn hung_joints(&self, weighted: &Weighted, hanging: &Hanging) -> Vec<HungJoint> {
        let Weighted { skeleton, influences, rest, areas, .. } = *weighted;
        let is_hung: Vec<usize> = (0..self.len()).filter(|&joint| self.is_hung[joint]).collect();
        if is_hung.is_empty() {
            return Vec::new();
        }
        let mut joint_of: Vec<usize> = vec![self.world(); skeleton.len() + 1];
        for (joint, &bone) in self.bones.iter().enumerate() {
            joint_of[bone as usize] = joint;
        }
        // Joints of each chain, and per joint what it shares with those of others.
        let chain_of: Vec<usize> = (0..self.len())
            .map(|joint| self.chain(joint).find(|&j| self.is_hung[j] || self.parent(j).is_none()).unwrap_or(joint))
            .collect();
        let mut blends = vec![Vec::new(); self.len()];
        for (&(a, b), shared) in &hanging.shared {
            blends[joint_of[a as usize]].push((joint_of[b as usize], shared.amount));
        }
        // A chain's first joint is compared by its own skin where that blends, else by that of its chain.
        let compared_of = |joint: usize| if blends[chain_of[joint]].is_empty() { chain_of[joint] } else { joint };
        let mut skin = vec![Vec::new(); self.len()];
        for (vertex, (&p, area)) in rest.iter().zip(areas).enumerate() {
            let (bones, weights) = influences.of(vertex);
            let joints =
                || bones.iter().zip(weights).map(|(&bone, weight)| (joint_of[usize::from(bone)], weight)).filter(|j| j.0 < self.len());
            for (joint, weight) in joints() {
                let compared = compared_of(joint);
                let others: f64 = joints().filter(|j| chain_of[j.0] != chain_of[joint]).map(|j| j.1).sum();
                if self.is_hung[compared] && others > 0.0 {
                    skin[compared].push((weight * others * area, p));
                }
            }
        }
        let hung_joint = |&joint: &usize| {
            let mut shared: Vec<(usize, f64)> =
                (0..self.len()).filter(|&j| chain_of[j] == joint && compared_of(j) == joint).flat_map(|j| blends[j].clone()).collect();
            shared.sort_by_key(|s| s.0);
            let shared: Vec<(usize, f64)> =
                shared.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, same.iter().map(|s| s.1).sum())).collect();
            let (bone, onto) = (self.bones[joint], self.bones[self.parent(joint)?]);
            let above = skeleton.ancestors(bone).find(|&ancestor| skeleton.ancestors(onto).any(|other| other == ancestor));
            HungJoint::new(self, joint, Blend::new(&skin[joint]), &shared, above)
        };
        is_hung.iter().filter_map(hung_joint).collect()
    }

    /// `shortest`: less is no direction.
    fn find_directions(&mut self, masses: &[f64], moments: &[DVec3], shortest: f64) {
        let long = |v: DVec3| (v.length() > shortest).then_some(v);
        let mut below: Vec<f64> = self.bones.iter().map(|&bone| masses[bone as usize]).collect();
        for joint in (0..self.len()).rev() {
            if let Some(parent) = self.parent(joint) {
                below[parent] += below[joint];
            }
        }
        let (children, members) = (self.children(), self.members());
        for joint in 0..self.len() {
            let head = self.heads[joint];
            let mut above = self.parent(joint);
            let mut along = None;
            while let (None, Some(ancestor)) = (along, above) {
                along = long(head - self.heads[ancestor]);
                above = self.parent(ancestor);
            }
            self.along_parent.push(along);
            let mut reach = DVec3::ZERO;
            let mut mass = 0.0;
            let own = &members[joint];
            for &child in own.iter().flat_map(|&j| &children[j]).filter(|child| !own.contains(child)) {
                reach += (self.heads[child] - head) * below[child];
                mass += below[child];
            }
            let to_children = if mass > 0.0 { long(reach / mass) } else { None };
            let bones = || own.iter().map(|&j| self.bones[j] as usize);
            let mass: f64 = bones().map(|bone| masses[bone]).sum();
            let middle = bones().map(|bone| moments[bone]).sum::<DVec3>() / mass;
            self.along_own.push(to_children.or_else(|| long(middle - head)));
        }
    }

    pub fn len(&self) -> usize {
        self.bones.len()
    }

    /// Index of the world.
    pub fn world(&self) -> usize {
        self.bones.len()
    }

    pub fn parent(&self, joint: usize) -> Option<usize> {
        let parent = self.parents[joint] as usize;
        (parent < self.len()).then_some(parent)
    }

    /// Joints from `joint` upwards, without the world.
    pub fn chain(&self, joint: usize) -> impl Iterator<Item = usize> {
        std::iter::successors((joint < self.len()).then_some(joint), |&j| self.parent(j))
    }

    /// Joints directly below each joint.
    pub fn children(&self) -> Vec<Vec<usize>> {
        let mut children = vec![Vec::new(); self.len()];
        for joint in 0..self.len() {
            if let Some(parent) = self.parent(joint) {
                children[parent].push(joint);
            }
        }
        children
    }

    /// Joints of the body that each joint is the first of; of the others, themselves.
    fn members(&self) -> Vec<Vec<usize>> {
        let mut members: Vec<Vec<usize>> = (0..self.len()).map(|joint| vec![joint]).collect();
        for (joint, &body) in self.bodies.iter().enumerate().filter(|(joint, body)| *joint != usize::from(**body)) {
            members[usize::from(body)].push(joint);
        }
        members
    }

    /// Joints in whose vicinity skin of each joint's bone lies: the first of its body, of the body above and of those below;
    /// and of segments, its own and its neighbours'. Of the world: those that hang on nothing.
    pub fn vicinities(&self) -> Csr<usize> {
        let (children, members) = (self.children(), self.members());
        let mut vicinities = Csr::default();
        for joint in 0..self.len() {
            let body = usize::from(self.bodies[joint]);
            let within = |j: &usize| usize::from(self.bodies[*j]) == body;
            let above = self.parent(body).map(|parent| usize::from(self.bodies[parent]));
            let below = members[body].iter().flat_map(|&member| &children[member]).copied().filter(|child| !within(child));
            let beside = self.parent(joint).into_iter().chain(children[joint].iter().copied()).filter(within);
            let mut row: Vec<usize> = [joint, body].into_iter().chain(above).chain(below).chain(beside).collect();
            row.sort_unstable();
            row.dedup();
            vicinities.push_row(row);
        }
        vicinities.push_row((0..self.len()).filter(|&j| self.parent(j).is_none()));
        vicinities
    }

    /// Nearest joint (or the world) that both are below.
    pub fn common_ancestor(&self, a: usize, b: usize) -> usize {
        let (mut a, mut b) = (a, b);
        while a != b {
            if a == self.world() || b == self.world() {
                return self.world();
            }
            if a > b {
                a = self.parents[a] as usize;
            } else {
                b = self.parents[b] as usize;
            }
        }
        a
    }
}

/// Diagonal of the box around all vertices.
fn size_of(rest: &[DVec3]) -> f64 {
    let low = rest.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = rest.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    if rest.is_empty() { 0.0 } else { (high - low).length() }
}
