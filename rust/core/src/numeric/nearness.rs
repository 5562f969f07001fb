//! Which of many points are near to each other: a tree of boxes, so that time does not grow with the square of points in one
//! place.

use std::ops::Range;

use glam::DVec3;

use crate::numeric::union_find::UnionFind;

/// Points of a leaf.
const LEAF: usize = 8;
/// Boxes that are smaller, or closer, than a distance by this part of it are so whatever rounding does.
const CERTAIN: f64 = 1e-9;

struct Node {
    low: DVec3,
    high: DVec3,
    /// Places in `order`.
    range: Range<usize>,
    /// Both halves; `None` for a leaf.
    halves: Option<[usize; 2]>,
}

/// Boxes in boxes, halved at medians.
pub(crate) struct PointTree<'a> {
    points: &'a [DVec3],
    order: Vec<u32>,
    nodes: Vec<Node>,
}

impl<'a> PointTree<'a> {
    /// A tree over some of the points.
    pub fn new(points: &'a [DVec3], some: Vec<u32>) -> Self {
        let mut tree = Self { points, order: some, nodes: Vec::new() };
        if !tree.order.is_empty() {
            tree.grow(0..tree.order.len());
        }
        tree
    }

    fn grow(&mut self, range: Range<usize>) -> usize {
        let places = self.order[range.clone()].iter().map(|&i| self.points[i as usize]);
        let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let node = self.nodes.len();
        self.nodes.push(Node { low, high, range: range.clone(), halves: None });
        if range.len() > LEAF {
            let sides = high - low;
            let axis = (0..3).fold(0, |longest, axis| if sides[axis] > sides[longest] { axis } else { longest });
            let half = range.len() / 2;
            let points = self.points;
            self.order[range.clone()]
                .select_nth_unstable_by(half, |&a, &b| points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b)));
            let halves = [self.grow(range.start..range.start + half), self.grow(range.start + half..range.end)];
            self.nodes[node].halves = Some(halves);
        }
        node
    }

    /// Joins all points that are not farther apart than `distance`.
    pub fn join_within(&self, distance: f64, sets: &mut UnionFind) {
        if !self.nodes.is_empty() {
            self.join(distance, 0, 0, sets);
        }
    }

    fn join(&self, distance: f64, a: usize, b: usize, sets: &mut UnionFind) {
        #[cfg(test)]
        tests::LOOKS.set(tests::LOOKS.get() + 1);
        let (one, other) = (&self.nodes[a], &self.nodes[b]);
        let gap = (one.low - other.high).max(other.low - one.high).max_element();
        if gap > distance * (1.0 + CERTAIN) {
            return;
        }
        let first = |node: &Node| self.order[node.range.start];
        let is_one = |node: &Node| node.low.distance(node.high) <= distance * (1.0 - CERTAIN);
        if a == b && is_one(one) {
            for &i in &self.order[one.range.clone()] {
                sets.join(first(one), i);
            }
            return;
        }
        // The points of small boxes are joined among each other: one pair is enough.
        if a != b && is_one(one) && is_one(other) && sets.find(first(one)) == sets.find(first(other)) {
            return;
        }
        match (one.halves, other.halves) {
            (Some([left, right]), _) if a == b => {
                self.join(distance, left, left, sets);
                self.join(distance, right, right, sets);
                self.join(distance, left, right, sets);
            }
            (Some(halves), _) if one.range.len() >= other.range.len() || other.halves.is_none() => {
                for half in halves {
                    self.join(distance, half, b, sets);
                }
            }
            (_, Some(halves)) => {
                for half in halves {
                    self.join(distance, a, half, sets);
                }
            }
            _ => {
                for &i in &self.order[one.range.clone()] {
                    for &j in &self.order[other.range.clone()] {
                        if self.points[i as usize].distance_squared(self.points[j as usize]) <= distance * distance {
                            sets.join(i, j);
                        }
                    }
                }
            }
        }
    }

    /// Visits all points that are not farther than `distance` from a place, and perhaps others.
    pub fn for_each_within(&self, place: DVec3, distance: f64, mut visit: impl FnMut(u32)) {
        let mut open: Vec<usize> = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(index) = open.pop() {
            let node = &self.nodes[index];
            if place.clamp(node.low, node.high).distance(place) > distance * (1.0 + CERTAIN) {
                continue;
            }
            match node.halves {
                Some(halves) => open.extend(halves),
                None => self.order[node.range.clone()].iter().for_each(|&i| visit(i)),
            }
        }
    }

    /// The nearest point to a place that is not farther than `distance`, the first one of those equally near.
    pub fn nearest(&self, place: DVec3, distance: f64) -> Option<u32> {
        let mut best: Option<(f64, u32)> = None;
        let mut open: Vec<usize> = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(index) = open.pop() {
            let node = &self.nodes[index];
            let reach = best.map_or(distance, |(found, _)| found);
            if place.clamp(node.low, node.high).distance(place) > reach * (1.0 + CERTAIN) {
                continue;
            }
            if let Some([left, right]) = node.halves {
                let to = |half: usize| place.clamp(self.nodes[half].low, self.nodes[half].high).distance_squared(place);
                open.extend(if to(left) <= to(right) { [right, left] } else { [left, right] });
                continue;
            }
            for &i in &self.order[node.range.clone()] {
                let far = self.points[i as usize].distance(place);
                if far <= distance && best.is_none_or(|(least, first)| far < least || far == least && i < first) {
                    best = Some((far, i));
                }
            }
        }
        best.map(|(_, point)| point)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::prelude::*;

    use super::*;

    thread_local! {
        /// Pairs of boxes that were looked at.
        pub(super) static LOOKS: Cell<usize> = const { Cell::new(0) };
    }

    fn looks(points: &[DVec3], distance: f64) -> usize {
        LOOKS.set(0);
        PointTree::new(points, (0..points.len() as u32).collect()).join_within(distance, &mut UnionFind::new(points.len()));
        LOOKS.get()
    }

    #[test]
    fn work_grows_with_the_points_however_they_lie() {
        let spread = |i: usize, at: f64| DVec3::new((i as f64 * 0.618_034).fract(), (i as f64 * 0.414_214).fract(), at);
        let layouts: [fn(usize) -> DVec3; 3] =
            [|_| DVec3::ONE, |i| DVec3::splat((i / 2) as f64), |i| DVec3::new((i % 1000) as f64, (i / 1000) as f64, 0.0)];
        for (layout, distance) in layouts.into_iter().zip([1e-6, 1e-3, 1e-3]) {
            let [some, twice] = [8000, 16000].map(|count| looks(&(0..count).map(layout).collect::<Vec<_>>(), distance));
            assert!(twice < 5 * some / 2, "{some} {twice}");
        }
        // All within the distance, spread out; two such clouds just out of reach of each other.
        for gap in [0.0, 3.1] {
            let cloud = |count: usize| (0..count).map(|i| spread(i, if i % 2 == 0 { 0.0 } else { gap })).collect::<Vec<_>>();
            let [some, twice] = [8000, 16000].map(|count| looks(&cloud(count), 3.0));
            assert!(twice < 5 * some / 2, "{some} {twice}");
        }
    }

    /// Clusters of points, some at one place, in a box of side 1.
    fn clusters() -> impl Strategy<Value = Vec<DVec3>> {
        let place = prop::array::uniform3(0u8..5).prop_map(|at| DVec3::from_array(at.map(|x| f64::from(x) * 0.25)));
        let near = prop::array::uniform3(-4i8..=4).prop_map(|at| DVec3::from_array(at.map(|x| f64::from(x) * 0.01)));
        prop::collection::vec((place, near).prop_map(|(place, near)| place + near), 0..120)
    }

    proptest! {
        #[test]
        fn points_are_joined_as_all_pairs_say(points in clusters(), distance in 0.0..0.3f64) {
            let mut sets = UnionFind::new(points.len());
            PointTree::new(&points, (0..points.len() as u32).collect()).join_within(distance, &mut sets);
            let mut plain = UnionFind::new(points.len());
            for (i, p) in points.iter().enumerate() {
                for (j, q) in points.iter().enumerate().skip(i + 1) {
                    if p.distance_squared(*q) <= distance * distance {
                        plain.join(i as u32, j as u32);
                    }
                }
            }
            for i in 0..points.len() as u32 {
                prop_assert_eq!(sets.find(i), plain.find(i));
            }
        }

        #[test]
        fn the_nearest_is_the_first_of_the_nearest(points in clusters(), place in prop::array::uniform3(0u8..9), distance in 0.0..1.0f64) {
            let place = DVec3::from_array(place.map(|x| f64::from(x) * 0.125));
            let all = points.iter().enumerate().map(|(i, p)| (p.distance(place), i as u32)).filter(|found| found.0 <= distance);
            let plain = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|found| found.1);
            prop_assert_eq!(PointTree::new(&points, (0..points.len() as u32).collect()).nearest(place, distance), plain);
        }
    }
}
