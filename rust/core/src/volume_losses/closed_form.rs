//! Losses under linear skinning in closed form: no vertex is touched in a frame.
//!
//! A linearly skinned point is `q = K p + Σ s D p`, the sum over joints: K the motion of the joint above, s the weight of all that
//! hangs on a joint, D what the joint does that its parent does not. So q is a sum of fixed numbers times the columns of these maps,
//! and the volume, three times linear in q, is a sum of fixed numbers times determinants of three such columns. Turning
//! joints on one after the other adds the terms whose last joint it is: each loss is a few hundred products, whatever
//! the number of vertices.

use std::collections::{BTreeMap, HashMap, HashSet};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x4};
use rayon::prelude::*;

use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, Columns, V4, add, add_scaled, cross, mul, sub, transform};
use crate::parallel::split::{Equal, for_each_piece};
use crate::skinning::motions::Motions;
use crate::skinning::sites::Sites;
use crate::surface::sweeps::mean_and_cross;
use crate::volume_losses::job::{Anatomy, Change, FaceJoints, Job, Moment, Portions, find_job};

/// More numbers than this per point of the mesh are no gain over sweeping it.
const NUMBERS_PER_POINT: usize = 24;
/// Small meshes may have this many in any case.
const NUMBERS_MIN: usize = 1 << 14;
/// Turns that a thread takes at a time.
const TURNS: usize = 4;
/// Sites of a point that are gone through again for each of its faces.
const FEW_SITES: usize = 8;
/// Place of the joint above in a block.
const TOP: u16 = u16::MAX;

/// Columns of an affine map, and the image of the joint's own place.
type Span = [V4; 4];

/// What one joint adds to one portion when it turns: the blocks whose last joint it is.
#[derive(Debug, Clone, Copy)]
struct Turn {
    job: u32,
    component: u32,
    top: u16,
    joint: u16,
}

/// Joints of three factors, earlier first, the last of them the turn's, and where the numbers start.
#[derive(Debug, Clone, Copy)]
struct Block {
    first: u16,
    second: u16,
    start: u32,
}

/// Volume of a mesh as a form in the maps of its joints.
#[derive(Debug, Clone)]
pub(crate) struct VolumeForms {
    turns: Vec<Turn>,
    /// Per turn.
    blocks: Csr<Block>,
    numbers: Vec<f64>,
    /// Per joint and for the world, the point about which its functions are taken, rest space.
    centres: Vec<V4>,
}

/// Spans and results of one frame.
#[derive(Debug, Clone)]
pub(crate) struct FormBuffers {
    /// Per joint and for the world.
    whole: Vec<Span>,
    /// Per joint: what it does that its parent does not; then without its turn.
    added: Vec<Span>,
    stretched: Vec<Span>,
    changes: Vec<Change>,
}

/// Triples of functions of three joints that a block holds: of one joint each pair or triple once.
fn functions(first: u16, second: u16, third: u16) -> impl Iterator<Item = [usize; 3]> {
    let below = |limit: usize, is_one: bool| 0..if is_one { limit } else { 4 };
    (0..4).flat_map(move |c| below(c, second == third).flat_map(move |b| below(b, first == second).map(move |a| [a, b, c])))
}

/// Numbers of a block.
fn block_size(first: u16, second: u16, third: u16) -> usize {
    match (first == second, second == third) {
        (true, true) => 4,
        (false, false) => 64,
        _ => 24,
    }
}

