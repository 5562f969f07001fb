//! The closest point of a spine, exact: no local minimum is missed.
//!
//! Along a cell the distance to p is least where g(u) = (C(u) − p)·C′(u), a polynomial of degree nine, rises through 0. Its
//! Bernstein coefficients are linear in p, and no more roots lie between 0 and 1 than they change sign (Descartes): cells are
//! halved until one root is left in each part, and Newton's method within that bracket finds it. A tree of boxes leaves out
//! cells that are farther than what was found.

use glam::DVec3;

use crate::spine::cells::Cells;
use crate::spine::quintic::{Quintic, binomial};

/// Degree of (C − p)·C′.
const DEGREE: usize = 9;
/// Halvings of a cell: roots nearer to each other than this are a centre of curvature, one place.
const HALVINGS: usize = 16;
const NEWTON_STEPS: usize = 60;
/// Relative difference of squared distances below which two places are as near.
const TIE: f64 = 1e-9;
/// Relative difference of squared distances that rounding leaves: of two places the first along the spine is taken.
const SAME: f64 = 1e-13;
/// Part of the parameter's range within which two places are one.
const ONE_PLACE: f64 = 1e-6;
/// 1 − k·p below which a point counts as a centre of curvature.
const CENTRE: f64 = 1e-6;
/// g at the end of a cell, relative to its terms, below which it may have either sign by rounding.
const ROUNDING: f64 = 1e-12;

/// The place of a spine that is closest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Closest {
    pub cell: usize,
    /// Place in the cell; of the outermost cells, beyond the spine's end on its tangent.
    pub u: f64,
    pub distance: f64,
    /// Another place is as near, or the point is a centre of curvature.
    pub is_ambiguous: bool,
}

/// Search structure of one spine.
#[derive(Debug)]
pub(crate) struct Search {
    cells: Vec<Distance>,
    /// Boxes of a binary tree: children of node i are 2i + 1 and 2i + 2, leaves are the last `leaf_count`.
    boxes: Vec<[DVec3; 2]>,
    leaf_count: usize,
}

/// g of one cell for any point.
#[derive(Debug)]
struct Distance {
    piece: Quintic,
    /// Bernstein coefficients of (C − origin)·C′ and of C′, both of degree nine.
    own: [f64; DEGREE + 1],
    velocity: [DVec3; DEGREE + 1],
    origin: DVec3,
    speed: f64,
}

/// A local minimum.
#[derive(Clone, Copy)]
struct Candidate {
    square: f64,
    cell: usize,
    u: f64,
}

/// The nearest local minimum so far, and the nearest of those elsewhere.
struct Found {
    best: Candidate,
    rival: f64,
    /// Square of a distance that the spine does not exceed.
    bound: f64,
}

impl Distance {
    fn new(piece: &Quintic) -> Self {
        let origin = piece.at(0.5);
        let mut c = piece.0;
        c[0] -= origin;
        // Coefficients of powers first, then of Bernstein polynomials.
        let mut powers = [0.0; DEGREE + 1];
        let mut velocity_powers = [DVec3::ZERO; DEGREE + 1];
        for j in 1..6 {
            velocity_powers[j - 1] = c[j] * j as f64;
        }
        for i in 0..6 {
            for j in 0..5 {
                powers[i + j] += c[i].dot(velocity_powers[j]);
            }
        }
        let share = |j: usize, i: usize| binomial(j, i) / binomial(DEGREE, i);
        let own = std::array::from_fn(|j| (0..=j).map(|i| powers[i] * share(j, i)).sum());
        let velocity: [DVec3; DEGREE + 1] = std::array::from_fn(|j| (0..=j).map(|i| velocity_powers[i] * share(j, i)).sum());
        let speed = velocity.iter().map(|v| v.length()).fold(0.0, f64::max);
        Self { piece: *piece, own, velocity, origin, speed }
    }

    /// Bernstein coefficients of g.
    fn coefficients(&self, p: DVec3) -> [f64; DEGREE + 1] {
        let d = p - self.origin;
        std::array::from_fn(|j| self.own[j] - self.velocity[j].dot(d))
    }

    /// Calls `found` for every place at which g rises through 0.
    fn minima(&self, p: DVec3, is_first: bool, is_last: bool, found: &mut impl FnMut(f64)) {
        let g = self.coefficients(p);
        let noise = ROUNDING * self.speed * (self.speed + p.distance(self.origin));
        if g[0] >= 0.0 && (is_first || g[0] <= noise) {
            found(0.0);
        }
        if g[DEGREE] <= 0.0 && (is_last || g[DEGREE] >= -noise) {
            found(1.0);
        }
        self.isolate(p, &g, [0.0, 1.0], HALVINGS, found);
    }

    fn isolate(&self, p: DVec3, g: &[f64; DEGREE + 1], [from, to]: [f64; 2], halvings: usize, found: &mut impl FnMut(f64)) {
        let (mut changes, mut sign) = (0, 0.0);
        for &value in g {
            if value * sign < 0.0 {
                changes += 1;
            }
            if value != 0.0 {
                sign = value.signum();
            }
        }
        if changes == 0 {
            return;
        }
        if changes == 1 || halvings == 0 {
            if g[0] < 0.0 && g[DEGREE] > 0.0 {
                found(self.root(p, [from, to]));
            }
            return;
        }
        let (mut left, mut right) = (*g, *g);
        for level in 1..=DEGREE {
            for i in (level..=DEGREE).rev() {
                left[i] = 0.5 * (left[i - 1] + left[i]);
            }
            for i in 0..=DEGREE - level {
                right[i] = 0.5 * (right[i] + right[i + 1]);
            }
        }
        let middle = 0.5 * (from + to);
        if left[DEGREE] == 0.0 {
            found(middle);
        }
        self.isolate(p, &left, [from, middle], halvings - 1, found);
        self.isolate(p, &right, [middle, to], halvings - 1, found);
    }

