//! What is bound: limbs, and which points each may move.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec3};

use super::limb::{Limb, NEAR_MAX, REACH};
use super::neighbours::{Blends, Neighbours};
use crate::numeric::block_rows::{Block, LANES};
use crate::numeric::csr::Csr;
use crate::skinning::joint_tree::JointTree;
use crate::skinning::sites::Sites;
use crate::surface::patches::Patches;

/// A point that hangs on more joints than this is left alone by twists.
pub(super) const NODES_MAX: usize = 16;
/// Of the whole, or nothing: weights are sums of such as are stored in single precision.
const WHOLE: f64 = 1.0 - 1e-6;

/// One joint that a point hangs on: parts of the point's weight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub joint: u16,
    /// Place, in the row of the point, of the node above; `NODES_MAX` for the joint on which all of them hang.
    pub above: u16,
    /// Of the bone itself, and of all that hangs on the joint.
    pub own: f32,
    pub under: f32,
    /// Part of the joint's twist by the blend, and spread along the bone.
    pub share: [f32; 2],
}

/// Eight points that a joint's bend may move; 0 for others.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearBlock {
    pub joint: u16,
    /// 1 less the weight of bones that are neither above nor below the joint.
    pub kin: Block<f32>,
    /// As in a node.
    pub shares: [Block<f32>; 2],
}

/// Eight points that hang on a joint of a chain; 0 for others.
#[derive(Debug, Clone, Copy)]
pub(super) struct ChainBlock {
    pub joint: u16,
    /// Weight of the bone above, and of all that hangs on the joint; the latter's part of their sum.
    pub above: Block<f32>,
    pub under: Block<f32>,
    pub part: Block<f32>,
    /// As in a node.
    pub shares: [Block<f32>; 2],
}

/// What limbs are made from.
pub(crate) struct Parts<'a> {
    pub patches: &'a Patches,
    pub sites: &'a Sites,
    pub tree: &'a JointTree,
    /// Rest matrix of each joint's bone.
    pub rest: &'a [DAffine3],
    /// Per slot, armature space.
    pub places: &'a [DVec3],
    pub areas: &'a [f64],
    /// Whether bones are blended linearly.
    pub is_linear: bool,
}

/// A body as the law of flesh sees it.
#[derive(Debug)]
pub(crate) struct Anatomy {
    pub(super) limbs: Vec<Option<Limb>>,
    pub(super) neighbours: Vec<Neighbours>,
    /// Per slot, joints above before those below.
    pub(super) nodes: Csr<Node>,
    /// Per slot, the joint that the nodes of a row hang on, or the world.
    pub(super) tops: Vec<u16>,
    /// Bends, per eight slots.
    pub(super) near: Csr<NearBlock>,
    /// Per eight slots, joints below before those above: points whose nodes hang on each other one by one, where skinning is
    /// linear. They have no nodes.
    pub(super) chains: Csr<ChainBlock>,
    /// Per patch, joints that may move any of its points.
    pub(super) joints_of_patch: Csr<u16>,
}