impl VolumeForms {
    /// `None` where weights mix too many joints for this to pay. Fills `portions` with the faces under each joint.
    pub fn new(anatomy: &Anatomy, jobs: &[Job], portions: &mut Portions) -> Option<Self> {
        let Anatomy { topology, joints, .. } = *anatomy;
        let mut faces: Vec<(u32, u32, u32)> =
            topology.component_of_face.iter().zip(&joints.tops).zip(0..).map(|((&c, &top), face)| (c, top, face)).collect();
        faces.sort_unstable();
        let groups: Vec<&[(u32, u32, u32)]> = faces.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).collect();
        let limit = NUMBERS_MIN.max(NUMBERS_PER_POINT * topology.point_count);
        if !is_sparse(&groups, joints, limit) {
            return None;
        }
        let filled: Vec<Filled> = groups.par_iter().map(|group| fill(anatomy, group)).collect();
        let (mut turns, mut blocks, mut numbers) = (Vec::new(), Csr::default(), Vec::new());
        for (group, filled) in groups.iter().zip(filled) {
            let (component, top, _) = group[0];
            portions.push(component, top, filled.moment);
            let keys: Vec<[u16; 3]> = filled.numbers.keys().copied().collect();
            for same in keys.chunk_by(|a, b| a[0] == b[0]) {
                let joint = same[0][0];
                let Some(job) = find_job(jobs, usize::from(joint), component) else { continue };
                turns.push(Turn { job, component, top: top as u16, joint });
                blocks.push_row(same.iter().map(|key| {
                    let start = numbers.len() as u32;
                    numbers.extend_from_slice(&filled.numbers[key]);
                    Block { first: key[2], second: key[1], start }
                }));
            }
        }
        numbers.shrink_to_fit();
        Some(Self { turns, blocks, numbers, centres: anatomy.heads.to_vec() })
    }

    pub fn buffers(&self) -> FormBuffers {
        let joints = self.centres.len() - 1;
        FormBuffers {
            whole: vec![[lanes::ZERO; 4]; joints + 1],
            added: vec![[lanes::ZERO; 4]; joints],
            stretched: vec![[lanes::ZERO; 4]; joints],
            changes: vec![Change::default(); self.turns.len()],
        }
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.turns) + self.blocks.memory_bytes() + size_of_val(&*self.numbers)
    }

    /// What turns do to the faces they deform.
    pub fn measure(&self, motions: &Motions, buffers: &mut FormBuffers) {
        let palette = &motions.palette;
        for (joint, (whole, &centre)) in buffers.whole.iter_mut().zip(&self.centres).enumerate() {
            *whole = span(palette.alone(joint), centre);
        }
        for joint in 0..buffers.added.len() {
            let above = span(palette.alone(usize::from(motions.tree.parents[joint])), self.centres[joint]);
            let own = buffers.whole[joint];
            buffers.added[joint] = std::array::from_fn(|i| sub(own[i], above[i]));
            if motions.has_intent[joint] {
                let stretched = span(palette.alone(motions.stretched(joint)), self.centres[joint]);
                buffers.stretched[joint] = std::array::from_fn(|i| sub(stretched[i], above[i]));
            }
        }
        let level = Level::new();
        let FormBuffers { whole, added, stretched, changes } = buffers;
        let measure = |index: usize, change: &mut Change| {
            let turn = &self.turns[index];
            let joint = usize::from(turn.joint);
            *change = Change::default();
            if motions.is_still_in(turn.component, joint) {
                return;
            }
            let blocks = self.blocks.row(index);
            if let Some((_, base)) = motions.base(turn.component).filter(|(_, base)| base.top == usize::from(turn.top)) {
                let against = |motion: usize, joint: usize| {
                    let centre = self.centres[joint];
                    let (own, above) = (span(palette.alone(motion), centre), span(palette.alone(base.first_motion), centre));
                    std::array::from_fn(|i| sub(own[i], above[i]))
                };
                let mut added = added.clone();
                base.members.iter().for_each(|&(member, _)| added[member] = against(member, member));
                let above = span(palette.alone(base.first_motion), self.centres[usize::from(turn.top)]);
                let gain_with = |last: &Span| dispatch!(level, simd => gain(simd, blocks, &self.numbers, &above, &added, turn.joint, last));
                let total = gain_with(&added[joint]);
                let intent = match motions.intent(turn.component, joint) {
                    Some(motion) if base.member(joint).is_some() => gain_with(&against(motion, joint)),
                    Some(_) => gain_with(&stretched[joint]),
                    None => 0.0,
                };
                *change = Change { intent, loss: intent - total };
                return;
            }
            let above = &whole[usize::from(turn.top)];
            let gain_with = |last: &Span| dispatch!(level, simd => gain(simd, blocks, &self.numbers, above, added, turn.joint, last));
            let total = gain_with(&added[joint]);
            let intent = if motions.has_intent[joint] { gain_with(&stretched[joint]) } else { 0.0 };
            *change = Change { intent, loss: intent - total };
        };
        let rows = Equal::new(changes, TURNS);
        for_each_piece(rows.count(), rows, &|row, changes| {
            for (place, change) in changes.values.iter_mut().enumerate() {
                measure(row * TURNS + place, change);
            }
        });
    }

    /// Adds what was measured to the changes of jobs.
    pub fn gather(&self, buffers: &FormBuffers, of_job: &mut [Change]) {
        for (change, turn) in buffers.changes.iter().zip(&self.turns) {
            of_job[turn.job as usize].join(change);
        }
    }
}

