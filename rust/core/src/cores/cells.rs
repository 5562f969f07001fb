//! Cells of a core: farthest points of it, and which part of each point is whose.
//!
//! Nothing depends on the order of points: of places that are equally far all become cells, one for those that coincide.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use crate::cores::balls::Balls;
use crate::cores::rest::RestSurface;
use crate::numeric::csr::Csr;
use crate::numeric::nearness::PointTree;
use crate::numeric::union_find::UnionFind;

/// Farther than this from every cell, by the ball of the cell, a place becomes one.
const SPACING: f64 = 0.5;
/// Places whose distances differ by less, relatively, are equally far.
const TIE: f64 = 1e-6;
/// Equally far places closer than this, by their balls, coincide, unless a row of such is longer than the other.
const COINCIDENT: f64 = 0.05;
const ROW: f64 = 0.25;
/// Smaller shares are left out.
const SHARE_MIN: f64 = 0.03;
/// No direction of any usual mesh: tells apart what distances do not.
const ODD: DVec3 = DVec3::new(0.781_3, 0.553_7, 0.288_9);

/// Cells of a body.
pub(crate) struct Cells {
    /// Per slot: cells and shares, which sum to 1; empty where a slot has no face.
    pub shares: Csr<(u32, f64)>,
    /// Component and radius of each cell.
    pub balls: Vec<(u32, f64)>,
}

/// Cells of a core, and whose part each point is.
pub(crate) fn cells(rest: &RestSurface, balls: &Balls) -> Cells {
    let mut chosen = Chosen { balls, cells: Vec::new(), left: vec![f64::INFINITY; rest.places.len()], found: Vec::new() };
    for (component, slots) in rest.slots_of_component.rows().enumerate() {
        chosen.choose(component as u32, slots, &rest.areas);
    }
    let all = Csr::from_pairs(rest.places.len(), &chosen.found);
    let mut shares = Csr::default();
    for row in all.rows() {
        let whole: f64 = row.iter().map(|share| share.1).sum();
        let kept = || row.iter().filter(|share| share.1 >= SHARE_MIN * whole);
        let sum: f64 = kept().map(|share| share.1).sum();
        shares.push_row(kept().map(|share| (share.0, share.1 / sum)));
    }
    Cells { shares, balls: chosen.cells }
}

struct Chosen<'a> {
    balls: &'a Balls,
    /// Component and radius of each cell.
    cells: Vec<(u32, f64)>,
    /// Distance to the nearest cell so far, by its ball.
    left: Vec<f64>,
    /// Slot, cell and weight.
    found: Vec<(u32, (u32, f64))>,
}

/// A slot, by distance; the first of them where that is the same.
#[derive(PartialEq)]
struct Far(f64, u32);

impl Eq for Far {}

impl PartialOrd for Far {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Far {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

impl Chosen<'_> {
    fn choose(&mut self, component: u32, slots: &[u32], areas: &[f64]) {
        if slots.is_empty() {
            return;
        }
        let centres = &self.balls.centres;
        let tree = PointTree::new(centres, slots.to_vec());
        let whole: f64 = slots.iter().map(|&slot| areas[slot as usize]).sum();
        let sum: DVec3 = slots.iter().map(|&slot| centres[slot as usize] * areas[slot as usize]).sum();
        let middle = if whole > 0.0 { sum / whole } else { DVec3::ZERO };
        // The first: the ends of the body.
        let distance = |slot: u32| centres[slot as usize].distance(middle);
        let farthest = slots.iter().map(|&slot| distance(slot)).fold(0.0, f64::max);
        let ends: Vec<u32> = slots.iter().copied().filter(|&slot| distance(slot) >= farthest * (1.0 - TIE)).collect();
        self.add_tied(component, &ends, f64::INFINITY, &tree);
        let mut far: BinaryHeap<Far> = slots.iter().map(|&slot| Far(self.left[slot as usize], slot)).collect();
        let mut ties = Vec::new();
        while let Some(Far(distance, slot)) = far.pop() {
            let now = self.left[slot as usize];
            if now < distance {
                far.push(Far(now, slot));
                continue;
            }
            if distance.is_nan() || distance < SPACING {
                break;
            }
            ties.clear();
            ties.push(slot);
            while let Some(Far(other, tied)) = far.peek().map(|far| Far(far.0, far.1)).filter(|far| far.0 >= distance * (1.0 - TIE)) {
                far.pop();
                let now = self.left[tied as usize];
                if now < other { far.push(Far(now, tied)) } else { ties.push(tied) }
            }
            self.add_tied(component, &ties, distance, &tree);
            far.extend(ties.iter().map(|&slot| Far(self.left[slot as usize], slot)));
        }
    }

    /// Makes cells of equally far places. No point is farther than `reach` from what cells there are.
    fn add_tied(&mut self, component: u32, ties: &[u32], reach: f64, tree: &PointTree) {
        let balls = self.balls;
        let thinnest = ties.iter().map(|&slot| balls.radii[slot as usize]).fold(f64::INFINITY, f64::min);
        let mut groups = vec![ties.to_vec()];
        if ties.len() > 1 {
            let places: Vec<DVec3> = ties.iter().map(|&slot| balls.centres[slot as usize]).collect();
            let mut sets = UnionFind::new(ties.len());
            PointTree::new(&places, (0..ties.len() as u32).collect()).join_within(COINCIDENT * thinnest, &mut sets);
            let pairs: Vec<(u32, u32)> = (0..ties.len() as u32).map(|i| (sets.find(i), ties[i as usize])).collect();
            groups = Csr::from_pairs(ties.len(), &pairs).rows().filter(|group| !group.is_empty()).map(<[u32]>::to_vec).collect();
        }
        for group in groups {
            let mean = |of: &dyn Fn(usize) -> DVec3| group.iter().map(|&slot| of(slot as usize)).sum::<DVec3>() / group.len() as f64;
            let mut centre = mean(&|slot| balls.centres[slot]);
            let mut radius = mean(&|slot| DVec3::splat(balls.radii[slot])).x;
            if group.iter().any(|&slot| balls.centres[slot as usize].distance(centre) > ROW * radius) {
                let along = |slot: u32| balls.centres[slot as usize].dot(ODD);
                let odd = group.iter().copied().max_by(|&a, &b| along(a).total_cmp(&along(b))).unwrap_or(group[0]) as usize;
                (centre, radius) = (balls.centres[odd], balls.radii[odd]);
            }
            self.add(component, centre, radius, reach, tree);
        }
    }

    fn add(&mut self, component: u32, centre: DVec3, radius: f64, reach: f64, tree: &PointTree) {
        let cell = self.cells.len() as u32;
        self.cells.push((component, radius));
        let centres = &self.balls.centres;
        tree.for_each_within(centre, reach.max(1.0) * radius, |slot| {
            let distance = centres[slot as usize].distance(centre);
            // Without extent all lies at the centre.
            let t = if distance > 0.0 { distance / radius } else { 0.0 };
            if t < 1.0 {
                self.found.push((slot, (cell, (1.0 - t).powi(4) * (4.0 * t + 1.0))));
            }
            let left = &mut self.left[slot as usize];
            *left = left.min(t);
        });
    }
}
