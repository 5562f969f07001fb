//! Chains that control rigs have cut: what a bone with weight hangs on that has no ancestor with weight.
//!
//! First where the skeleton still tells: on the bone that lies where the nearest of its ancestors lies, as deforming bones lie on
//! the bones that carry them. Else where skin tells: on the bone with which it blends, of two bones the one whose head
//! lies at the blend on the other.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use glam::DVec3;

use crate::skinning::blend::Influences;
use crate::skinning::skeleton::Skeleton;

/// Bones whose heads are this near, as part of the mesh's size, and whose directions differ by less, lie at one place.
const SAME_PLACE: f64 = 1e-3;

/// Skin that two bones of different trees share: how much, and its moment.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shared {
    pub amount: f64,
    moment: DVec3,
}

/// What the weights say of the bones.
pub(crate) struct Weighted<'a> {
    pub skeleton: &'a Skeleton,
    pub influences: &'a Influences,
    /// Vertices in armature space, with their areas.
    pub rest: &'a [DVec3],
    pub areas: &'a [f64],
    /// Weight of each bone, and of the world, and its moment.
    pub masses: Vec<f64>,
    pub moments: Vec<DVec3>,
    /// Diagonal of the box around all vertices.
    pub size: f64,
}

impl<'a> Weighted<'a> {
    /// `rest`: vertices in armature space; `areas`: of each.
    pub fn new(skeleton: &'a Skeleton, influences: &'a Influences, rest: &'a [DVec3], areas: &'a [f64]) -> Self {
        let mut masses = vec![0.0; skeleton.len() + 1];
        let mut moments = vec![DVec3::ZERO; skeleton.len() + 1];
        for (vertex, &p) in rest.iter().enumerate() {
            let (bones, weights) = influences.of(vertex);
            for (&bone, &weight) in bones.iter().zip(weights) {
                masses[bone as usize] += weight;
                moments[bone as usize] += p * weight;
            }
        }
        let low = rest.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = rest.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = if rest.is_empty() { 0.0 } else { (high - low).length() };
        Self { skeleton, influences, rest, areas, masses, moments, size }
    }

    /// Whether the head of `a` lies nearer to a blend than that of `b`; of two at one place, that of less skin.
    fn is_nearer(&self, a: u32, b: u32, shared: &Shared) -> bool {
        let place = shared.moment / shared.amount;
        let distance = |bone: u32| self.skeleton.head(bone).distance(place);
        let (of_a, of_b) = (distance(a), distance(b));
        if (of_a - of_b).abs() > SAME_PLACE * self.size {
            return of_a < of_b;
        }
        let by_mass = self.masses[a as usize].total_cmp(&self.masses[b as usize]);
        by_mass.then(of_a.total_cmp(&of_b)).then(a.cmp(&b)) == Ordering::Less
    }
}

/// Above each bone, the nearest that carries weight; chains that are cut are put together.
pub(crate) struct Hanging {
    pub parents: Vec<Option<u32>>,
    pub is_hung: Vec<bool>,
    /// Skin shared by bones whose chains are cut apart, under both orders.
    pub shared: BTreeMap<(u32, u32), Shared>,
}

impl Hanging {
    pub fn new(bones: &Weighted) -> Self {
        let Weighted { skeleton, masses, .. } = bones;
        let count = skeleton.len() as u32;
        let is_weighted = |bone: u32| masses[bone as usize] > 0.0;
        let parents: Vec<Option<u32>> = (0..count).map(|bone| skeleton.ancestors(bone).find(|&ancestor| is_weighted(ancestor))).collect();
        let mut result = Self { is_hung: vec![false; parents.len()], parents, shared: BTreeMap::new() };
        let roots: Vec<u32> = (0..count).filter(|&bone| is_weighted(bone) && result.parents[bone as usize].is_none()).collect();
        if roots.len() < 2 {
            return result;
        }
        let tree_of: Vec<u32> = (0..count).map(|bone| result.top(bone)).collect();
        result.shared = shared_skin(bones, &tree_of);
        let mut candidates = result.by_place(bones, &roots, &tree_of);
        candidates.sort_by(Candidate::compare);
        result.hang(&candidates);
        let mut candidates = result.by_skin(bones, &tree_of);
        candidates.sort_by(Candidate::compare);
        result.hang(&candidates);
        result.join(bones);
        result
    }

    fn top(&self, bone: u32) -> u32 {
        std::iter::successors(Some(bone), |&b| self.parents[b as usize]).last().unwrap_or(bone)
    }

    /// Takes what comes first for each bone, unless it hangs on that bone itself.
    fn hang(&mut self, candidates: &[Candidate]) {
        for &Candidate { root, onto, .. } in candidates {
            if self.parents[root as usize].is_none() && self.top(onto) != root {
                self.parents[root as usize] = Some(onto);
                self.is_hung[root as usize] = true;
            }
        }
    }

