//! One frame of the law: what it adds to each skinned point.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use glam::{DAffine3, DMat3, DVec3};

use super::anatomy::{Anatomy, ChainBlock, NearBlock, Node};
use super::bend::{Bent, Shifts};
use super::crease::Crease;
use super::lanes::Eight;
use super::settings::Flesh;
use super::smoothstep;
use super::turn::Turn;
use super::twist::{Chain, Link, Twists};
use crate::numeric::block_rows::{Block, LANES, PATCH_POINTS};
use crate::numeric::lanes::{V4, ZERO, to};
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
    /// Per patch, whether any joint that turns may move its points.
    is_moved: Vec<bool>,
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
pub(crate) trait Points: Sync {
    /// Where eight points of a patch rest, object space about the centre; the rows of `room` are free.
    fn rest<'a>(&'a self, patch: usize, number: usize, room: &'a mut [Block<f64>; 3]) -> [&'a Block<f64>; 3];

    /// Where the points of a patch are skinned, armature space − origin.
    fn skin(&self, patch: usize, places: &mut [V4; PATCH_POINTS]);

    /// Part of what the law adds that holds at the point in a slot; `None`: all, everywhere.
    fn factor(&self) -> Option<impl Fn(usize) -> f64>;

    /// Unit vectors at rest that are turned along, object space; none: empty.
    fn normals(&self) -> &[V4];
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

    /// What turning by angle adds to the normal at the point in each slot, as skinning carries it along; empty if nothing.
    pub fn turned(&self) -> &[[f32; 4]] {
        if self.is_active { &self.turned } else { &[] }
    }

    /// Whether anything is added to points that a patch owns, or to some others that it sees.
    #[inline(always)]
    pub fn moves(&self, patch: usize, others: &[u32]) -> bool {
        self.is_active && (self.is_moved[patch] || others.iter().any(|&slot| self.offsets[slot as usize].map(f32::to_bits) != [0; 4]))
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
    pub fn shape(&mut self, anatomy: &Anatomy, motions: &Motions, patches: &Patches, points: &impl Points) {
        self.is_moved.resize(patches.list.len(), false);
        self.offsets.resize(patches.slot_count(), [0.0; 4]);
        self.turned.resize(points.normals().len(), [0.0; 4]);
        self.free.resize(if self.has_creases { patches.slot_count() } else { 0 }, 1.0);
        let (palette, tree) = (&motions.palette, &motions.tree);
        let centre = palette.armature_from_rest().translation;
        let twists = Twists { limbs: &anatomy.limbs, turns: &self.turns, channels: &motions.channels };
        let is_linear = palette.mode == Mode::Linear;
        let has_links = is_linear && self.turns.iter().any(|turn| turn.twist != 0.0);
        self.joints.clear();
        self.joints.extend(anatomy.limbs.iter().zip(&self.turns).enumerate().map(|(joint, (limb, turn))| {
            let link = if has_links { Link::new(&twists, joint, usize::from(tree.parents[joint]), centre) } else { Link::default() };
            let own = &motions.channels[joint];
            limb.as_ref().filter(|_| !turn.is_still()).map_or(InFrame { link, ..InFrame::default() }, |limb| InFrame {
                is_moved: true,
                link,
                bent: (turn.bend.strength > 0.0).then(|| Bent::new(limb, turn, centre)),
                crease: Crease::new(turn, own.transform_point3(limb.head) - palette.origin),
            })
        }));
        let armature_from_rest = palette.armature_from_rest().matrix3;
        let frame = Frame { anatomy, joints: &self.joints, twists, armature_from_rest, centre, origin: palette.origin, is_linear };
        let level = Level::new();
        let turned_offsets = if self.turned.is_empty() { &patches.no_rows } else { &patches.slot_offsets };
        let free_offsets = if self.has_creases { &patches.slot_offsets } else { &patches.no_rows };
        for_each_piece(
            patches.list.len(),
            (
                Ragged::new(&mut self.offsets, &patches.slot_offsets),
                Ragged::new(&mut self.turned, turned_offsets),
                Ragged::new(&mut self.free, free_offsets),
                &mut *self.is_moved,
            ),
            &|index, (offsets, turned, free, is_moved)| {
                let slots = patches.list[index].start..patches.list[index].start + patches.list[index].owned;
                let (offsets, free) = (offsets.values.as_chunks_mut().0, free.values.as_chunks_mut().0);
                is_moved[0] = frame.moves(index);
                dispatch!(level, simd => frame.patch(simd, (index, slots), points, (offsets, turned.values), free));
            },
        );
    }
}

