//! One frame of the law: what it adds to each skinned point.

use glam::{DAffine3, DVec3};

use super::anatomy::Anatomy;
use super::bend::{InBend, Shifts};
use super::crease::creased;
use super::settings::Flesh;
use super::turn::Turn;
use super::twist::Twists;
use crate::parallel::split::{Ragged, for_each_piece};
use crate::skinning::blend::Mode;
use crate::skinning::motions::Motions;
use crate::surface::patches::Patches;

/// Room for one frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shape {
    /// Per joint; all still where nothing is added.
    turns: Vec<Turn>,
    is_active: bool,
    /// Per slot, armature space: in single precision, as it leaves the engine.
    offsets: Vec<[f32; 4]>,
    /// Per slot, part that lies in no closed crease; empty where none closes.
    free: Vec<f32>,
    has_creases: bool,
    /// Motions without what is turned by angle: no volume is lost by that.
    untwisted: Option<Box<Motions>>,
    uses_untwisted: bool,
    /// Per joint, what taking twists out does to what hangs on it; per bone, what is left.
    straightened: Vec<DAffine3>,
    pose: Vec<DAffine3>,
}

/// What a frame brings for each point.
pub(crate) struct Points<P, S, F> {
    /// Where the point in a slot rests, armature space.
    pub place: P,
    /// Where it is skinned.
    pub skinned: S,
    /// Part of what the law adds that holds there.
    pub factor: F,
}

impl Shape {
    /// Whether this frame adds anything.
    pub fn is_active(&self) -> bool {
        self.is_active
    }

    /// What is added to the point in a slot.
    #[inline(always)]
    pub fn offset(&self, slot: usize) -> [f32; 4] {
        if self.is_active { self.offsets[slot] } else { [0.0; 4] }
    }

    /// Added to each slot of an active frame.
    pub fn offsets(&self) -> &[[f32; 4]] {
        &self.offsets
    }

    /// Per slot, part that lies in no closed crease.
    pub fn free(&self) -> Option<&[f32]> {
        (self.is_active && self.has_creases).then_some(&self.free)
    }

    /// Motions whose turns cost volume.
    pub fn of_losses<'a>(&'a self, motions: &'a Motions) -> &'a Motions {
        self.untwisted.as_deref().filter(|_| self.is_active && self.uses_untwisted).unwrap_or(motions)
    }

    /// How much a joint turns, and the radius of its limb: what an unexplained change of volume is shared by.
    pub fn extent(&self, anatomy: &Anatomy, joint: usize) -> f64 {
        anatomy.limbs[joint].as_ref().map_or(0.0, |limb| self.turns[joint].extent() * limb.radius.powi(3))
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.offsets) + size_of_val(&*self.free)
    }

    /// No law in this frame.
    pub fn rest(&mut self) {
        self.is_active = false;
    }

    /// Takes a pose: how each joint turns. `settings` per joint; true where anything is to be added.
    pub fn take(&mut self, anatomy: &Anatomy, motions: &Motions, settings: impl Fn(usize) -> Flesh) -> bool {
        let tree = &motions.tree;
        self.turns.clear();
        self.turns.resize(tree.len(), Turn::default());
        for (joint, limb) in anatomy.limbs.iter().enumerate() {
            let Some(limb) = limb else { continue };
            let hung = motions.hung.iter().position(|hung| usize::from(hung.joint) == joint);
            let kept = hung.map_or(1.0, |hung| motions.handed_on.kept[hung]);
            let above = &motions.channels[usize::from(tree.parents[joint])];
            self.turns[joint] = Turn::new(limb, &settings(joint), above, &motions.channels[joint], kept.clamp(0.0, 1.0));
        }
        self.has_creases = self.turns.iter().any(|turn| turn.bend.crease > 0.0);
        self.is_active = self.turns.iter().any(|turn| !turn.is_still());
        self.is_active
    }

    /// Takes twists out of a pose, for losses. `size` and `keep_bone_scale` as for the motions themselves.
    pub fn untwist(&mut self, anatomy: &Anatomy, motions: &Motions, pose: &[DAffine3], place: (DAffine3, DVec3), size: f64) {
        let is_twisted = self.turns.iter().any(|turn| turn.twist != 0.0);
        // Dual quaternions turn by angle themselves.
        self.uses_untwisted = is_twisted && motions.palette.mode == Mode::Linear;
        if !self.uses_untwisted {
            return;
        }
        let tree = &motions.tree;
        self.pose.clear();
        self.pose.extend_from_slice(pose);
        self.straightened.clear();
        self.straightened.resize(tree.len() + 1, DAffine3::IDENTITY);
        for joint in 0..tree.len() {
            let above = self.straightened[usize::from(tree.parents[joint])];
            for &bone in tree.links.row(joint) {
                self.pose[bone as usize] = above * pose[bone as usize];
            }
            let (turn, own) = (&self.turns[joint], &motions.channels[joint]);
            self.straightened[joint] = match &anatomy.limbs[joint] {
                Some(limb) if turn.twist != 0.0 => {
                    let back = DAffine3::from_axis_angle(limb.axis, -turn.twist);
                    let about = DAffine3::from_translation(limb.head) * back * DAffine3::from_translation(-limb.head);
                    let straight = above * *own * about;
                    self.pose[tree.bones[joint] as usize] = straight;
                    straight * own.inverse()
                }
                _ => above,
            };
        }
        let untwisted = self.untwisted.get_or_insert_with(|| Box::new(motions.clone()));
        untwisted.set(&self.pose, place.0, place.1, size, motions.keeps_intent);
    }

    /// Works out what is added to each point.
    pub fn shape<P, S, F>(&mut self, anatomy: &Anatomy, motions: &Motions, patches: &Patches, points: &Points<P, S, F>)
    where
        P: Fn(usize) -> DVec3 + Sync,
        S: Fn(usize) -> DVec3 + Sync,
        F: Fn(usize) -> f64 + Sync,
    {
        self.offsets.resize(patches.slot_count(), [0.0; 4]);
        self.free.resize(if self.has_creases { patches.slot_count() } else { 0 }, 1.0);
        let frame = Frame {
            anatomy,
            turns: &self.turns,
            twists: Twists { limbs: &anatomy.limbs, turns: &self.turns, channels: &motions.channels },
            motions,
        };
        let free_offsets = if self.has_creases { &patches.slot_offsets } else { &patches.no_rows };
        for_each_piece(
            patches.list.len(),
            (Ragged::new(&mut self.offsets, &patches.slot_offsets), Ragged::new(&mut self.free, free_offsets)),
            &|index, (offsets, free)| {
                let patch = &patches.list[index];
                let joints = anatomy.joints_of_patch.row(index);
                free.values.fill(1.0);
                if joints.iter().all(|&joint| frame.turns[usize::from(joint)].is_still()) {
                    offsets.values.fill([0.0; 4]);
                    return;
                }
                let bent = joints.iter().any(|&joint| frame.turns[usize::from(joint)].bend.strength > 0.0);
                for (place, offset) in offsets.values[..patch.owned].iter_mut().enumerate() {
                    let slot = patch.start + place;
                    let factor = (points.factor)(slot);
                    *offset = [0.0; 4];
                    if factor == 0.0 {
                        continue;
                    }
                    let (added, touch) = frame.of_slot(points, slot, bent);
                    let [x, y, z] = (added * factor).as_vec3().to_array();
                    *offset = [x, y, z, 0.0];
                    if let Some(free) = free.values.get_mut(place) {
                        *free = (1.0 - touch * factor) as f32;
                    }
                }
            },
        );
    }
}