impl Anatomy {
    pub fn new(parts: &Parts) -> Self {
        let Parts { patches, sites, tree, rest, places, areas, is_linear } = *parts;
        let count = tree.len();
        let slots: Vec<usize> = patches.list.iter().flat_map(|patch| patch.start..patch.start + patch.owned).collect();
        let under: Vec<Vec<(usize, f64, f64)>> = (0..places.len()).map(|slot| hanging(sites, tree, slot)).collect();
        let mut held = vec![0.0; count];
        let mut skin: Vec<Vec<(DVec3, f64)>> = vec![Vec::new(); count];
        let mut blends = vec![Blends::new(); count];
        for &slot in &slots {
            for &(joint, _, part) in &under[slot] {
                held[joint] += part * areas[slot];
                let blend = 4.0 * part * (1.0 - part) * areas[slot];
                if part < WHOLE && blend > 0.0 {
                    skin[joint].push((places[slot], blend));
                    let below = joint..usize::from(tree.ends[joint]);
                    for &(other, own, _) in under[slot].iter().filter(|(other, own, _)| *own > 0.0 && !below.contains(other)) {
                        blends[joint].entry(other).or_default().push((part * own * areas[slot], places[slot]));
                    }
                }
            }
        }
        let limbs: Vec<Option<Limb>> = (0..count).map(|joint| Limb::new(tree, joint, &rest[joint], &held, &skin[joint])).collect();
        let neighbours = (0..count).map(|joint| Neighbours::new(tree, joint, &blends[joint])).collect();
        let reaches: Vec<f64> = limbs
            .iter()
            .map(|limb| limb.as_ref().map_or(0.0, |l| (NEAR_MAX * l.reach_max).hypot(REACH * l.radius) + l.head.distance(l.middle)))
            .collect();
        let mut result = Self {
            limbs,
            neighbours,
            nodes: Csr::default(),
            tops: Vec::new(),
            near: Csr::default(),
            chains: Csr::default(),
            joints_of_patch: Csr::default(),
        };
        for (index, patch) in patches.list.iter().enumerate() {
            let mut joints: BTreeSet<u16> = BTreeSet::new();
            for first in (patch.start..patches.slot_offsets[index + 1] as usize).step_by(LANES) {
                let (mut near, mut chains): (BTreeMap<u16, NearBlock>, BTreeMap<u16, ChainBlock>) = Default::default();
                for (lane, slot) in (first..first + LANES).enumerate() {
                    if slot >= patch.start + patch.owned {
                        result.tops.push(tree.world() as u16);
                        result.nodes.push_row([]);
                        continue;
                    }
                    let (top, mut nodes) = result.nodes_of(tree, places[slot], &under[slot]);
                    if is_linear && is_chain(tree, top, &nodes) {
                        let mut above = 1.0;
                        for node in nodes.drain(..) {
                            chains.entry(node.joint).or_insert_with(|| ChainBlock::new(node.joint)).set(lane, &node, above);
                            above = node.under;
                        }
                    }
                    joints.extend(nodes.iter().map(|node| node.joint));
                    result.tops.push(top as u16);
                    result.nodes.push_row(nodes);
                    for (joint, kin, shares) in result.near_of(tree, &reaches, places[slot], &under[slot]) {
                        near.entry(joint).or_insert_with(|| NearBlock::new(joint)).set(lane, kin, shares);
                    }
                }
                joints.extend(near.keys().chain(chains.keys()));
                result.near.push_row(near.into_values());
                result.chains.push_row(chains.into_values().rev());
            }
            result.joints_of_patch.push_row(joints);
        }
        result
    }

    pub fn memory_bytes(&self) -> usize {
        self.nodes.memory_bytes()
            + self.near.memory_bytes()
            + self.chains.memory_bytes()
            + self.joints_of_patch.memory_bytes()
            + size_of_val(&*self.tops)
    }

    /// Joints whose twists a point may feel, and the one on which they hang.
    fn nodes_of(&self, tree: &JointTree, place: DVec3, under: &[(usize, f64, f64)]) -> (usize, Vec<Node>) {
        let share = |joint: usize, part: f64, above: f64| {
            let part = if above > 0.0 { (part / above).min(1.0) } else { part };
            let along = self.limbs[joint].as_ref().map_or(part, |limb| limb.share_along(place, part));
            [part as f32, along as f32]
        };
        // What hangs on a joint as a whole and takes all of its twist need not be looked at.
        let is_carried = |&&(joint, _, part): &&(usize, f64, f64)| part >= WHOLE && share(joint, part, 1.0) == [1.0, 1.0];
        let carried = under.iter().take_while(is_carried).count();
        let is_felt = under[carried..].iter().any(|&(joint, _, _)| self.limbs[joint].is_some());
        if !is_felt || under.len() - carried > NODES_MAX {
            return (tree.world(), Vec::new());
        }
        let top = if carried > 0 { under[carried - 1].0 } else { tree.world() };
        let mut nodes: Vec<Node> = Vec::new();
        for &(joint, own, part) in &under[carried..] {
            let place_above = nodes.iter().position(|node| Some(usize::from(node.joint)) == tree.parent(joint));
            let above = place_above.map_or(1.0, |place| f64::from(nodes[place].under));
            nodes.push(Node {
                joint: joint as u16,
                above: place_above.unwrap_or(NODES_MAX) as u16,
                own: own as f32,
                under: part as f32,
                share: share(joint, part, above),
            });
        }
        (top, nodes)
    }

