//! How far points go back along their displacement until nothing new passes through anything.

use glam::DVec3;

use super::ease::eased;
use super::search::Search;
use super::skin::Skin;
use crate::numeric::union_find::UnionFind;

/// Rounds in which folds are backed off; each takes in at least one more point, or takes some further back.
const ROUNDS: usize = 20;
/// From this round on clusters go back the whole way at once, and take in their neighbours.
const PATIENCE: usize = 6;
/// Halvings of the part of the way that a cluster keeps.
const HALVINGS: usize = 4;
/// Changes fade out over so many times the largest displacement of their cluster.
const EASE: f64 = 4.0;

/// Points that took part in a fold: where they stand, and what they do to those around.
pub(crate) struct BackOff<'a> {
    skin: &'a Skin,
    skinned: &'a [DVec3],
    /// Whole displacement of each point.
    moves: &'a [DVec3],
    is_blocked: Vec<bool>,
    /// Part of its displacement that each blocked point's cluster keeps; of others 1.
    parts: Vec<f64>,
    /// Blocked points that took part in one fold.
    links: Vec<(u32, u32)>,
}

/// Blocked points that hang together.
struct Cluster {
    points: Vec<u32>,
    /// Points around, and how free each is.
    eased: Vec<(u32, f64)>,
    part: f64,
}

impl<'a> BackOff<'a> {
    pub fn new(skin: &'a Skin, skinned: &'a [DVec3], moves: &'a [DVec3]) -> Self {
        let count = skinned.len();
        Self { skin, skinned, moves, is_blocked: vec![false; count], parts: vec![1.0; count], links: Vec::new() }
    }

    /// Whether a point took part in a fold.
    pub fn is_blocked(&self) -> &[bool] {
        &self.is_blocked
    }

    /// Blocks the points of folds that can go back; whether one of them was not blocked before.
    pub fn block(&mut self, search: &Search, takes_neighbours: bool) -> bool {
        let mut is_more = false;
        for &pair in search.pairs() {
            let mut previous = None;
            let corners: Vec<u32> = search.corners(pair).filter(|&point| self.can_go_back(point)).collect();
            let around = corners.iter().flat_map(|&point| self.skin.neighbours.row(point as usize));
            let around: Vec<u32> = around.copied().filter(|&point| takes_neighbours && self.can_go_back(point)).collect();
            for point in corners.into_iter().chain(around) {
                is_more |= !std::mem::replace(&mut self.is_blocked[point as usize], true);
                self.links.extend(previous.map(|previous| (previous, point)));
                previous = Some(point);
            }
        }
        is_more
    }

    fn can_go_back(&self, point: u32) -> bool {
        self.moves[point as usize] != DVec3::ZERO
    }

    /// Takes clusters back until there is no fold with the points at skinned + share · displacement.
    ///
    /// Returns the share of its displacement that each point keeps; `search` is left there, with folds only where this
    /// failed. A cluster never goes forward again, so that this ends.
    pub fn shares(&mut self, search: &mut Search) -> Vec<f64> {
        let mut shares = vec![1.0; self.moves.len()];
        for round in 0..ROUNDS {
            if search.pairs().is_empty() {
                break;
            }
            let is_late = round >= PATIENCE;
            self.block(search, is_late);
            let (mut clusters, cluster_of_point) = self.clusters();
            let is_open = in_fold(search, &cluster_of_point, clusters.len());
            let open = |clusters: &mut [Cluster], part: &dyn Fn(usize) -> f64| {
                for (index, cluster) in clusters.iter_mut().enumerate().filter(|(index, _)| is_open[*index]) {
                    cluster.part = part(index);
                }
            };
            let mut bounds: Vec<(f64, f64)> = clusters.iter().map(|cluster| (0.0, cluster.part)).collect();
            for step in 0..if is_late { 0 } else { HALVINGS + 1 } {
                if bounds.iter().zip(&is_open).all(|((low, high), is_open)| !is_open || low == high) {
                    break;
                }
                // That points have joined may be all that was needed.
                let middle = |(low, high): (f64, f64)| if step == 0 { high } else { 0.5 * (low + high) };
                open(&mut clusters, &|index| middle(bounds[index]));
                search.move_to(self.places(&self.shares_of(&clusters)));
                let is_in_fold = in_fold(search, &cluster_of_point, clusters.len());
                for ((bound, cluster), is_in_fold) in bounds.iter_mut().zip(&clusters).zip(is_in_fold) {
                    *bound = if is_in_fold { (bound.0, cluster.part) } else { (bound.0.max(cluster.part), bound.1) };
                }
            }
            open(&mut clusters, &|index| bounds[index].0);
            for cluster in &clusters {
                for &point in &cluster.points {
                    self.parts[point as usize] = cluster.part;
                }
            }
            shares = self.shares_of(&clusters);
            search.move_to(self.places(&shares));
        }
        shares
    }

    /// How free each point is: 0 where blocked, 1 far from all that is.
    pub fn freedom(&self) -> Vec<f64> {
        let (mut clusters, _) = self.clusters();
        for cluster in &mut clusters {
            cluster.part = 0.0;
        }
        self.shares_of(&clusters)
    }

    fn places(&self, shares: &[f64]) -> Vec<DVec3> {
        self.skinned.iter().zip(self.moves).zip(shares).map(|((p, u), share)| *p + *u * *share).collect()
    }

    fn shares_of(&self, clusters: &[Cluster]) -> Vec<f64> {
        let mut shares = vec![1.0f64; self.moves.len()];
        for cluster in clusters {
            for &(point, free) in &cluster.eased {
                let share = &mut shares[point as usize];
                *share = share.min(cluster.part + (1.0 - cluster.part) * free);
            }
        }
        shares
    }

    /// Clusters in the order of their first points, and the cluster of each point.
    fn clusters(&self) -> (Vec<Cluster>, Vec<Option<u32>>) {
        let mut sets = UnionFind::new(self.moves.len());
        for &(a, b) in &self.links {
            sets.join(a, b);
        }
        let blocked = || (0..self.moves.len() as u32).filter(|&point| self.is_blocked[point as usize]);
        for point in blocked() {
            for &other in self.skin.neighbours.row(point as usize).iter().filter(|&&other| self.is_blocked[other as usize]) {
                sets.join(point, other);
            }
        }
        let mut clusters: Vec<Cluster> = Vec::new();
        let mut cluster_of_point = vec![None; self.moves.len()];
        for point in blocked() {
            // A set is named by its smallest point, which comes first.
            let root = sets.find(point) as usize;
            let index = *cluster_of_point[root].get_or_insert(clusters.len() as u32);
            if index as usize == clusters.len() {
                clusters.push(Cluster { points: Vec::new(), eased: Vec::new(), part: 1.0 });
            }
            cluster_of_point[point as usize] = Some(index);
            let cluster = &mut clusters[index as usize];
            cluster.points.push(point);
            cluster.part = cluster.part.min(self.parts[point as usize]);
        }
        for cluster in &mut clusters {
            let longest = cluster.points.iter().map(|&point| self.moves[point as usize].length()).fold(0.0, f64::max);
            cluster.eased = eased(self.skin, self.skinned, &cluster.points, EASE * longest);
        }
        (clusters, cluster_of_point)
    }
}

/// Which clusters have points in folds.
fn in_fold(search: &Search, cluster_of_point: &[Option<u32>], count: usize) -> Vec<bool> {
    let mut found = vec![false; count];
    for point in search.pairs().iter().flat_map(|&pair| search.corners(pair)) {
        if let Some(cluster) = cluster_of_point[point as usize] {
            found[cluster as usize] = true;
        }
    }
    found
}
