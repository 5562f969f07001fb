//! Twists by angle, in a nested blend.
//!
//! Joint by joint from the leaves, a point is the mean of what its bones make of it:
//!
//! ```text
//! D_b y_b = w_b x + Σ D_c L_c y_c        over the joints c right below b, L_c what c does that b does not
//! ```
//!
//! which is linear skinning. Now each part first turns about the axis of each c: that of c by −(1 − s) τ, so that s τ is left of the
//! twist τ in `L_c`, all others by s τ. Where the point is a bone's alone and s is 1 nothing changes; in a pure twist the
//! point is turned by s τ as a whole, whatever the weights. Kept is the difference from linear skinning.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::{DAffine3, DVec3};

use super::anatomy::{ChainBlock, NODES_MAX, Node};
use super::lanes::{Eight, single, single3};
use super::limb::Limb;
use super::turn::Turn;

/// What a frame does to the joints, as twists need it.
#[derive(Clone, Copy)]
pub(super) struct Twists<'a> {
    pub limbs: &'a [Option<Limb>],
    pub turns: &'a [Turn],
    /// pose · rest⁻¹ per joint and for the world, armature space.
    pub channels: &'a [DAffine3],
}

/// A point that linear skinning has blended.
#[derive(Clone, Copy)]
pub(super) struct Blended {
    /// Where linear skinning leaves it.
    pub place: DVec3,
    /// What turning by angle adds.
    pub by: DVec3,
    /// Part of the law that holds there, by the joints that blend.
    pub amount: f64,
}

impl Twists<'_> {
    /// v turned about a joint's axis by an angle, less v.
    fn turned_about(&self, joint: usize, v: DVec3, angle: f64) -> DVec3 {
        let Some(limb) = &self.limbs[joint] else { return DVec3::ZERO };
        let (sine, cosine) = angle.sin_cos();
        let across = limb.axis.cross(v);
        across * sine + limb.axis.cross(across) * (1.0 - cosine)
    }

    /// A part of weight `weight` of a point, turned about a joint, less itself.
    fn turned_part(&self, joint: usize, part: DVec3, weight: f64, angle: f64) -> DVec3 {
        if angle == 0.0 {
            return DVec3::ZERO;
        }
        let head = self.limbs[joint].as_ref().map_or(DVec3::ZERO, |limb| limb.head);
        self.turned_about(joint, part - head * weight, angle)
    }

    /// The whole blend of a point.
    pub fn blended(&self, nodes: &[Node], top: usize, place: DVec3) -> Blended {
        // Of each node, times its weight: the point in the rest space of its bone, and what is added there.
        let mut points = [DVec3::ZERO; NODES_MAX + 1];
        let mut by = [DVec3::ZERO; NODES_MAX + 1];
        let (mut law, mut blend) = (0.0, 0.0);
        for above in (0..=nodes.len()).rev() {
            // The joint on which all hang comes last, and is kept behind the nodes.
            let (at, own, joint) = if above == 0 {
                let below: f64 = nodes.iter().filter(|n| usize::from(n.above) == NODES_MAX).map(|n| f64::from(n.under)).sum();
                (NODES_MAX, (1.0 - below).max(0.0), top)
            } else {
                let node = &nodes[above - 1];
                (above - 1, f64::from(node.own), usize::from(node.joint))
            };
            let is_below = |node: &&Node| usize::from(node.above) == at;
            let angle_of = |node: &Node| {
                let turn = &self.turns[usize::from(node.joint)];
                (turn.share(node.share) * turn.twist, turn.twist)
            };
            let (mut point, mut added) = (place * own, DVec3::ZERO);
            if own > 0.0 {
                for node in nodes.iter().filter(is_below) {
                    added += self.turned_part(usize::from(node.joint), point, own, angle_of(node).0);
                }
            }
            let whole = own + nodes.iter().filter(is_below).map(|n| f64::from(n.under)).sum::<f64>();
            for (index, node) in nodes.iter().enumerate().filter(|(_, node)| is_below(node)) {
                let (child, part) = (usize::from(node.joint), f64::from(node.under));
                let mut sum = by[index];
                let moved = points[index] + by[index];
                for other in nodes.iter().filter(is_below).filter(|other| other.joint != node.joint) {
                    sum += self.turned_part(usize::from(other.joint), moved, part, angle_of(other).0);
                }
                let (kept, twist) = angle_of(node);
                sum += self.turned_part(child, points[index] + sum, part, kept - twist);
                let local = self.local(child, joint);
                point += local.matrix3 * points[index] + local.translation * part;
                added += local.matrix3 * sum;
                let pair = part * (whole - part);
                law += pair * self.turns[child].amount;
                blend += pair;
            }
            (points[at], by[at]) = (point, added);
        }
        let map = &self.channels[top];
        Blended {
            place: map.matrix3 * points[NODES_MAX] + map.translation,
            by: map.matrix3 * by[NODES_MAX],
            amount: if blend > 0.0 { law / blend } else { 0.0 },
        }
    }

    /// What a joint does that the one above does not.
    fn local(&self, joint: usize, above: usize) -> DAffine3 {
        let turn = &self.turns[joint];
        if turn.amount > 0.0 { turn.local } else { self.channels[above].inverse() * self.channels[joint] }
    }
}