    /// Joints whose bends may reach a point, how much of it is theirs, and its shares of their twists.
    fn near_of(&self, tree: &JointTree, reaches: &[f64], place: DVec3, under: &[(usize, f64, f64)]) -> Vec<(u16, f32, [f32; 2])> {
        let limbs = self.limbs.iter().enumerate().filter_map(|(joint, limb)| Some((joint, limb.as_ref()?)));
        let close =
            limbs.filter(|(joint, limb)| place.distance_squared(limb.head) < reaches[*joint].powi(2) && limb.may_reach(place, REACH));
        let near = close.filter_map(|(joint, limb)| {
            let find = |joint: usize| under.iter().find(|u| u.0 == joint).map_or((0.0, 0.0), |u| (u.1, u.2));
            let above: f64 = tree.chain(usize::from(tree.parents[joint])).map(|joint| find(joint).0).sum();
            let (part, parent) = (find(joint).1, find(usize::from(tree.parents[joint])).1);
            let kin = (part + above).min(1.0);
            let relative = if parent > 0.0 { (part / parent).min(1.0) } else { part };
            (kin > 1.0 - WHOLE).then(|| (joint as u16, kin as f32, [relative as f32, limb.share_along(place, relative) as f32]))
        });
        near.collect()
    }
}

impl NearBlock {
    fn new(joint: u16) -> Self {
        Self { joint, kin: [0.0; LANES], shares: [[0.0; LANES]; 2] }
    }

    fn set(&mut self, lane: usize, kin: f32, shares: [f32; 2]) {
        self.kin[lane] = kin;
        set_shares(&mut self.shares, lane, shares);
    }
}

impl ChainBlock {
    fn new(joint: u16) -> Self {
        let none = [0.0; LANES];
        Self { joint, above: none, under: none, part: none, shares: [none; 2] }
    }

    /// `above`: weight of all that hangs on the bone above.
    fn set(&mut self, lane: usize, node: &Node, above: f32) {
        self.above[lane] = (above - node.under).max(0.0);
        self.under[lane] = node.under;
        self.part[lane] = if above > 0.0 { node.under / above } else { 0.0 };
        set_shares(&mut self.shares, lane, node.share);
    }
}

fn set_shares(shares: &mut [Block<f32>; 2], lane: usize, of_point: [f32; 2]) {
    for (row, share) in shares.iter_mut().zip(of_point) {
        row[lane] = share;
    }
}

/// Whether each node is a joint on the bone of the one before, the first on the bone of `top`.
fn is_chain(tree: &JointTree, top: usize, nodes: &[Node]) -> bool {
    let above = std::iter::once(top).chain(nodes.iter().map(|node| usize::from(node.joint)));
    nodes.iter().zip(above).all(|(node, above)| usize::from(tree.parents[usize::from(node.joint)]) == above)
}

/// Joints that a point hangs on, parents first: the weight of each bone, and of all that hangs on it.
fn hanging(sites: &Sites, tree: &JointTree, slot: usize) -> Vec<(usize, f64, f64)> {
    let mut own: Vec<(usize, f64)> = Vec::new();
    for site in sites.of_slot(slot) {
        let (joints, weights) = sites.influences.of(site);
        own.extend(joints.iter().zip(weights).map(|(&joint, weight)| (usize::from(joint), weight * sites.share(site))));
    }
    let mut all: Vec<usize> = own.iter().flat_map(|&(joint, _)| tree.chain(joint)).collect();
    all.sort_unstable();
    all.dedup();
    let sum = |from: usize, to: usize| own.iter().filter(|o| (from..to).contains(&o.0)).map(|o| o.1).sum::<f64>();
    all.iter().map(|&joint| (joint, sum(joint, joint + 1), sum(joint, usize::from(tree.ends[joint])))).collect()
}
