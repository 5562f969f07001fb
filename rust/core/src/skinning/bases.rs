//! Shells that lie below a joint without holding any of its skin, such as a belt on two thighs.
//!
//! What moves such a shell as a whole says nothing about it, however it came about: by a bone without skin, or by bones
//! that are shifted and stretched alike. Its joints are told against a *base* that moves with the shell, not against
//! that joint.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DVec3};

use crate::numeric::csr::Csr;
use crate::skinning::blend::Influences;
use crate::skinning::joint_tree::JointTree;
use crate::skinning::skeleton::Skeleton;
use crate::surface::topology::Topology;

/// One shell that moves against a base.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub component: u32,
    /// The joint above all that move the shell, or the world.
    pub top: usize,
    /// Bone without skin that carries the shell below `top`, or beside it where chains are cut.
    pub carrier: Option<u32>,
    /// Joints right below `top`, and the parts of the skin that hang on them.
    pub members: Vec<(usize, f64)>,
    /// Place of its motions: the base's, the carrier's, that without its turn, then each member's without turns.
    pub first_motion: usize,
}

impl Base {
    pub fn motion_count(&self) -> usize {
        3 + self.members.len()
    }

    pub fn member(&self, joint: usize) -> Option<usize> {
        self.members.iter().position(|member| member.0 == joint)
    }
}

/// Bases of all shells that have one. `bones_of_point`: joints that move each point; `areas`: per vertex.
pub(crate) fn bases(
    topology: &Topology,
    tree: &JointTree,
    skeleton: &Skeleton,
    influences: &Influences,
    bones_of_point: &Csr<u16>,
    tops: &[u32],
    areas: &[f64],
) -> Vec<Base> {
    let mut top_of: Vec<Option<usize>> = vec![None; topology.components.len()];
    for (&component, &top) in topology.component_of_face.iter().zip(tops) {
        let of = &mut top_of[component as usize];
        *of = Some(of.map_or(top as usize, |other| tree.common_ancestor(other, top as usize)));
    }
    for (face, &component) in topology.faces.rows().zip(&topology.component_of_face) {
        let of = &mut top_of[component as usize];
        let holds = |top: usize| face.iter().any(|&p| bones_of_point.row(p as usize).iter().any(|&b| usize::from(b) == top));
        *of = of.filter(|&top| !holds(top));
    }
    let mut shares: BTreeMap<(u32, usize), f64> = BTreeMap::new();
    for (vertex, &point) in topology.point_of_vertex.iter().enumerate() {
        let component = topology.component_of_point[point as usize];
        let Some(&Some(top)) = top_of.get(component as usize) else { continue };
        let (joints, weights) = influences.of(vertex);
        for (&joint, &weight) in joints.iter().zip(weights) {
            if let Some(member) = tree.chain(usize::from(joint)).take_while(|&j| j != top).last() {
                *shares.entry((component, member)).or_default() += weight * areas[vertex];
            }
        }
    }
    let shares: Vec<((u32, usize), f64)> = shares.into_iter().collect();
    let mut first_motion = 2 * tree.len() + 1;
    let mut result = Vec::new();
    for group in shares.chunk_by(|a, b| a.0.0 == b.0.0).filter(|group| group.len() > 1) {
        let component = group[0].0.0;
        let Some(top) = top_of[component as usize] else { continue };
        let whole: f64 = group.iter().map(|g| g.1).sum();
        if whole > 0.0 {
            let members: Vec<(usize, f64)> = group.iter().map(|g| (g.0.1, g.1 / whole)).collect();
            let base = Base { component, top, carrier: carrier(tree, skeleton, top, &members), members, first_motion };
            first_motion += base.motion_count();
            result.push(base);
        }
    }
    result
}

/// The bone nearest above all members, unless it is above the joint that they hang on.
fn carrier(tree: &JointTree, skeleton: &Skeleton, top: usize, members: &[(usize, f64)]) -> Option<u32> {
    let mut bones = members.iter().map(|member| tree.bones[member.0]);
    let first = bones.next()?;
    let is_above = |ancestor: u32, bone: u32| skeleton.ancestors(bone).any(|other| other == ancestor);
    let nearest = skeleton.ancestors(first).find(|&ancestor| bones.clone().all(|bone| is_above(ancestor, bone)))?;
    let top = tree.bones.get(top).copied();
    (!top.is_some_and(|top| top == nearest || is_above(nearest, top))).then_some(nearest)
}

/// Mean of affine maps by parts that sum to 1.
pub(super) fn mean(maps: impl Iterator<Item = (f64, DAffine3)>) -> DAffine3 {
    let none = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
    maps.fold(none, |sum, (part, map)| DAffine3 {
        matrix3: sum.matrix3 + map.matrix3 * part,
        translation: sum.translation + map.translation * part,
    })
}
