//! The motions of one frame, and what of them the animator means: turns cost volume, shifts and stretches move the target [MATH §3].

use glam::{DAffine3, DMat3, DVec3};

use crate::skinning::blend::{Mode, Palette};
use crate::skinning::joint_tree::JointTree;

/// Stretch and shift below this are the noise of single-precision matrices, not the animator's intent.
const INTENT_NOISE: f64 = 1e-5;
/// From here on, stretch and shift count in full.
const INTENT_FULL: f64 = 1e-4;

/// The motions of one frame: joints, the world, and joints stretched and shifted but not yet turned.
#[derive(Debug, Clone)]
pub(crate) struct Motions {
    pub tree: JointTree,
    pub palette: Palette,
    /// Joint's motion, armature space: pose · rest⁻¹.
    pub channels: Vec<DAffine3>,
    pub has_intent: Vec<bool>,
    /// Joints that do exactly what their parent does.
    pub is_still: Vec<bool>,
    rest: Vec<DAffine3>,
    /// Place of each bone at rest, armature space.
    bone_heads: Vec<DVec3>,
}

impl Motions {
    /// `rest`: rest matrix of each bone.
    pub fn new(tree: JointTree, rest: &[DAffine3], mode: Mode) -> Self {
        let count = tree.len();
        let bone_heads = rest.iter().map(|m| m.translation).collect();
        let rest = tree.bones.iter().map(|&bone| rest[bone as usize]).collect();
        Self {
            palette: Palette::new(mode, 2 * count + 1),
            channels: vec![DAffine3::IDENTITY; count + 1],
            has_intent: vec![false; count],
            is_still: vec![true; count],
            rest,
            bone_heads,
            tree,
        }
    }

    /// Index of the motion of a joint that is stretched and shifted only.
    pub fn stretched(&self, joint: usize) -> usize {
        self.tree.len() + 1 + joint
    }

    /// Where a joint goes that is shifted and stretched like itself and the bones without weight above it, but not turned.
    fn intended(&self, joint: usize, parent: &DAffine3, pose: &[DAffine3], size: f64) -> Option<DAffine3> {
        let mut above = *parent;
        let mut stretched = *parent;
        let mut is_meant = false;
        for &bone in self.tree.links.row(joint) {
            let channel = pose[bone as usize];
            if above.matrix3.determinant() == 0.0 {
                return Some(self.channels[joint]);
            }
            let local = above.inverse() * channel;
            let is_bent = self.tree.is_hung[joint] || self.tree.is_segment[bone as usize];
            if let Some(map) = intended(&local, self.bone_heads[bone as usize], size, is_bent) {
                stretched *= map;
                is_meant = true;
            }
            above = channel;
        }
        is_meant.then_some(stretched)
    }

    /// Takes a pose. `size`: the mesh's, for what counts as a shift. `keep_bone_scale`: shift and stretch are intent.
    pub fn set(&mut self, pose: &[DAffine3], armature_from_rest: DAffine3, origin: DVec3, size: f64, keep_bone_scale: bool) {
        self.palette.place(armature_from_rest, origin);
        let world = self.tree.world();
        self.palette.set(world, &DAffine3::IDENTITY, &DAffine3::IDENTITY, None);
        for joint in 0..self.tree.len() {
            let channel = pose[self.tree.bones[joint] as usize];
            self.channels[joint] = channel;
            let above = self.tree.parents[joint] as usize;
            self.palette.set(joint, &self.rest[joint], &channel, Some(above));
            let parent = self.channels[above];
            self.is_still[joint] = parent == channel;
            let intent = if keep_bone_scale { self.intended(joint, &parent, pose, size) } else { None };
            self.has_intent[joint] = intent.is_some();
            if let Some(stretched) = intent {
                let index = self.stretched(joint);
                self.palette.set(index, &self.rest[joint], &stretched, Some(above));
            }
        }
    }
}

/// The shift and stretch of a bone against the one above without its turn; `None` when there is nothing but the turn.
///
/// The shift of a joint that is hung where its skin blends is how a cut chain turns, that of a segment how its body bends: no
/// more meant than a turn.
fn intended(local: &DAffine3, head: DVec3, size: f64, is_bent: bool) -> Option<DAffine3> {
    let shift = if is_bent { DVec3::ZERO } else { local.transform_point3(head) - head };
    // Half of AᵀA − 1 is the strain as long as it is small: most joints only turn, and are known by it.
    let doubled = local.matrix3.transpose() * local.matrix3 - DMat3::IDENTITY;
    let is_turn = doubled.to_cols_array().iter().all(|s| s.abs() <= INTENT_NOISE) && local.matrix3.determinant() > 0.0;
    if is_turn && shift.length() <= 0.4 * INTENT_NOISE * size {
        return None;
    }
    let Some(stretch) = stretch_of(&local.matrix3) else {
        // Mirrored or flattened: no turn can be told from it.
        return Some(*local);
    };
    let strain = stretch - DMat3::IDENTITY;
    let amount = strain.to_cols_array().iter().fold(0.0f64, |m, s| m.max(s.abs())) + shift.length() / size.max(f64::MIN_POSITIVE);
    let t = ((amount - INTENT_NOISE) / (INTENT_FULL - INTENT_NOISE)).clamp(0.0, 1.0);
    let part = t * t * (3.0 - 2.0 * t);
    if part == 0.0 {
        return None;
    }
    let matrix3 = DMat3::IDENTITY + strain * part;
    Some(DAffine3 { matrix3, translation: head + shift * part - matrix3 * head })
}

/// S of the polar decomposition A = R·S, by Newton's iteration for R; `None` unless A keeps its handedness.
fn stretch_of(a: &DMat3) -> Option<DMat3> {
    let size = a.x_axis.length() * a.y_axis.length() * a.z_axis.length();
    if a.determinant() <= 1e-9 * size {
        return None;
    }
    let mut r = *a;
    for _ in 0..30 {
        let next = (r + r.inverse().transpose()) * 0.5;
        let step = next - r;
        r = next;
        if step.to_cols_array().iter().all(|s| s.abs() < 1e-15) {
            break;
        }
    }
    let s = r.transpose() * *a;
    Some((s + s.transpose()) * 0.5)
}
