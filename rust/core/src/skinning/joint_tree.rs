//! The joints that a mesh makes of bones: those that carry weight, in a tree, parents first.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::numeric::csr::Csr;
use crate::skinning::blend::Influences;
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
    /// Joints that hang where their skin blends, not on a bone above them.
    pub is_hung: Vec<bool>,
    /// First joint of each joint's body: itself, but for segments.
    pub bodies: Vec<u16>,
    /// Per bone, whether it is a segment of the one above.
    pub is_segment: Vec<bool>,
    /// Bones that carry no weight between each joint and the one above, from above, and then the joint's own.
    pub links: Csr<u32>,
}

impl JointTree {
    /// Joints of the bones that carry weight. `rest` are the vertices in armature space, with their `areas`.
    ///
    /// A weighted bone hangs on its nearest weighted ancestor. One that has none (control rigs cut such chains) hangs on
    /// the bone with which it shares most weight, so that its joint is found where the skin blends.
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
        let (parents, is_hung) = weighted_parents(skeleton, influences, &masses, rest, areas);
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
            links: Csr::default(),
        };
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
            let between = std::iter::successors(skeleton.parents[bone as usize], |&b| skeleton.parents[b as usize]);
            let has_above = parents[bone as usize].is_some() && !is_hung[bone as usize];
            let mut links: Vec<u32> = between.take_while(|&b| has_above && masses[b as usize] <= 0.0).collect();
            links.reverse();
            tree.links.push_row(links.into_iter().chain([bone]));
            stack.extend(children[bone as usize].iter().rev().map(|&child| (child, joint)));
        }
        for joint in (0..tree.len()).rev() {
            if let Some(parent) = tree.parent(joint) {
                tree.ends[parent] = tree.ends[parent].max(tree.ends[joint]);
            }
        }
        tree.find_directions(&masses, &moments, rest);
        tree
    }

    fn find_directions(&mut self, masses: &[f64], moments: &[DVec3], rest: &[DVec3]) {
        let low = rest.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = rest.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let shortest = if rest.is_empty() { 0.0 } else { (high - low).length() * DIRECTION_MIN };
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

/// Skin that two bones share: how much, and its moment.
type Shared = (f64, DVec3);

/// Nearest weighted ancestor of each weighted bone, else the bone that it blends with most; and which bones are the latter.
fn weighted_parents(
    skeleton: &Skeleton,
    influences: &Influences,
    masses: &[f64],
    rest: &[DVec3],
    areas: &[f64],
) -> (Vec<Option<u32>>, Vec<bool>) {
    let mut parents: Vec<Option<u32>> = (0..skeleton.len())
        .map(|bone| {
            let mut parent = skeleton.parents[bone];
            while let Some(p) = parent.filter(|&p| masses[p as usize] <= 0.0) {
                parent = skeleton.parents[p as usize];
            }
            parent
        })
        .collect();
    let mut is_hung = vec![false; skeleton.len()];
    let roots: Vec<u32> = (0..skeleton.len() as u32).filter(|&b| masses[b as usize] > 0.0 && parents[b as usize].is_none()).collect();
    if roots.len() < 2 {
        return (parents, is_hung);
    }
    let top = |bone: u32| std::iter::successors(Some(bone), |&b| parents[b as usize]).last().unwrap_or(bone);
    let mut root_of: Vec<u32> = (0..skeleton.len() as u32).map(top).collect();
    let mut shared: BTreeMap<(u32, u32), Shared> = BTreeMap::new();
    for (vertex, (&p, area)) in rest.iter().zip(areas).enumerate() {
        let (bones, weights) = influences.of(vertex);
        for (&a, &of_a) in bones.iter().zip(weights) {
            for (&b, &of_b) in bones.iter().zip(weights) {
                let apart = usize::from(a) != skeleton.len() && usize::from(b) != skeleton.len();
                if apart && root_of[usize::from(a)] != root_of[usize::from(b)] {
                    let sum = shared.entry((u32::from(a), u32::from(b))).or_default();
                    let amount = of_a * of_b * area;
                    *sum = (sum.0 + amount, sum.1 + p * amount);
                }
            }
        }
    }
    let mut pairs: Vec<((u32, u32), Shared)> = shared.into_iter().filter(|(_, (amount, _))| *amount > 0.0).collect();
    pairs.sort_by(|a, b| b.1.0.total_cmp(&a.1.0).then(a.0.cmp(&b.0)));
    // Strongest blend first. A joint is where its skin blends: only a root is hung by its own skin, and of two roots the
    // one whose head is nearer to it. Trees that blend by other bones alone come last.
    for _ in 1..roots.len() {
        let joined = |by_own_skin: bool| {
            pairs.iter().find_map(|&((a, b), (amount, moment))| {
                let (root_a, root_b) = (root_of[a as usize], root_of[b as usize]);
                let distance = |bone: u32| skeleton.head(bone).distance_squared(moment / amount);
                let is_nearer = distance(root_a) <= distance(root_b);
                let hangs = if by_own_skin { a == root_a && (b != root_b || is_nearer) } else { is_nearer };
                (root_a != root_b && hangs).then_some((root_a, b))
            })
        };
        let Some((root, onto)) = joined(true).or_else(|| joined(false)) else { break };
        let top = root_of[onto as usize];
        root_of.iter_mut().filter(|of| **of == root).for_each(|of| *of = top);
        // What is of one tree stays of one.
        pairs.retain(|&((a, b), _)| root_of[a as usize] != root_of[b as usize]);
        parents[root as usize] = Some(onto);
        is_hung[root as usize] = true;
    }
    (parents, is_hung)
}
