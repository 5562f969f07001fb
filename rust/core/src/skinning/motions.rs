//! The motions of one frame, and what of them the animator means: turns cost volume, shifts and stretches move the target [MATH §3].

use glam::{DAffine3, DMat3, DVec3};

use crate::skinning::bases::{Base, mean};
use crate::skinning::blend::{Mode, Palette};
use crate::skinning::hung_joints::{HandedOn, HungJoint};
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
    pub hung: Vec<HungJoint>,
    pub handed_on: HandedOn,
    /// Whether shift and stretch are intent at all.
    pub keeps_intent: bool,
    bases: Vec<Base>,
    /// Per base, for each member whether it is stretched and shifted against it; empty where the base does what `top` does.
    members_have_intent: Vec<Vec<bool>>,
    rest: Vec<DAffine3>,
    /// Place of each bone at rest, armature space.
    bone_heads: Vec<DVec3>,
}

impl Motions {
    /// `rest`: rest matrix of each bone.
    pub fn new(tree: JointTree, hung: Vec<HungJoint>, bases: Vec<Base>, rest: &[DAffine3], mode: Mode) -> Self {
        let count = tree.len();
        let motion_count = 2 * count + 1 + bases.iter().map(Base::motion_count).sum::<usize>();
        let bone_heads = rest.iter().map(|m| m.translation).collect();
        let rest = tree.bones.iter().map(|&bone| rest[bone as usize]).collect();
        Self {
            palette: Palette::new(mode, motion_count),
            channels: vec![DAffine3::IDENTITY; count + 1],
            has_intent: vec![false; count],
            is_still: vec![true; count],
            handed_on: HandedOn::new(&hung),
            hung,
            keeps_intent: true,
            members_have_intent: vec![Vec::new(); bases.len()],
            bases,
            rest,
            bone_heads,
            tree,
        }
    }

    /// The base that a shell moves against in this frame, with its number; `None` where that is what the joint above it does.
    pub fn base(&self, component: u32) -> Option<(usize, &Base)> {
        let index = self.bases.binary_search_by_key(&component, |base| base.component).ok()?;
        (!self.members_have_intent[index].is_empty()).then(|| (index, &self.bases[index]))
    }

    /// All bases of this frame.
    pub fn active_bases(&self) -> impl Iterator<Item = &Base> {
        self.bases.iter().zip(&self.members_have_intent).filter(|(_, members)| !members.is_empty()).map(|(base, _)| base)
    }

    /// Index of the motion of a shell as a whole, where `joint` is above all of its joints, else of that joint.
    pub fn whole(&self, component: u32, joint: usize) -> usize {
        self.base(component).filter(|(_, base)| base.top == joint).map_or(joint, |(_, base)| base.first_motion)
    }

    /// Index of the motion against which a joint turns in a shell.
    pub fn above(&self, component: u32, joint: usize) -> usize {
        self.whole(component, usize::from(self.tree.parents[joint]))
    }

    /// Index of the motion of a joint that is stretched and shifted only, in a shell; `None` where it is neither.
    pub fn intent(&self, component: u32, joint: usize) -> Option<usize> {
        let member = self.base(component).and_then(|(index, base)| Some((index, base, base.member(joint)?)));
        match member {
            Some((index, base, member)) => self.members_have_intent[index][member].then_some(base.first_motion + 3 + member),
            None => self.has_intent[joint].then(|| self.stretched(joint)),
        }
    }

    /// True where a joint does nothing in a shell that is not done to it from above.
    pub fn is_still_in(&self, component: u32, joint: usize) -> bool {
        match self.base(component).filter(|(_, base)| base.member(joint).is_some()) {
            Some(_) => false,
            None => self.is_still[joint],
        }
    }

    /// Index of the motion of a joint that is stretched and shifted only.
    pub fn stretched(&self, joint: usize) -> usize {
        self.tree.len() + 1 + joint
    }

    /// Where a joint goes that is shifted and stretched like itself and the bones without weight above it, but not turned.
    fn intended(&self, joint: usize, parent: &DAffine3, pose: &[DAffine3], size: f64) -> Option<DAffine3> {
        self.stretched_along(self.tree.links.row(joint), parent, pose, size, !self.tree.is_hung[joint])
    }