    /// The root of g in a bracket over which it rises.
    fn root(&self, p: DVec3, [mut low, mut high]: [f64; 2]) -> f64 {
        let mut u = 0.5 * (low + high);
        let mut step_before = high - low;
        for _ in 0..NEWTON_STEPS {
            let [position, first, second, _] = self.piece.derivatives(u);
            let to_curve = position - p;
            let g = to_curve.dot(first);
            if g > 0.0 {
                high = u;
            } else {
                low = u;
            }
            let newton = u - g / (first.length_squared() + to_curve.dot(second));
            let is_inside = low <= newton && newton <= high && (newton - u).abs() <= 0.5 * step_before.abs();
            let next = if is_inside { newton } else { 0.5 * (low + high) };
            let step = next - u;
            u = next;
            if step.abs() <= f64::EPSILON {
                break;
            }
            step_before = step;
        }
        u
    }
}

impl Search {
    /// `parts`: the cells between the rays.
    pub fn new(parts: &[Quintic]) -> Self {
        let leaf_count = parts.len().next_power_of_two();
        let nowhere = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let mut boxes = vec![nowhere; 2 * leaf_count - 1];
        for (leaf, part) in boxes[leaf_count - 1..].iter_mut().zip(parts) {
            *leaf = part.control_points().iter().fold(nowhere, |[low, high], &b| [low.min(b), high.max(b)]);
        }
        for i in (0..leaf_count - 1).rev() {
            let ([a, b], [c, d]) = (boxes[2 * i + 1], boxes[2 * i + 2]);
            boxes[i] = [a.min(c), b.max(d)];
        }
        Self { cells: parts.iter().map(Distance::new).collect(), boxes, leaf_count }
    }

    /// The place of `cells` closest to `p`.
    pub fn closest(&self, cells: &Cells, p: DVec3) -> Closest {
        let range = cells.breaks()[cells.breaks().len() - 1] - cells.breaks()[0];
        let mut found = Found { best: Candidate { square: f64::INFINITY, cell: 1, u: 0.0 }, rival: f64::INFINITY, bound: f64::MAX };
        let mut stack = [(0u32, 0.0); 64];
        stack[0].1 = self.distance_squared(0, p);
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (node, least) = stack[height];
            if least > found.bound * (1.0 + 2.0 * TIE) {
                continue;
            }
            let node = node as usize;
            if node >= self.leaf_count - 1 {
                let cell = node + 1 - self.leaf_count;
                if cell < self.cells.len() {
                    self.visit(cells, cell, p, range, &mut found);
                }
                continue;
            }
            let children = [2 * node + 1, 2 * node + 2].map(|child| (child as u32, self.distance_squared(child, p)));
            let far_first = if children[0].1 <= children[1].1 { [children[1], children[0]] } else { children };
            for child in far_first {
                stack[height] = child;
                height += 1;
            }
        }
        let Candidate { square, mut cell, mut u } = found.best;
        let is_tie = found.rival <= square * (1.0 + TIE);
        // Beyond an end the tangent goes on.
        let last = self.cells.len();
        let along = |u: f64, cell: usize| {
            let [position, first, ..] = self.cells[cell - 1].piece.derivatives(u);
            (p - position).dot(first) / first.length_squared()
        };
        if cell == 1 && u == 0.0 && along(0.0, 1) < 0.0 {
            (cell, u) = (0, along(0.0, 1));
        } else if cell == last && u == 1.0 && along(1.0, last) > 0.0 {
            (cell, u) = (last + 1, along(1.0, last));
        }
        let station = cells.station(cell, u);
        let offset = p - DVec3::from(station.position);
        let offset_in_plane = [offset.dot(station.normal.into()), offset.dot(station.binormal.into())];
        let towards_centre = offset_in_plane[0] * station.curvature[0] + offset_in_plane[1] * station.curvature[1];
        Closest { cell, u, distance: offset.length(), is_ambiguous: is_tie || towards_centre > 1.0 - CENTRE }
    }

    fn visit(&self, cells: &Cells, cell: usize, p: DVec3, range: f64, found: &mut Found) {
        let distance = &self.cells[cell];
        let (is_first, is_last) = (cell == 0, cell + 1 == self.cells.len());
        found.bound = found.bound.min(distance.piece.0[0].distance_squared(p));
        distance.minima(p, is_first, is_last, &mut |u| {
            let new = Candidate { square: distance.piece.at(u).distance_squared(p), cell: cell + 1, u };
            let best = found.best;
            let parameter = |candidate: &Candidate| cells.parameter(candidate.cell, candidate.u);
            let is_elsewhere = (parameter(&new) - parameter(&best)).abs() > ONE_PLACE * range;
            let is_earlier = (new.cell, new.u) < (best.cell, best.u);
            let is_nearer = new.square < best.square * (1.0 - SAME) || new.square <= best.square * (1.0 + SAME) && is_earlier;
            if is_elsewhere {
                found.rival = found.rival.min(if is_nearer { best.square } else { new.square });
            }
            if is_nearer {
                found.best = new;
                found.bound = found.bound.min(new.square);
            }
        });
    }

    fn distance_squared(&self, node: usize, p: DVec3) -> f64 {
        let [low, high] = self.boxes[node];
        (low - p).max(p - high).max(DVec3::ZERO).length_squared()
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.cells) + size_of_val(&*self.boxes)
    }
}
