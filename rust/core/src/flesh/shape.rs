//! One frame of the law: what it adds to each skinned point.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch};
use glam::{DAffine3, DMat3, DVec3};

use super::anatomy::Anatomy;
use super::bend::{Bent, Shifts};
use super::crease::Crease;
use super::lanes::{self, Points8, single};
use super::settings::Flesh;
use super::smoothstep;
use super::turn::Turn;
use super::twist::{Twisted, Twists};
use crate::numeric::block_rows::{Block, LANES, PATCH_POINTS};
use crate::numeric::lanes::{V4, to};
use crate::parallel::split::{Ragged, for_each_piece};
use crate::skinning::blend::Mode;
use crate::skinning::motions::Motions;
use crate::surface::patches::Patches;

/// From this bend on fields lie in the frame of the halved bend as far as the law is followed; radians.
const BENT: f64 = 0.5;

/// Room for one frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shape {
    /// Per joint; all still where nothing is added.
    turns: Vec<Turn>,
    joints: Vec<InFrame>,
    is_active: bool,
    /// Per slot, armature space: in single precision, as it leaves the engine.
    offsets: Vec<[f32; 4]>,
    /// Per slot, what turning by angle adds to the normal there; empty where no normals are asked for.
    turned: Vec<[f32; 4]>,
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
pub(crate) struct Points<'a, P, S, F> {
    /// Where the point in a slot rests, armature space.
    pub place: P,
    /// Where it is skinned.
    pub skinned: S,
    /// Part of what the law adds that holds there; `None`: all.
    pub factor: Option<F>,
    /// Amid the rest places.
    pub centre: DVec3,
    /// Unit vectors at rest that are turned along, in a space of their own; none: empty.
    pub normals: &'a [V4],
    pub armature_from_normals: DMat3,
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

    /// What turning by angle adds to the normal at the point in a slot, as skinning carries it along.
    pub fn turned(&self, slot: usize) -> DVec3 {
        let [x, y, z, _] = self.turned.get(slot).copied().filter(|_| self.is_active).unwrap_or_default();
        DVec3::new(f64::from(x), f64::from(y), f64::from(z))
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

    /// Middle of the section through a bent joint, and the direction of the limb turned by half of the bend, posed; with how far
    /// the joint bends, 0 straight .. 1. `None` where it follows no law.
    pub fn halved(&self, anatomy: &Anatomy, motions: &Motions, joint: usize) -> Option<(DVec3, DVec3, f64)> {
        let turn = self.turns.get(joint).filter(|turn| self.is_active && turn.bend.strength > 0.0)?;
        let middle = anatomy.limbs[joint].as_ref()?.middle;
        let above = &motions.channels[usize::from(motions.tree.parents[joint])];
        let posed = above.transform_point3(middle).midpoint(motions.channels[joint].transform_point3(middle));
        Some((posed, turn.bend.posed_along.try_normalize()?, turn.amount * smoothstep(turn.bend.angle / BENT)))
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.offsets) + size_of_val(&*self.turned) + size_of_val(&*self.free)
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
            let holds = kept.clamp(0.0, 1.0) * anatomy.neighbours[joint].trust(&motions.channels, joint, above);
            self.turns[joint] = Turn::new(limb, &settings(joint), above, &motions.channels[joint], holds);
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
        self.turned.resize(points.normals.len(), [0.0; 4]);
        self.free.resize(if self.has_creases { patches.slot_count() } else { 0 }, 1.0);
        self.joints.clear();
        self.joints.extend(anatomy.limbs.iter().zip(&self.turns).enumerate().map(|(joint, (limb, turn))| {
            limb.as_ref().filter(|_| !turn.is_still()).map_or(InFrame::default(), |limb| {
                let (above, own) = (&motions.channels[usize::from(motions.tree.parents[joint])], &motions.channels[joint]);
                InFrame {
                    twisted: (turn.twist != 0.0).then(|| Twisted::new(limb, turn, above, own, points.centre)),
                    bent: (turn.bend.strength > 0.0).then(|| Bent::new(limb, turn, points.centre)),
                    crease: Crease::new(turn, own.transform_point3(limb.head)),
                }
            })
        }));
        let twists = Twists { limbs: &anatomy.limbs, turns: &self.turns, channels: &motions.channels };
        let frame = Frame { anatomy, joints: &self.joints, twists, is_linear: motions.palette.mode == Mode::Linear };
        let level = Level::new();
        let turned_offsets = if points.normals.is_empty() { &patches.no_rows } else { &patches.slot_offsets };
        let free_offsets = if self.has_creases { &patches.slot_offsets } else { &patches.no_rows };
        for_each_piece(
            patches.list.len(),
            (
                Ragged::new(&mut self.offsets, &patches.slot_offsets),
                Ragged::new(&mut self.turned, turned_offsets),
                Ragged::new(&mut self.free, free_offsets),
            ),
            &|index, (offsets, turned, free)| {
                let slots = patches.list[index].start..patches.list[index].start + patches.list[index].owned;
                let (offsets, free) = (offsets.values.as_chunks_mut().0, free.values.as_chunks_mut().0);
                dispatch!(level, simd => frame.patch(simd, index, slots, points, (offsets, turned.values), free));
            },
        );
    }
}