    /// `parent`, stretched like the bones below it, and shifted where shifts are meant; `None` where it is neither.
    fn stretched_along(&self, bones: &[u32], parent: &DAffine3, pose: &[DAffine3], size: f64, shift_is_meant: bool) -> Option<DAffine3> {
        let mut above = *parent;
        let mut stretched = *parent;
        let mut is_meant = false;
        for &bone in bones {
            let channel = pose[bone as usize];
            if above.matrix3.determinant() == 0.0 {
                return bones.last().map(|&bone| pose[bone as usize]);
            }
            let local = above.inverse() * channel;
            let is_meant_shift = shift_is_meant && !self.tree.is_segment[bone as usize];
            if let Some(map) = intended(&local, self.bone_heads[bone as usize], size, is_meant_shift) {
                stretched *= map;
                is_meant = true;
            }
            above = channel;
        }
        is_meant.then_some(stretched)
    }

    /// Sets the motions of a base. It takes part where a shell moves otherwise than the joint above it, turns apart.
    fn set_base(&mut self, index: usize, pose: &[DAffine3], size: f64) {
        let base = &self.bases[index];
        let top = self.channels[base.top];
        let carrier = base.carrier.map_or(top, |bone| pose[bone as usize]);
        // Bones below the carrier, and whether the member hangs below it at all.
        let links = |member: usize| {
            let row = self.tree.links.row(member);
            let below = base.carrier.and_then(|carrier| row.iter().position(|&bone| bone == carrier)).map_or(0, |place| place + 1);
            (&row[..below], &row[below..])
        };
        let against_carrier =
            |member: usize, shift_is_meant: bool| self.stretched_along(links(member).1, &carrier, pose, size, shift_is_meant);
        if carrier == top && base.members.iter().all(|&(joint, _)| against_carrier(joint, true).is_none()) {
            self.members_have_intent[index].clear();
            return;
        }
        let whole = mean(base.members.iter().map(|&(joint, part)| (part, against_carrier(joint, true).unwrap_or(carrier))));
        let (to_carrier, _) = links(base.members[0].0);
        let to_carrier = if to_carrier.is_empty() { base.carrier.as_slice() } else { to_carrier };
        let unturned = self.stretched_along(to_carrier, &top, pose, size, !self.tree.is_hung[base.members[0].0]).unwrap_or(top);
        let mut motions = vec![(whole, true), (carrier, true), (unturned, true)];
        for &(joint, _) in &base.members {
            let is_hung = self.tree.is_hung[joint];
            motions.push(match against_carrier(joint, !is_hung) {
                Some(stretched) if is_hung => {
                    // Stretched where the base takes it: its shift is how a cut chain turns.
                    let head = self.tree.heads[joint];
                    let back = whole.transform_point3(head) - stretched.transform_point3(head);
                    (DAffine3::from_translation(back) * stretched, true)
                }
                stretched => (stretched.unwrap_or(carrier), !is_hung),
            });
        }
        let (first, above, rest) = (base.first_motion, base.top, self.rest[base.members[0].0]);
        for (place, (motion, _)) in motions.iter().enumerate() {
            self.palette.set(first + place, &rest, motion, Some(above));
        }
        self.members_have_intent[index] = motions[3..].iter().map(|m| m.1 && self.keeps_intent).collect();
        // However far a shell turns against the joint above, its joints' rotations lie on the side of its own.
        for place in 0..self.bases[index].members.len() {
            let joint = self.bases[index].members[place].0;
            for below in joint..usize::from(self.tree.ends[joint]) {
                let reference = if below == joint { first } else { usize::from(self.tree.parents[below]) };
                self.palette.align(below, reference);
                self.palette.align(self.stretched(below), below);
            }
            self.palette.align(first + 3 + place, first);
        }
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
        self.keeps_intent = keep_bone_scale;
        for index in 0..self.bases.len() {
            self.set_base(index, pose, size);
        }
        self.handed_on.set(&self.tree, &self.hung, &self.channels, pose);
    }
}

/// The shift and stretch of a bone against the one above without its turn; `None` when there is nothing but the turn.
///
/// The shift of a joint that is hung where its skin blends is how a cut chain turns, that of a segment how its bone group bends: no
/// more meant than a turn.
fn intended(local: &DAffine3, head: DVec3, size: f64, shift_is_meant: bool) -> Option<DAffine3> {
    let shift = if shift_is_meant { local.transform_point3(head) - head } else { DVec3::ZERO };
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
