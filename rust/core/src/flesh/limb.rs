//! What a joint is at rest, as flesh sees it: the limb through it, and the section of skin that blends there.

use glam::{DAffine3, DVec3};

use super::smoothstep;
use crate::skinning::joint_tree::JointTree;

/// Bones whose directions have a cosine above this run on into each other.
const RUNS_ON: f64 = 0.3;
/// A bone's own axis is taken for the way its flesh lies up to this cosine.
const AXIS_NEAR: f64 = 0.5;
/// The joint below that holds this part of all that hangs on a bone is where the bone leads.
const LEADS: f64 = 0.6;
/// A bone this many times as long as thick begins to take a twist along itself, one longer by as much takes all of it.
const SLENDER: f64 = 1.0;

/// A joint at rest, armature space.
#[derive(Debug, Clone)]
pub(super) struct Limb {
    pub head: DVec3,
    /// Axis of twists: unit vector along the bone.
    pub axis: DVec3,
    /// To where the bone leads; `None` where it leads nowhere.
    pub length: Option<f64>,
    /// Part of a twist that the bone takes along itself, if it is spread.
    pub slender: f64,
    /// Unit vector along the limb at the joint.
    pub along: DVec3,
    /// Whether the bone above runs on into this one: such a limb folds.
    pub runs_on: bool,
    /// Middle and mean radius of the skin that blends.
    pub middle: DVec3,
    pub radius: f64,
    /// Of that skin, from the middle, with its part of all: one for each point.
    pub section: Vec<(DVec3, f64)>,
}

/// Direction and end of a bone.
struct Lead {
    axis: DVec3,
    length: Option<f64>,
}

impl Lead {
    /// `held`: skin that hangs on each joint.
    fn new(tree: &JointTree, joint: usize, rest: &DAffine3, held: &[f64]) -> Option<Self> {
        let head = tree.heads[joint];
        let own = tree.along_own[joint]?.try_normalize()?;
        let body = tree.bodies[joint];
        let is_below = |&other: &usize| {
            let parent = tree.parent(other);
            tree.bodies[other] != body && parent.is_some_and(|parent| tree.bodies[parent] == body)
        };
        let below: Vec<usize> = (joint + 1..usize::from(tree.ends[joint])).filter(is_below).collect();
        let whole: f64 = below.iter().map(|&other| held[other]).sum();
        let leads = below.iter().copied().find(|&other| held[other] >= LEADS * whole);
        if let Some((axis, length)) = leads.and_then(|other| {
            let way = tree.heads[other] - head;
            Some((way.try_normalize()?, way.length()))
        }) {
            return Some(Self { axis, length: Some(length) });
        }
        let of_bone = rest.matrix3.y_axis.normalize_or_zero();
        Some(Self { axis: if of_bone.dot(own) >= AXIS_NEAR { of_bone } else { own }, length: None })
    }
}

impl Limb {
    /// `skin`: places that blend at the joint, with 4 D (1 − D) times their area, D the weight of all that hangs on the joint.
    ///
    /// `None` where there is no limb to speak of: at a root, a segment, where nothing blends, at a bone without extent.
    pub fn new(tree: &JointTree, joint: usize, rest: &DAffine3, held: &[f64], skin: &[(DVec3, f64)]) -> Option<Self> {
        tree.parent(joint)?;
        if usize::from(tree.bodies[joint]) != joint {
            return None;
        }
        let mass: f64 = skin.iter().map(|s| s.1).sum();
        if mass <= 0.0 || !mass.is_finite() {
            return None;
        }
        let Lead { axis, length } = Lead::new(tree, joint, rest, held)?;
        let above = tree.along_parent[joint].and_then(DVec3::try_normalize);
        let above = above.filter(|above| above.dot(axis) > RUNS_ON);
        let along = above.map_or(axis, |above| (above + axis).normalize());
        let middle = skin.iter().map(|&(p, weight)| p * weight).sum::<DVec3>() / mass;
        let section: Vec<(DVec3, f64)> = skin.iter().map(|&(p, weight)| (p - middle, weight / mass)).collect();
        let radius = section.iter().map(|(p, part)| p.reject_from_normalized(along).length_squared() * part).sum::<f64>().sqrt();
        let is_sound = radius > 0.0 && radius.recip().is_finite();
        let slender = length.map_or(0.0, |length| smoothstep((length / radius - SLENDER) / SLENDER));
        let head = tree.heads[joint];
        is_sound.then_some(Self { head, axis, length, slender, along, runs_on: above.is_some(), middle, radius, section })
    }

    /// How far the section reaches to one side, root of mean squares: its radius where it is round.
    pub fn reach(&self, side: DVec3) -> f64 {
        2.0 * self.section.iter().map(|(p, part)| part * p.dot(side).max(0.0).powi(2)).sum::<f64>().sqrt()
    }

    /// Farthest that any side of the section reaches, at most.
    pub fn reach_max(&self) -> f64 {
        2.0 * self.section.iter().map(|(p, part)| part * p.length_squared()).sum::<f64>().sqrt()
    }

    /// Part of a twist spread along the bone that a place takes; `part`: of the skin there hangs on the joint.
    pub fn share_along(&self, place: DVec3, part: f64) -> f64 {
        let Some(length) = self.length else { return part };
        ((place - self.head).dot(self.axis) / length).clamp(0.0, 1.0) * smoothstep(2.0 * part)
    }
}