#[derive(Clone, Copy)]
struct Frame<'a> {
    anatomy: &'a Anatomy,
    turns: &'a [Turn],
    twists: Twists<'a>,
    motions: &'a Motions,
}

impl Frame<'_> {
    /// What is added to the point in a slot, and the part of it that lies in closed creases.
    #[inline]
    fn of_slot<P, S, F>(&self, points: &Points<P, S, F>, slot: usize, bent: bool) -> (DVec3, f64)
    where
        P: Fn(usize) -> DVec3,
        S: Fn(usize) -> DVec3,
    {
        let Anatomy { limbs, nodes, tops, near, .. } = self.anatomy;
        let (nodes, near) = (nodes.row(slot), near.row(slot));
        if nodes.is_empty() && near.is_empty() {
            return (DVec3::ZERO, 0.0);
        }
        let place = (points.place)(slot);
        let mut added = DVec3::ZERO;
        let is_still = |joint: u16| self.turns[usize::from(joint)].is_still();
        if self.motions.palette.mode == Mode::DualQuaternion {
            // The law is told from the linear blend: what that is apart from dual quaternions comes first.
            if !nodes.iter().all(|node| is_still(node.joint)) {
                let blended = self.twists.blended(nodes, usize::from(tops[slot]), place);
                added = blended.by + (blended.place - (points.skinned)(slot)) * blended.amount;
            }
        } else if !self.twists.are_still(nodes) {
            added = self.twists.added(nodes, usize::from(tops[slot]), place);
        }
        if !bent {
            return (added, 0.0);
        }
        let mut shifts = Shifts::default();
        let mut has_creases = false;
        for of in near {
            let turn = &self.turns[usize::from(of.joint)];
            if turn.bend.strength <= 0.0 {
                continue;
            }
            let Some(limb) = &limbs[usize::from(of.joint)] else { continue };
            if let Some(rest) = InBend::new(limb, turn, of, place) {
                let part = rest.part();
                if part > 0.0 {
                    shifts.add(part, turn.bend.strength, rest.shift(turn));
                }
                has_creases |= turn.bend.crease > 0.0;
            }
        }
        added += shifts.total();
        let mut touch = 0.0;
        if has_creases {
            let stands = (points.skinned)(slot) + added;
            for of in near {
                let joint = usize::from(of.joint);
                let (turn, Some(limb)) = (&self.turns[joint], &limbs[joint]) else { continue };
                if turn.bend.crease <= 0.0 {
                    continue;
                }
                let head = self.motions.channels[joint].transform_point3(limb.head);
                let rest = InBend::new(limb, turn, of, place);
                if let Some(crease) = rest.and_then(|rest| creased(turn, &rest, stands - head)) {
                    added += crease.by;
                    touch = 1.0 - (1.0 - touch) * (1.0 - crease.touch);
                }
            }
        }
        (added, touch)
    }
}
