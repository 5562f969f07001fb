//! What a joint is at rest, as flesh sees it: the limb through it, and the section of skin that blends there.

use std::f64::consts::TAU;

use glam::{DAffine3, DVec3};

use super::smoothstep;
use crate::skinning::joint_tree::JointTree;

/// Bones whose directions have a cosine above this run on into each other.
const RUNS_ON: f64 = 0.3;
/// A bone's own axis is taken for the way its flesh lies up to this cosine.
const AXIS_NEAR: f64 = 0.5;
/// The joint below that holds this part of all that hangs on a bone is where the bone leads.
const LEADS: f64 = 0.6;
/// A bone this many times as long as its skin reaches begins to take a twist along itself, one longer by as much takes all of it.
const SLENDER: f64 = 1.3;

/// Where bends end along the limb, in radii, and across it, in reaches of the section: as `bend` has them.
pub(super) const REACH: f64 = 2.55;
pub(super) const NEAR_MAX: f64 = 2.0 / 0.6;
/// Sides of a section, evenly around: between two of them its reach is told to a thousandth.
const DIRECTIONS: usize = 64;

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
    /// Farthest of that skin from the middle, across the limb, by root of mean squares to any side.
    pub reach_max: f64,
    /// Two directions across the limb, and how far the skin reaches in `DIRECTIONS` of them around.
    across: [DVec3; 2],
    reaches: Vec<f64>,
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
        let body = tree.bone_groups[joint];
        let is_below = |&other: &usize| {
            let parent = tree.parent(other);
            tree.bone_groups[other] != body && parent.is_some_and(|parent| tree.bone_groups[parent] == body)
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
        if usize::from(tree.bone_groups[joint]) != joint {
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
        // The bone's own axes, so that turning or moving all changes nothing.
        let [x, z] = [rest.matrix3.x_axis, rest.matrix3.z_axis].map(|axis| axis.reject_from_normalized(along));
        let first = if x.length_squared() > z.length_squared() { x } else { z }.normalize_or(along.any_orthonormal_vector());
        let across = [first, along.cross(first)];
        let section: Vec<([f64; 2], f64)> =
            skin.iter().map(|&(p, weight)| (across.map(|axis| (p - middle).dot(axis)), weight / mass)).collect();
        let radius = section.iter().map(|([x, y], part)| (x * x + y * y) * part).sum::<f64>().sqrt();
        let reach = |(cosine, sine): (f64, f64)| {
            2.0 * section.iter().map(|([x, y], part)| part * (x * cosine + y * sine).max(0.0).powi(2)).sum::<f64>().sqrt()
        };
        let angles = (0..DIRECTIONS).map(|step| step as f64 * (TAU / DIRECTIONS as f64));
        let reaches: Vec<f64> = angles.map(f64::sin_cos).map(|(sine, cosine)| reach((cosine, sine))).collect();
        let reach_max = reaches.iter().copied().fold(0.0, f64::max);
        let is_sound = radius > 0.0 && radius.recip().is_finite();
        let slender = length.map_or(0.0, |length| smoothstep((length / reach_max - SLENDER) / SLENDER));
        let head = tree.heads[joint];
        is_sound.then_some(Self {
            head,
            axis,
            length,
            slender,
            along,
            runs_on: above.is_some(),
            middle,
            radius,
            reach_max,
            across,
            reaches,
        })
    }

    /// How far the section reaches to one side, root of mean squares: its radius where it is round.
    pub fn reach(&self, side: DVec3) -> f64 {
        let [x, y] = self.across.map(|axis| axis.dot(side));
        let place = y.atan2(x).rem_euclid(TAU) * (DIRECTIONS as f64 / TAU);
        let (step, part) = (place as usize, place.fract());
        let at = |step: usize| self.reaches[step % DIRECTIONS];
        at(step) + (at(step + 1) - at(step)) * part
    }

    /// Part of a twist spread along the bone that a place takes; `part`: of the skin there hangs on the joint.
    pub fn share_along(&self, place: DVec3, part: f64) -> f64 {
        let Some(length) = self.length else { return part };
        ((place - self.head).dot(self.axis) / length).clamp(0.0, 1.0) * smoothstep(2.0 * part)
    }

    /// Whether a place lies within so many radii of the joint along the limb, whatever the axis of the bend.
    pub fn may_reach(&self, place: DVec3, radii: f64) -> bool {
        let from_joint = place - self.head;
        // The limb's direction in a bend is across the bend's axis, which is across the bone's.
        let lean = self.along.dot(self.axis).clamp(-1.0, 1.0).acos().sin();
        from_joint.dot(self.along).abs() <= radii * self.radius + lean * from_joint.length()
    }
}