/// What one joint does in one frame.
#[derive(Debug, Clone, Copy, Default)]
struct InFrame {
    is_moved: bool,
    link: Link,
    bent: Option<Bent>,
    crease: Option<Crease>,
}

#[derive(Clone, Copy)]
struct Frame<'a> {
    anatomy: &'a Anatomy,
    joints: &'a [InFrame],
    twists: Twists<'a>,
    armature_from_rest: DMat3,
    centre: DVec3,
    origin: DVec3,
    is_linear: bool,
}

impl Frame<'_> {
    fn joint(&self, joint: u16) -> &InFrame {
        &self.joints[usize::from(joint)]
    }

    /// Whether any joint that turns may move points of a patch.
    fn moves(&self, patch: usize) -> bool {
        self.anatomy.joints_of_patch.row(patch).iter().any(|&joint| self.joint(joint).is_moved)
    }

    /// What is added to the points of a patch, and what of them lies in no closed crease.
    #[inline(always)]
    fn patch<V: Simd>(
        &self,
        simd: V,
        (index, slots): (usize, Range<usize>),
        points: &impl Points,
        (offsets, turned): (&mut [Block<[f32; 4]>], &mut [[f32; 4]]),
        free: &mut [Block<f32>],
    ) {
        turned.fill([0.0; 4]);
        free.as_flattened_mut().fill(1.0);
        let Anatomy { near, chains, joints_of_patch, .. } = self.anatomy;
        if !self.moves(index) {
            offsets.as_flattened_mut().fill([0.0; 4]);
            return;
        }
        let mut skinned = [ZERO; PATCH_POINTS];
        let mut joints = joints_of_patch.row(index).iter().map(|&joint| self.joint(joint));
        if joints.any(|joint| joint.crease.is_some() || (joint.is_moved && !self.is_linear)) {
            points.skin(index, &mut skinned);
        }
        let (skinned, _) = skinned.as_chunks();
        let factor = points.factor();
        for (number, (offsets, skinned)) in offsets.iter_mut().zip(skinned).enumerate() {
            let first = slots.start + number * LANES;
            let (near, chains) = (near.row(first / LANES), chains.row(first / LANES));
            let mut room = [[0.0; LANES]; 3];
            let at_rest = points.rest(index, number, &mut room);
            let rest = Eight::images(simd, &self.armature_from_rest, at_rest);
            let mut added = self.turned_by(simd, chains, rest) + self.hung(simd, first, at_rest, skinned);
            if near.iter().any(|block| self.joint(block.joint).bent.is_some()) {
                let mut shifts = Shifts::none(simd);
                for block in near {
                    if let Some(bent) = &self.joint(block.joint).bent {
                        shifts.add(bent, &bent.places(simd, block, bent.before_bend(simd, block, rest)));
                    }
                }
                added = added + shifts.total();
                if let Some(free) = free.get_mut(number) {
                    self.crease(simd, near, rest, skinned, &mut added, free);
                }
            }
            if let Some(factor) = &factor {
                let mut factors = [0.0; LANES];
                for (lane, slot) in (first..slots.end).take(LANES).enumerate() {
                    factors[lane] = factor(slot) as f32;
                }
                let factors = f32x8::simd_from(simd, factors);
                added = added.scale(factors);
                if let Some(free) = free.get_mut(number) {
                    *free = (-((-f32x8::simd_from(simd, *free) + 1.0) * factors) + 1.0).into();
                }
            }
            *offsets = added.rows(simd);
            if !turned.is_empty() {
                let normals = &points.normals()[first..slots.end];
                self.turn_normals(simd, (first, chains), (at_rest, rest), normals, &mut turned[number * LANES..]);
            }
        }
    }

    /// What twists add to points that hang on chains of joints.
    #[inline(always)]
    fn turned_by<V: Simd>(&self, simd: V, blocks: &[ChainBlock], rest: Eight<V>) -> Eight<V> {
        let mut chain = Chain::new(simd, rest);
        let count = blocks.iter().rposition(|block| self.joint(block.joint).link.twist != 0.0).map_or(0, |last| last + 1);
        for (number, block) in blocks[..count].iter().enumerate() {
            chain.follow(simd, &self.joint(block.joint).link, block, number + 1 == count);
        }
        chain.by
    }

    /// What turning by angle adds to points that hang on joints in any other way.
    #[inline(always)]
    fn hung<V: Simd>(&self, simd: V, first: usize, at_rest: [&Block<f64>; 3], skinned: &[V4; LANES]) -> Eight<V> {
        let mut added = [[0.0; LANES]; 3];
        self.for_each_hung(first, |lane, nodes| {
            let blended = self.twists.blended(nodes, usize::from(self.anatomy.tops[first + lane]), self.place(at_rest, lane));
            // With dual quaternions the law is still told from the linear blend: what that is apart from them comes first.
            let by_angle = (blended.place - self.origin - to(skinned[lane])) * blended.amount;
            let apart = if self.is_linear { DVec3::ZERO } else { by_angle };
            put(&mut added, lane, blended.by + apart);
        });
        Eight::of(simd, &added)
    }

    /// Visits points of eight slots whose nodes are moved.
    #[inline(always)]
    fn for_each_hung(&self, first: usize, mut visit: impl FnMut(usize, &[Node])) {
        let nodes = &self.anatomy.nodes;
        if nodes.offsets()[first] == nodes.offsets()[first + LANES] {
            return;
        }
        let is_moved = |joint: &InFrame| if self.is_linear { joint.link.twist != 0.0 } else { joint.is_moved };
        for lane in 0..LANES {
            let nodes = nodes.row(first + lane);
            if nodes.iter().any(|node| is_moved(self.joint(node.joint))) {
                visit(lane, nodes);
            }
        }
    }

    /// Rest place of one of eight points, armature space.
    fn place(&self, [x, y, z]: [&Block<f64>; 3], lane: usize) -> DVec3 {
        self.armature_from_rest * DVec3::new(x[lane], y[lane], z[lane]) + self.centre
    }

    /// What turning by angle adds to normals: as affine as what it adds to points.
    #[inline(always)]
    fn turn_normals<V: Simd>(
        &self,
        simd: V,
        (first, chains): (usize, &[ChainBlock]),
        (at_rest, rest): ([&Block<f64>; 3], Eight<V>),
        normals: &[V4],
        turned: &mut [[f32; 4]],
    ) {
        let normal = |lane: usize| (self.armature_from_rest * to(normals[lane])).normalize_or_zero();
        let (mut along, mut by_nodes) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for lane in 0..LANES.min(normals.len()) {
            put(&mut along, lane, normal(lane));
        }
        self.for_each_hung(first, |lane, nodes| {
            let (top, place) = (usize::from(self.anatomy.tops[first + lane]), self.place(at_rest, lane));
            let by = |place: DVec3| self.twists.blended(nodes, top, place).by;
            put(&mut by_nodes, lane, by(place + normal(lane)) - by(place));
        });
        let ends = rest + Eight::of(simd, &along);
        let by = self.turned_by(simd, chains, ends) - self.turned_by(simd, chains, rest) + Eight::of(simd, &by_nodes);
        let rows = by.rows(simd);
        let count = normals.len().min(LANES);
        turned[..count].copy_from_slice(&rows[..count]);
    }

    /// Closes creases, each by where skin stands without any.
    #[inline(always)]
    fn crease<V: Simd>(
        &self,
        simd: V,
        near: &[NearBlock],
        rest: Eight<V>,
        skinned: &[V4; LANES],
        added: &mut Eight<V>,
        free: &mut Block<f32>,
    ) {
        let shaped = *added;
        let mut left = f32x8::simd_from(simd, *free);
        for block in near {
            let InFrame { bent: Some(bent), crease: Some(crease), .. } = self.joint(block.joint) else { continue };
            let (from_head, from_joint) = (bent.before_bend(simd, block, rest), Eight::of_rows(simd, skinned, crease.joint) + shaped);
            if crease.concerns(bent.along(from_head), from_joint) {
                crease.hold(&bent.places(simd, block, from_head), from_joint, added, &mut left);
            }
        }
        *free = left.into();
    }
}

fn put(points: &mut [Block<f32>; 3], lane: usize, v: DVec3) {
    for (row, coordinate) in points.iter_mut().zip(v.as_vec3().to_array()) {
        row[lane] = coordinate;
    }
}
