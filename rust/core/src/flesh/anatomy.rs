//! What is bound: limbs, and which points each may move.

use glam::{DAffine3, DVec3};

use super::bend::{NEAR_MAX, REACH};
use super::limb::Limb;
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

/// One joint whose bend may move a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    pub joint: u16,
    /// As in a node.
    pub share: [f32; 2],
    /// 1 less the weight of bones that are neither above nor below the joint.
    pub kin: f32,
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
}

/// A body as the law of flesh sees it.
#[derive(Debug)]
pub(crate) struct Anatomy {
    pub(super) limbs: Vec<Option<Limb>>,
    /// Per slot, joints above before those below.
    pub(super) nodes: Csr<Node>,
    /// Per slot, the joint that the nodes of a row hang on, or the world.
    pub(super) tops: Vec<u16>,
    pub(super) near: Csr<Near>,
    /// Per patch, all joints of its rows.
    pub(super) joints_of_patch: Csr<u16>,
}

impl Anatomy {
    pub fn new(parts: &Parts) -> Self {
        let Parts { patches, sites, tree, rest, places, areas } = *parts;
        let count = tree.len();
        let slots: Vec<usize> = patches.list.iter().flat_map(|patch| patch.start..patch.start + patch.owned).collect();
        let under: Vec<Vec<(usize, f64, f64)>> = (0..places.len()).map(|slot| hanging(sites, tree, slot)).collect();
        let mut held = vec![0.0; count];
        let mut skin: Vec<Vec<(DVec3, f64)>> = vec![Vec::new(); count];
        for &slot in &slots {
            for &(joint, _, part) in &under[slot] {
                held[joint] += part * areas[slot];
                let blend = 4.0 * part * (1.0 - part) * areas[slot];
                if part < WHOLE && blend > 0.0 {
                    skin[joint].push((places[slot], blend));
                }
            }
        }
        let limbs: Vec<Option<Limb>> = (0..count).map(|joint| Limb::new(tree, joint, &rest[joint], &held, &skin[joint])).collect();
        let reaches: Vec<f64> =
            limbs.iter().map(|limb| limb.as_ref().map_or(0.0, |l| NEAR_MAX * l.reach_max() + REACH * l.radius)).collect();
        let mut result = Self { limbs, nodes: Csr::default(), tops: Vec::new(), near: Csr::default(), joints_of_patch: Csr::default() };
        let mut joints: Vec<u16> = Vec::new();
        for (index, patch) in patches.list.iter().enumerate() {
            joints.clear();
            let slots = patch.start..patches.slot_offsets[index + 1] as usize;
            for slot in slots {
                let is_owned = slot < patch.start + patch.owned;
                let (top, nodes) = if is_owned { result.nodes_of(tree, places[slot], &under[slot]) } else { (tree.world(), Vec::new()) };
                let near = if is_owned { result.near_of(tree, &reaches, places[slot], &under[slot]) } else { Vec::new() };
                joints.extend(nodes.iter().map(|node| node.joint).chain(near.iter().map(|near| near.joint)));
                result.tops.push(top as u16);
                result.nodes.push_row(nodes);
                result.near.push_row(near);
            }
            joints.sort_unstable();
            joints.dedup();
            result.joints_of_patch.push_row(joints.iter().copied());
        }
        result
    }

    pub fn memory_bytes(&self) -> usize {
        self.nodes.memory_bytes() + self.near.memory_bytes() + self.joints_of_patch.memory_bytes() + size_of_val(&*self.tops)
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

    /// Joints whose bends may reach a point.
    fn near_of(&self, tree: &JointTree, reaches: &[f64], place: DVec3, under: &[(usize, f64, f64)]) -> Vec<Near> {
        let limbs = self.limbs.iter().enumerate().filter_map(|(joint, limb)| Some((joint, limb.as_ref()?)));
        let close = limbs.filter(|(joint, limb)| place.distance_squared(limb.middle) < reaches[*joint].powi(2));
        let near = close.filter_map(|(joint, limb)| {
            let part_of = |joint: usize| under.iter().find(|u| u.0 == joint).map_or(0.0, |u| u.2);
            let own_of = |joint: usize| under.iter().find(|u| u.0 == joint).map_or(0.0, |u| u.1);
            let part = part_of(joint);
            let above: f64 = tree.chain(usize::from(tree.parents[joint])).map(own_of).sum();
            let kin = (part + above).min(1.0);
            let parent = part_of(usize::from(tree.parents[joint]));
            let relative = if parent > 0.0 { (part / parent).min(1.0) } else { part };
            let share = [relative as f32, limb.share_along(place, relative) as f32];
            (kin > 1.0 - WHOLE).then_some(Near { joint: joint as u16, share, kin: kin as f32 })
        });
        near.collect()
    }
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
