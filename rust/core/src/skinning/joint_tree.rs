//! The joints that a mesh makes of bones: those that carry weight, in a tree, parents first.

use glam::DVec3;

use crate::numeric::csr::Csr;
use crate::skinning::cut_chains::{Hanging, Weighted};

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
    /// From this joint along its own bone group at rest; `None` where it has no extent.
    pub along_own: Vec<Option<DVec3>>,
    /// Joints of cut chains, which hang on a bone that is not above them.
    pub is_hung: Vec<bool>,
    /// First joint of each joint's bone group: itself, but for segments.
    pub bone_groups: Vec<u16>,
    /// Per bone, whether it is a segment of the one above.
    pub is_segment: Vec<bool>,
    /// Bones that carry no weight between each joint and the one above, from above, and then the joint's own.
    pub links: Csr<u32>,
}

impl JointTree {
    /// Joints of the bones that carry weight. Each hangs on its nearest weighted ancestor, else as `cut_chains` says.
    pub fn new(bones: &Weighted, hanging: &Hanging) -> Self {
        let Weighted { skeleton, masses, moments, .. } = bones;
        let Hanging { parents, is_hung, .. } = hanging;
        let world = skeleton.len();
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
            bone_groups: Vec::new(),
            is_segment: skeleton.is_segment.clone(),
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
            let above = tree.parent(usize::from(joint)).filter(|&p| skeleton.bone_group(tree.bones[p]) == skeleton.bone_group(bone));
            tree.bone_groups.push(above.map_or(joint, |p| tree.bone_groups[p]));
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
        tree.find_directions(masses, moments, bones.size * DIRECTION_MIN);
        tree
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
        for (joint, own) in members.iter().enumerate() {
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

    /// Joints of the bone group that each joint is the first of; of the others, themselves.
    fn members(&self) -> Vec<Vec<usize>> {
        let mut members: Vec<Vec<usize>> = (0..self.len()).map(|joint| vec![joint]).collect();
        for (joint, &group) in self.bone_groups.iter().enumerate().filter(|(joint, group)| *joint != usize::from(**group)) {
            members[usize::from(group)].push(joint);
        }
        members
    }

    /// Joints in whose vicinity skin of each joint's bone lies: the first of its bone group, of the one above and of those below;
    /// and of segments, its own and its neighbours'. Of the world: those that hang on nothing.
    pub fn vicinities(&self) -> Csr<usize> {
        let (children, members) = (self.children(), self.members());
        let mut vicinities = Csr::default();
        for joint in 0..self.len() {
            let group = usize::from(self.bone_groups[joint]);
            let within = |j: &usize| usize::from(self.bone_groups[*j]) == group;
            let above = self.parent(group).map(|parent| usize::from(self.bone_groups[parent]));
            let below = members[group].iter().flat_map(|&member| &children[member]).copied().filter(|child| !within(child));
            let beside = self.parent(joint).into_iter().chain(children[joint].iter().copied()).filter(within);
            let mut row: Vec<usize> = [joint, group].into_iter().chain(above).chain(below).chain(beside).collect();
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