    /// Bones of other trees that lie where the nearest ancestor of a root lies that has such.
    fn by_place(&self, bones: &Weighted, roots: &[u32], tree_of: &[u32]) -> Vec<Candidate> {
        let Weighted { skeleton, masses, size, .. } = bones;
        let near = SAME_PLACE * size;
        let mut in_order: Vec<u32> = (0..skeleton.len() as u32).filter(|&bone| masses[bone as usize] > 0.0).collect();
        in_order.sort_by(|&a, &b| skeleton.head(a).x.total_cmp(&skeleton.head(b).x));
        let at_place = |ancestor: u32| {
            let (head, along) = (skeleton.head(ancestor), skeleton.direction(ancestor));
            let first = in_order.partition_point(|&bone| skeleton.head(bone).x < head.x - near);
            let close = in_order[first..].iter().copied().take_while(move |&bone| skeleton.head(bone).x <= head.x + near);
            close.filter(move |&bone| skeleton.head(bone).distance(head) <= near && skeleton.direction(bone).distance(along) <= SAME_PLACE)
        };
        let mut candidates = Vec::new();
        for &root in roots {
            let on = |ancestor: u32| {
                let others = at_place(ancestor).filter(|&bone| tree_of[bone as usize] != root);
                others.map(|onto| Candidate { root, onto, amount: self.amount(root, onto) }).min_by(Candidate::compare)
            };
            candidates.extend(skeleton.ancestors(root).find_map(on));
        }
        candidates
    }

    fn amount(&self, a: u32, b: u32) -> f64 {
        self.shared.get(&(a, b)).map_or(0.0, |shared| shared.amount)
    }

    /// Bones with which a root's own skin blends: those of other chains, and roots whose heads are farther from the blend.
    fn by_skin(&self, bones: &Weighted, tree_of: &[u32]) -> Vec<Candidate> {
        let own = self.shared.iter().filter(|((root, _), _)| tree_of[*root as usize] == *root);
        let hanging = own.filter(|((root, onto), shared)| tree_of[*onto as usize] != *onto || bones.is_nearer(*root, *onto, shared));
        hanging.map(|(&(root, onto), shared)| Candidate { root, onto, amount: shared.amount }).collect()
    }

    /// Joins what still is apart though it shares skin. Strongest blend first, by the skin of roots before that of others.
    fn join(&mut self, bones: &Weighted) {
        let mut tops: Vec<u32> = (0..self.parents.len() as u32).map(|bone| self.top(bone)).collect();
        let mut pairs: Vec<((u32, u32), Shared)> = self.shared.iter().map(|(&pair, &shared)| (pair, shared)).collect();
        pairs.sort_by(|a, b| b.1.amount.total_cmp(&a.1.amount).then(a.0.cmp(&b.0)));
        loop {
            // What is of one tree stays of one.
            pairs.retain(|&((a, b), _)| tops[a as usize] != tops[b as usize]);
            let joined = |by_own_skin: bool| {
                pairs.iter().find_map(|&((a, b), shared)| {
                    let (top_a, top_b) = (tops[a as usize], tops[b as usize]);
                    let is_nearer = bones.is_nearer(top_a, top_b, &shared);
                    let hangs = if by_own_skin { a == top_a && (b != top_b || is_nearer) } else { is_nearer };
                    hangs.then_some((top_a, b))
                })
            };
            let Some((root, onto)) = joined(true).or_else(|| joined(false)) else { break };
            let top = tops[onto as usize];
            tops.iter_mut().filter(|of| **of == root).for_each(|of| *of = top);
            self.parents[root as usize] = Some(onto);
            self.is_hung[root as usize] = true;
        }
    }
}

/// A root that may hang on a bone with which it shares that much skin.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    root: u32,
    onto: u32,
    amount: f64,
}

impl Candidate {
    /// More skin first.
    fn compare(a: &Self, b: &Self) -> Ordering {
        b.amount.total_cmp(&a.amount).then((a.root, a.onto).cmp(&(b.root, b.onto)))
    }
}

/// Skin shared by bones of different trees.
fn shared_skin(bones: &Weighted, tree_of: &[u32]) -> BTreeMap<(u32, u32), Shared> {
    let mut shared: BTreeMap<(u32, u32), Shared> = BTreeMap::new();
    for (vertex, (&p, area)) in bones.rest.iter().zip(bones.areas).enumerate() {
        let (row, weights) = bones.influences.of(vertex);
        let of_bones = || row.iter().zip(weights).filter(|(bone, _)| usize::from(**bone) < tree_of.len());
        for (&a, &of_a) in of_bones() {
            for (&b, &of_b) in of_bones().filter(|(b, _)| tree_of[usize::from(**b)] != tree_of[usize::from(a)]) {
                let amount = of_a * of_b * area;
                if amount > 0.0 {
                    let sum = shared.entry((u32::from(a), u32::from(b))).or_default();
                    *sum = Shared { amount: sum.amount + amount, moment: sum.moment + p * amount };
                }
            }
        }
    }
    shared
}