/// A joint in one frame, for points that hang on a chain of such.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Link {
    head: [f32; 3],
    axis: [f32; 3],
    pub twist: f32,
    spread: f32,
    /// Turns of the bone above, and of the joint's own.
    above: [[f32; 3]; 3],
    own: [[f32; 3]; 3],
    /// What the joint does that the one above does not, and where that takes the centre.
    local: [[f32; 3]; 3],
    shift: [f32; 3],
}

impl Link {
    /// `centre`: that places are told from.
    pub fn new(twists: &Twists, joint: usize, above: usize, centre: DVec3) -> Self {
        let (limb, turn) = (twists.limbs[joint].as_ref(), &twists.turns[joint]);
        let local = twists.local(joint, above);
        Self {
            head: limb.map_or([0.0; 3], |limb| single(limb.head - centre)),
            axis: limb.map_or([0.0; 3], |limb| single(limb.axis)),
            twist: turn.twist as f32,
            spread: turn.spread as f32,
            above: single3(&twists.channels[above].matrix3),
            own: single3(&twists.channels[joint].matrix3),
            local: single3(&local.matrix3),
            shift: single(local.transform_point3(centre) - centre),
        }
    }
}

/// Eight points on their way up a chain of joints.
#[derive(Clone, Copy)]
pub(super) struct Chain<S: Simd> {
    rest: Eight<S>,
    /// Where joints so far leave them, in the rest space of the bone above.
    place: Eight<S>,
    /// What turning by angle adds, posed.
    pub by: Eight<S>,
}

impl<S: Simd> Chain<S> {
    #[inline(always)]
    pub fn new(simd: S, rest: Eight<S>) -> Self {
        Self { rest, place: rest, by: Eight::splat(simd, [0.0; 3]) }
    }