fn span(m: &Columns, centre: V4) -> Span {
    [m[0], m[1], m[2], transform(m, centre)]
}

/// Volume that a joint's blocks hold with `last` as its span.
#[inline(always)]
fn gain<S: Simd>(simd: S, blocks: &[Block], numbers: &[f64], above: &Span, added: &[Span], joint: u16, last: &Span) -> f64 {
    let span_of = |of: u16| match of {
        TOP => above,
        of if of == joint => last,
        of => &added[usize::from(of)],
    };
    let none = f64x4::splat(simd, 0.0);
    let mut sum = none;
    // Of the block before, whose second joint is mostly the same: each of its columns crossed with each of the last's.
    let (mut crossed_with, mut crosses) = (None, [[lanes::ZERO; 4]; 4]);
    for block in blocks {
        let (first, second) = (span_of(block.first), span_of(block.second));
        if crossed_with != Some(block.second) {
            crossed_with = Some(block.second);
            crosses = last.map(|last| second.map(|second| cross(second, last)));
        }
        let mut weighted = [none; 4];
        let mut numbers = numbers[block.start as usize..].iter();
        // In the order of `functions`.
        for (c, crosses) in crosses.iter().enumerate() {
            for (b, crossed) in crosses[..if block.second == joint { c } else { 4 }].iter().enumerate() {
                let crossed = f64x4::simd_from(simd, *crossed);
                for (weighted, &number) in weighted[..if block.first == block.second { b } else { 4 }].iter_mut().zip(&mut numbers) {
                    *weighted += crossed * number;
                }
            }
        }
        for (first, weighted) in first.iter().zip(weighted) {
            sum += f64x4::simd_from(simd, *first) * weighted;
        }
    }
    lanes::sum(sum.into())
}

/// True while no more than `limit` numbers are needed.
fn is_sparse(groups: &[&[(u32, u32, u32)]], joints: &FaceJoints, limit: usize) -> bool {
    let mut count = 0;
    let mut known: HashSet<[u16; 3]> = HashSet::new();
    let mut sets: HashSet<&[u16]> = HashSet::new();
    for group in groups {
        known.clear();
        sets.clear();
        for &(_, _, face) in *group {
            let below = joints.below.row(face as usize);
            if !sets.insert(below) {
                continue;
            }
            for key in blocks_of(below) {
                if known.insert(key) {
                    count += block_size(key[2], key[1], key[0]);
                    if count > limit {
                        return false;
                    }
                }
            }
        }
    }
    true
}

/// Keys (last, second, first) of the blocks of a face: all that a joint below the top is part of.
fn blocks_of(below: &[u16]) -> impl Iterator<Item = [u16; 3]> {
    // TOP comes first in the order of turning.
    let at = |place: usize| if place == 0 { TOP } else { below[place - 1] };
    (1..=below.len()).flat_map(move |k| (0..=k).flat_map(move |j| (0..=j).map(move |i| [at(k), at(j), at(i)])))
}

/// What one group of faces adds up to.
struct Filled {
    numbers: BTreeMap<[u16; 3], Vec<f64>>,
    moment: Moment,
}

