//! Whether the bone above a joint is what its skin blends with: the law of flesh tells the joint's turn against that bone.
//!
//! In a flat skeleton, or where a control carries a foot, the skin of a joint blends with bones that are not above it. As long as
//! those move like the bone above, the law holds; as they part from it, it fades.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};

use super::smoothstep;
use crate::skinning::joint_tree::JointTree;
use crate::skinning::moments::Moments;

/// A bone that is less than this part as far, squared, from the bone above as the joint is begins to count as like it.
const LIKENESS: f64 = 0.25;
/// Part of a joint's blends, with the bone above or what moves like it, at which the law begins to hold, and holds in full.
const TRUST: [f64; 2] = [0.3, 0.7];
/// A bone with less than this part of a joint's blends is not looked at.
const SHARE_MIN: f64 = 0.02;

/// What a joint's skin blends with besides the bone above.
#[derive(Debug, Clone, Default)]
pub(super) struct Neighbours {
    /// Part of the blends that is the bone's above.
    above: f64,
    /// Joints that are neither above nor below, their parts, and the skin shared with them.
    others: Vec<(u16, f64, Moments)>,
}

/// Blends of a joint, by the joint they are with, as they are collected.
pub(super) type Blends = BTreeMap<usize, Vec<(f64, DVec3)>>;

impl Neighbours {
    pub fn new(tree: &JointTree, joint: usize, blends: &Blends) -> Self {
        let amount = |skin: &[(f64, DVec3)]| skin.iter().map(|s| s.0).sum::<f64>();
        let whole: f64 = blends.values().map(|skin| amount(skin)).sum();
        let mut result = Self { above: 0.0, others: Vec::new() };
        for (&other, skin) in blends {
            let part = amount(skin) / whole;
            if Some(other) == tree.parent(joint) || part.is_nan() || part < SHARE_MIN {
                result.above += if part.is_nan() { 0.0 } else { part };
            } else {
                result.others.push((other as u16, part, Moments::new(skin)));
            }
        }
        result
    }

    /// How far the law holds in a pose, 0..1. `channels`: pose · rest⁻¹ per joint.
    pub fn trust(&self, channels: &[DAffine3], joint: usize, above: &DAffine3) -> f64 {
        if self.others.is_empty() {
            return 1.0;
        }
        let like = |(other, part, skin): &(u16, f64, Moments)| {
            let apart = skin.apart(&channels[usize::from(*other)], above) / (LIKENESS * skin.apart(&channels[joint], above));
            // No number where nothing moves against anything.
            part * (1.0 - if apart.is_nan() { 0.0 } else { smoothstep(apart) })
        };
        let share = self.above + self.others.iter().map(like).sum::<f64>();
        smoothstep((share - TRUST[0]) / (TRUST[1] - TRUST[0]))
    }
}