    /// s τ before the bone above moves what is its own, −(1 − s) τ before the joint does. `is_last`: nothing above twists.
    #[inline(always)]
    pub fn follow(&mut self, simd: S, link: &Link, block: &ChainBlock, is_last: bool) {
        let (mut above, mut own) = (self.rest, self.place);
        if link.twist != 0.0 {
            let [blended, along] = [f32x8::simd_from(simd, block.shares[0]), f32x8::simd_from(simd, block.shares[1])];
            let kept = (blended + (along - blended) * link.spread) * link.twist;
            let head = Eight::splat(simd, link.head);
            let (turned_above, turned_own) = ((above - head).turned(link.axis, kept), (own - head).turned(link.axis, kept - link.twist));
            let by_above = turned_above.scale(f32x8::simd_from(simd, block.above)).image(&link.above);
            self.by = self.by + (by_above + turned_own.scale(f32x8::simd_from(simd, block.under)).image(&link.own));
            (above, own) = (above + turned_above, own + turned_own);
        }
        if !is_last {
            let own = own.image(&link.local) + Eight::splat(simd, link.shift);
            self.place = above + (own - above).scale(f32x8::simd_from(simd, block.part));
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use glam::{DMat4, DQuat};
    use proptest::prelude::*;

    use super::*;
    use crate::numeric::block_rows::LANES;
    use crate::numeric::lanes;
    use crate::skinning::blend::{Mode, Skinning};
    use crate::skinning::skeleton::Skeleton;
    use crate::{Joint, Options, Pose, Topology, VolumeSkin};

    /// A cube whose corners hang on bones of a branching tree, each in its own way.
    fn cube(weights: &[f64], parents: &[i32], heads: &[DVec3], mode: Mode) -> VolumeSkin {
        let rest: Vec<DVec3> = (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
        let corners = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5];
        let offsets: Vec<i32> = (0..=6).map(|face| 4 * face).collect();
        let topology = Topology::new(&rest, &offsets, &corners, 0.0).unwrap();
        let bones: Vec<i32> = (0..8).flat_map(|_| 0..parents.len() as i32).collect();
        let first: Vec<i32> = (0..=8).map(|vertex| vertex * parents.len() as i32).collect();
        let matrices: Vec<DMat4> = heads.iter().map(|&head| DMat4::from_translation(head)).collect();
        let skeleton = Skeleton::new(parents, &matrices).unwrap();
        let skinning = Skinning::new(skeleton, &first, &bones, weights, mode, None).unwrap();
        VolumeSkin::bind(&topology, &rest, &skinning, &[], Options::default(), &[], &DMat4::IDENTITY).unwrap()
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn without_twists_the_nested_blend_is_the_linear_one(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 0.01..1.0], 40),
            parents in (0..1i32, 0..2i32, 0..3i32, 0..4i32).prop_map(|p| [-1, p.0, p.1, p.2, p.3]),
            heads in prop::collection::vec(vector(), 5),
            turns in prop::collection::vec(vector(), 5),
        ) {
            prop_assume!(weights.chunks(5).all(|row| row.iter().sum::<f64>() > 0.0));
            let body = cube(&weights, &parents, &heads, Mode::Linear);
            let pose: Vec<DMat4> = turns.iter().zip(&heads).map(|(&turn, &head)| {
                DMat4::from_rotation_translation(DQuat::from_scaled_axis(turn), head + turn)
            }).collect();
            let mut workspace = body.workspace();
            let joints: Vec<Joint> = (0..5).map(|bone| Joint { flesh: crate::Flesh::NONE, ..Joint::isotropic(bone) }).collect();
            let body = body.with_joints(&joints, Options::default()).unwrap();
            body.deform(&Pose::new(&pose), &mut workspace, &mut [[0.0; 3]; 8]).unwrap();
            let (binding, motions) = (body.binding(), workspace.motions());
            // All nodes, also of chains.
            let anatomy = binding.anatomy_of(false);
            let turns = vec![Turn::default(); motions.tree.len()];
            let twists = Twists { limbs: &anatomy.limbs, turns: &turns, channels: &motions.channels };
            for (&slot, &site) in binding.slot_of_vertex.iter().zip(&binding.sites.site_of_vertex) {
                let nodes = anatomy.nodes.row(slot as usize);
                if nodes.is_empty() {
                    continue;
                }
                let rest = binding.sites.rest[site as usize];
                let skinned = lanes::to(motions.palette.skin(&binding.sites.influences, site as usize, rest)) + motions.palette.origin;
                let place = lanes::to(motions.palette.in_armature(rest));
                let blended = twists.blended(nodes, usize::from(anatomy.tops[slot as usize]), place);
                prop_assert!(blended.place.distance(skinned) < 1e-5, "{} {skinned}", blended.place);
                prop_assert!(blended.by.length() < 1e-12);
            }
        }

        #[test]
        fn eight_points_on_chains_turn_as_each_alone(
            weights in prop::collection::vec(prop_oneof![Just(0.0), Just(0.0), 0.01..1.0], 40),
            heads in prop::collection::vec(vector(), 5),
            turns in prop::collection::vec(vector(), 5),
        ) {
            prop_assume!(weights.chunks(5).all(|row| row.iter().sum::<f64>() > 0.0));
            let body = cube(&weights, &[-1, 0, 1, 2, 3], &heads, Mode::Linear);
            let pose: Vec<DMat4> = turns.iter().zip(&heads).map(|(&turn, &head)| {
                DMat4::from_rotation_translation(DQuat::from_scaled_axis(turn), head + turn)
            }).collect();
            let mut workspace = body.workspace();
            body.deform(&Pose::new(&pose), &mut workspace, &mut [[0.0; 3]; 8]).unwrap();
            let (binding, motions) = (body.binding(), workspace.motions());
            let [chained, all] = [true, false].map(|is_linear| binding.anatomy_of(is_linear));
            let above = |joint: usize| usize::from(motions.tree.parents[joint]);
            let turns: Vec<Turn> = chained.limbs.iter().enumerate().map(|(joint, limb)| {
                let of = |limb| Turn::new(limb, &crate::Flesh::FULL, &motions.channels[above(joint)], &motions.channels[joint], 1.0);
                limb.as_ref().map_or(Turn::default(), of)
            }).collect();
            let twists = Twists { limbs: &chained.limbs, turns: &turns, channels: &motions.channels };
            for (block, chain) in chained.chains.rows().enumerate() {
                let slots = block * LANES..(block + 1) * LANES;
                let mut rest = [[0.0; LANES]; 3];
                let is_used = |slot: &usize| !binding.sites.of_slot(*slot).is_empty();
                let place = |slot: usize| binding.rest_in_armature(slot);
                for slot in slots.clone().filter(is_used) {
                    rest.iter_mut().zip(single(place(slot))).for_each(|(row, x)| row[slot % LANES] = x);
                }
                let found = dispatch!(Level::new(), simd => {
                    let mut points = Chain::new(simd, Eight::of(simd, &rest));
                    for (number, joint) in chain.iter().enumerate() {
                        let link = Link::new(&twists, usize::from(joint.joint), above(usize::from(joint.joint)), DVec3::ZERO);
                        points.follow(simd, &link, joint, number + 1 == chain.len());
                    }
                    points.by.rows(simd)
                });
                for slot in slots.filter(is_used).filter(|&slot| chained.nodes.row(slot).is_empty()) {
                    let expected = twists.blended(all.nodes.row(slot), usize::from(all.tops[slot]), place(slot)).by;
                    let [x, y, z, _] = found[slot % LANES].map(f64::from);
                    prop_assert!(DVec3::new(x, y, z).distance(expected) < 1e-5, "{:?} {expected}", found[slot % LANES]);
                }
            }
        }
    }
}