/// Sums the numbers of a group of faces under one joint.
fn fill(anatomy: &Anatomy, group: &[(u32, u32, u32)]) -> Filled {
    let Anatomy { topology, patches, sites, joints, heads, .. } = *anatomy;
    let mut numbers: BTreeMap<[u16; 3], Vec<f64>> = BTreeMap::new();
    let (mut volume, mut area) = (0.0, lanes::ZERO);
    let mut values: Vec<Vec<V4>> = Vec::new();
    let mut known = Known { sites, values: HashMap::new() };
    for &(_, top, face) in group {
        let below = joints.below.row(face as usize);
        let slots: Vec<usize> = topology.faces.row(face as usize).iter().map(|&p| patches.slot_of_point[p as usize] as usize).collect();
        let places: Vec<V4> = slots.iter().map(|&slot| known.value(slot, TOP, || sites.mean(slot, |site| sites.rest[site]))).collect();
        let (mean, twice_area) = mean_and_cross(places.iter().copied());
        volume += lanes::sum(mul(mean, twice_area)) / 6.0;
        area = add_scaled(area, twice_area, 0.5);
        if below.is_empty() {
            continue;
        }
        // Values of the four functions of each joint at each corner, the joint above first.
        values.clear();
        values.push(places.iter().map(|&p| about(p, heads[top as usize])).collect());
        for &joint in below {
            let value = |&slot: &usize| known.value(slot, joint, || function_values(anatomy, slot, usize::from(joint)));
            values.push(slots.iter().map(value).collect());
        }
        let sums: Vec<V4> = values.iter().map(|of_corner| of_corner.iter().copied().fold(lanes::ZERO, add)).collect();
        let keys: Vec<[u16; 3]> = blocks_of(below).collect();
        for (weight, triple) in cones(slots.len()) {
            // Per joint and function, its three values on the cone's vectors.
            let vectors: Vec<[[f64; 3]; 4]> = values
                .iter()
                .zip(&sums)
                .map(|(of_corner, &sum)| {
                    let on = triple.each_ref().map(|part| part.of(of_corner, sum));
                    std::array::from_fn(|f| [on[0][f], on[1][f], on[2][f]])
                })
                .collect();
            let place = |joint: u16| if joint == TOP { 0 } else { 1 + below.partition_point(|&b| b < joint) };
            for key in &keys {
                let [third, second, first] = key.map(place);
                let of_block = numbers.entry(*key).or_insert_with(|| vec![0.0; block_size(key[2], key[1], key[0])]);
                for (number, [a, b, c]) in of_block.iter_mut().zip(functions(key[2], key[1], key[0])) {
                    *number += weight * determinant(vectors[first][a], vectors[second][b], vectors[third][c]);
                }
            }
        }
    }
    Filled { numbers, moment: (volume, lanes::to(area)) }
}

/// What was found at points with so many sites that no face should go through them again.
struct Known<'a> {
    sites: &'a Sites,
    values: HashMap<(usize, u16), V4>,
}

impl Known<'_> {
    fn value(&mut self, slot: usize, joint: u16, find: impl FnOnce() -> V4) -> V4 {
        if self.sites.of_slot(slot).len() <= FEW_SITES { find() } else { *self.values.entry((slot, joint)).or_insert_with(find) }
    }
}

/// `s (p − head)` and s at a point, s the weight of the joint and all below.
fn function_values(anatomy: &Anatomy, slot: usize, joint: usize) -> V4 {
    let Anatomy { sites, tree, heads, .. } = *anatomy;
    sites.mean(slot, |site| {
        let (bones, weights) = sites.influences.of(site);
        let under = joint..usize::from(tree.ends[joint]);
        let part: f64 = bones.iter().zip(weights).filter(|(b, _)| under.contains(&usize::from(**b))).map(|(_, w)| w).sum();
        lanes::scale(about(sites.rest[site], heads[joint]), part)
    })
}

fn about(p: V4, centre: V4) -> V4 {
    let [x, y, z, _] = sub(p, centre);
    [x, y, z, 1.0]
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// A combination of a face's corners.
#[derive(Clone, Copy)]
enum Part {
    Sum,
    /// Corner minus corner.
    Edge(usize, usize),
    /// Corner minus the mean.
    Spoke(usize),
}

impl Part {
    /// `sum` of all `corners`.
    fn of(self, corners: &[V4], sum: V4) -> V4 {
        match self {
            Self::Sum => sum,
            Self::Edge(to, from) => sub(corners[to], corners[from]),
            Self::Spoke(corner) => add_scaled(corners[corner], sum, -1.0 / corners.len() as f64),
        }
    }
}

/// Determinants, with their weights, that sum to the volume of a face with so many corners [MATH §1].
fn cones(corners: usize) -> Vec<(f64, [Part; 3])> {
    match corners {
        3 => vec![(1.0 / 18.0, [Part::Sum, Part::Edge(1, 0), Part::Edge(2, 0)])],
        4 => vec![(1.0 / 24.0, [Part::Sum, Part::Edge(2, 0), Part::Edge(3, 1)])],
        _ => (0..corners)
            .map(|corner| {
                let previous = (corner + corners - 1) % corners;
                (1.0 / (6.0 * corners as f64), [Part::Sum, Part::Spoke(previous), Part::Spoke(corner)])
            })
            .collect(),
    }
}