/// What one joint does in one frame.
#[derive(Debug, Clone, Copy, Default)]
struct InFrame {
    twisted: Option<Twisted>,
    bent: Option<Bent>,
    crease: Option<Crease>,
}

#[derive(Clone, Copy)]
struct Frame<'a> {
    anatomy: &'a Anatomy,
    joints: &'a [InFrame],
    twists: Twists<'a>,
    is_linear: bool,
}

const BLOCKS: usize = PATCH_POINTS / LANES;
const NOWHERE: Points8 = [[0.0; LANES]; 3];

impl Frame<'_> {
    /// What is added to the points of a patch, and what of them lies in no closed crease.
    #[inline(always)]
    fn patch<V: Simd, P, S, F>(
        &self,
        simd: V,
        index: usize,
        slots: Range<usize>,
        points: &Points<P, S, F>,
        (offsets, turned): (&mut [Block<[f32; 4]>], &mut [[f32; 4]]),
        free: &mut [Block<f32>],
    ) where
        P: Fn(usize) -> DVec3,
        S: Fn(usize) -> DVec3,
        F: Fn(usize) -> f64,
    {
        offsets.as_flattened_mut().fill([0.0; 4]);
        turned.fill([0.0; 4]);
        free.as_flattened_mut().fill(1.0);
        let Anatomy { nodes, tops, near, near_of_patch, twists, twists_of_patch, nodes_of_patch, .. } = self.anatomy;
        let (near_rows, twist_rows) = (near_of_patch.row(index), twists_of_patch.row(index));
        let of_joint = |joint: u16| &self.joints[usize::from(joint)];
        let has_bends = near_rows.iter().any(|row| of_joint(row.joint).bent.is_some());
        let has_twists = twist_rows.iter().any(|row| of_joint(row.joint).twisted.is_some());
        let is_moved = |joint: u16| of_joint(joint).twisted.is_some() || (!self.is_linear && of_joint(joint).bent.is_some());
        let has_nodes = nodes_of_patch.row(index).iter().any(|&joint| is_moved(joint));
        if !(has_bends || has_twists || has_nodes) {
            return;
        }
        let (mut places, mut added) = ([NOWHERE; BLOCKS], [NOWHERE; BLOCKS]);
        for (at, slot) in slots.clone().enumerate() {
            put(&mut places, at, single((points.place)(slot) - points.centre));
        }
        for row in twist_rows {
            if let Some(twisted) = &of_joint(row.joint).twisted {
                for block in twists.row(row.row as usize) {
                    twisted.add(block, &places[block.number as usize], &mut added[block.number as usize]);
                }
            }
        }
        if has_nodes {
            for (at, slot) in slots.clone().enumerate() {
                let nodes = nodes.row(slot);
                if !nodes.iter().any(|node| is_moved(node.joint)) {
                    continue;
                }
                let blended = self.twists.blended(nodes, usize::from(tops[slot]), (points.place)(slot));
                // With dual quaternions the law is still told from the linear blend: what that is apart from them comes first.
                let apart = if self.is_linear { DVec3::ZERO } else { (blended.place - (points.skinned)(slot)) * blended.amount };
                let so_far = at_lane(&added, at);
                put(&mut added, at, lanes::add(so_far, single(blended.by + apart)));
            }
        }
        if !turned.is_empty() && (has_twists || has_nodes) {
            self.turn_normals(index, slots.clone(), points, &places, turned);
        }
        if has_bends {
            let mut shifts = [Shifts::NONE; BLOCKS];
            for row in near_rows {
                if let Some(bent) = &of_joint(row.joint).bent {
                    for block in near.row(row.row as usize) {
                        let number = block.number as usize;
                        shifts[number].add(bent, &bent.places(simd, block, &places[number]));
                    }
                }
            }
            for (added, shifts) in added.iter_mut().zip(&shifts) {
                add_to(added, &shifts.total());
            }
            self.crease(simd, index, slots.clone(), points, &places, &mut added, free);
        }
        for (at, slot) in slots.enumerate() {
            let factor = points.factor.as_ref().map_or(1.0, |factor| factor(slot) as f32);
            let [x, y, z] = lanes::scale(at_lane(&added, at), factor);
            offsets[at / LANES][at % LANES] = [x, y, z, 0.0];
            if let Some(free) = free.get_mut(at / LANES) {
                free[at % LANES] = 1.0 - (1.0 - free[at % LANES]) * factor;
            }
        }
    }

    /// What turning by angle adds to normals: as affine as what it adds to points.
    #[inline(always)]
    fn turn_normals<P, S, F>(
        &self,
        index: usize,
        slots: Range<usize>,
        points: &Points<P, S, F>,
        places: &[Points8; BLOCKS],
        turned: &mut [[f32; 4]],
    ) where
        P: Fn(usize) -> DVec3,
    {
        let Anatomy { nodes, tops, twists, twists_of_patch, .. } = self.anatomy;
        let (mut ends, mut by) = (*places, [NOWHERE; BLOCKS]);
        let normal = |slot: usize| (points.armature_from_normals * to(points.normals[slot])).normalize_or_zero();
        for (at, slot) in slots.clone().enumerate() {
            put(&mut ends, at, single((points.place)(slot) - points.centre + normal(slot)));
        }
        for row in twists_of_patch.row(index) {
            if let Some(twisted) = &self.joints[usize::from(row.joint)].twisted {
                for block in twists.row(row.row as usize) {
                    let number = block.number as usize;
                    let mut start = NOWHERE;
                    twisted.add(block, &places[number], &mut start);
                    twisted.add(block, &ends[number], &mut by[number]);
                    for axis in 0..3 {
                        for lane in 0..LANES {
                            by[number][axis][lane] -= start[axis][lane];
                        }
                    }
                }
            }
        }
        for (at, slot) in slots.enumerate() {
            let nodes = nodes.row(slot);
            let mut sum = at_lane(&by, at);
            if nodes.iter().any(|node| self.joints[usize::from(node.joint)].twisted.is_some()) {
                let (top, place) = (usize::from(tops[slot]), (points.place)(slot));
                let along = self.twists.blended(nodes, top, place + normal(slot)).by - self.twists.blended(nodes, top, place).by;
                sum = lanes::add(sum, single(along));
            }
            let [x, y, z] = sum;
            turned[at] = [x, y, z, 0.0];
        }
    }

    /// Closes creases, each by where skin stands without any.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "rows of one patch")]
    fn crease<V: Simd, P, S, F>(
        &self,
        simd: V,
        index: usize,
        slots: Range<usize>,
        points: &Points<P, S, F>,
        places: &[Points8; BLOCKS],
        added: &mut [Points8; BLOCKS],
        free: &mut [Block<f32>],
    ) where
        S: Fn(usize) -> DVec3,
    {
        let rows = self.anatomy.near_of_patch.row(index);
        if free.is_empty() || rows.iter().all(|row| self.joints[usize::from(row.joint)].crease.is_none()) {
            return;
        }
        let shaped = *added;
        let mut skinned: [Option<[DVec3; LANES]>; BLOCKS] = [None; BLOCKS];
        for row in rows {
            let InFrame { bent: Some(bent), crease: Some(crease), .. } = &self.joints[usize::from(row.joint)] else { continue };
            for block in self.anatomy.near.row(row.row as usize) {
                let number = block.number as usize;
                let rest = bent.places(simd, block, &places[number]);
                let parts = crease.parts(&rest);
                if parts.iter().all(|part| *part <= 0.0) {
                    continue;
                }
                let skinned = skinned[number].get_or_insert_with(|| {
                    std::array::from_fn(|lane| {
                        let slot = slots.start + number * LANES + lane;
                        if slot < slots.end { (points.skinned)(slot) } else { DVec3::ZERO }
                    })
                });
                let mut from_joint = lanes::each3(|lane| single(skinned[lane] - crease.joint));
                add_to(&mut from_joint, &shaped[number]);
                crease.hold(&rest, &parts, &from_joint, &mut added[number], &mut free[number]);
            }
        }
    }
}

#[inline(always)]
fn at_lane(points: &[Points8; BLOCKS], at: usize) -> [f32; 3] {
    lanes::at(&points[at / LANES], at % LANES)
}

#[inline(always)]
fn put(points: &mut [Points8; BLOCKS], at: usize, v: [f32; 3]) {
    for axis in 0..3 {
        points[at / LANES][axis][at % LANES] = v[axis];
    }
}

#[inline(always)]
fn add_to(points: &mut Points8, by: &Points8) {
    for axis in 0..3 {
        for lane in 0..LANES {
            points[axis][lane] += by[axis][lane];
        }
    }
}
