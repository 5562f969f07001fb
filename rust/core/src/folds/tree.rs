//! A hierarchy of boxes over triangles, made once; a frame only fits the boxes.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

/// Marks links of leaves: the rest is the triangle, else the first of two children, which are neighbours.
const LEAF: u32 = 1 << 31;
/// Pairs of nodes that are handed to threads; so many that none waits long.
const TASKS: usize = 512;
/// Boxes of a parallel piece, at least.
const CHUNK: usize = 4096;

/// Which boxes lie in which. The root is first, children come after their parents.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tree {
    links: Vec<u32>,
}

/// The box of a node in one frame, rounded outwards.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fitted {
    low: [f32; 3],
    high: [f32; 3],
    /// Whether anything in it is looked at; pairs of nodes without any are passed over.
    is_looked_at: bool,
}

impl Tree {
    /// Over triangles at rest; what comes of a tree does not depend on how it is made.
    pub fn new(triangles: &[[u32; 3]], points: &[DVec3]) -> Self {
        if triangles.is_empty() {
            return Self::default();
        }
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let size = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        // Single precision holds any mesh that is made as large as 1.
        let scale = size.max_element().max(f64::MIN_POSITIVE).recip().min(f64::MAX);
        let small = |i: u32| Vec3A::from(((points[i as usize] - low) * scale).as_vec3());
        let boxes: Vec<Aabb> = triangles.iter().map(|corners| Aabb::from_points(&corners.map(small))).collect();
        let all = (0..triangles.len() as u32).collect();
        let mut made = PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, all, SortPrecision::U64, 0);
        made.reorder_in_stack_traversal_order();
        let triangle = |first: u32| made.primitive_indices[first as usize];
        let link = |node: &obvhs::bvh2::node::Bvh2Node| if node.is_leaf() { LEAF | triangle(node.first_index) } else { node.first_index };
        Self { links: made.nodes.iter().map(link).collect() }
    }

    /// Boxes of all nodes around triangles as they stand; none is looked at.
    pub fn fit(&self, triangles: &[[u32; 3]], points: &[DVec3]) -> Vec<Fitted> {
        let mut fitted = vec![Fitted { low: [0.0; 3], high: [0.0; 3], is_looked_at: false }; self.links.len()];
        self.refit(&mut fitted, triangles, points, &vec![true; triangles.len()]);
        fitted
    }

    /// The boxes after some triangles moved: these are looked at.
    pub fn refit(&self, fitted: &mut [Fitted], triangles: &[[u32; 3]], points: &[DVec3], has_moved: &[bool]) {
        fitted.par_iter_mut().zip(&self.links).with_min_len(CHUNK).for_each(|(fitted, &link)| {
            let triangle = (link & !LEAF) as usize;
            if link & LEAF != 0 {
                fitted.is_looked_at = has_moved[triangle];
                if has_moved[triangle] {
                    *fitted = around(triangles[triangle].map(|i| points[i as usize]));
                }
            }
        });
        for node in (0..self.links.len()).rev() {
            if let Some([a, b]) = self.children(node as u32) {
                let (a, b) = (&fitted[a as usize], &fitted[b as usize]);
                if a.is_looked_at || b.is_looked_at {
                    fitted[node] = union(a, b);
                } else {
                    fitted[node].is_looked_at = false;
                }
            }
        }
    }

    /// All pairs of triangles whose boxes meet, one of them at least looked at, that `accepts`: smaller number first, in order.
    pub fn pairs(&self, fitted: &[Fitted], accepts: impl Fn(u32, u32) -> bool + Sync) -> Vec<(u32, u32)> {
        let mut tasks: Vec<(u32, u32)> = if self.links.is_empty() { Vec::new() } else { vec![(0, 0)] };
        let mut pairs = Vec::new();
        while !tasks.is_empty() && tasks.len() < TASKS {
            let mut next = Vec::new();
            for task in tasks {
                self.open(fitted, task, &mut next, &mut |a, b| pairs.push((a, b)));
            }
            tasks = next;
        }
        pairs.retain(|&(a, b)| accepts(a, b));
        let found: Vec<Vec<(u32, u32)>> = tasks
            .into_par_iter()
            .map(|task| {
                let (mut stack, mut found) = (vec![task], Vec::new());
                while let Some(task) = stack.pop() {
                    self.open(fitted, task, &mut stack, &mut |a, b| {
                        if accepts(a, b) {
                            found.push((a, b));
                        }
                    });
                }
                found
            })
            .collect();
        pairs.extend(found.into_iter().flatten());
        pairs.sort_unstable();
        pairs
    }

    /// Goes one step down from a pair of nodes, or from one beside itself.
    fn open(&self, fitted: &[Fitted], (a, b): (u32, u32), next: &mut Vec<(u32, u32)>, found: &mut impl FnMut(u32, u32)) {
        let (at_a, at_b) = (&fitted[a as usize], &fitted[b as usize]);
        if !at_a.is_looked_at && !at_b.is_looked_at {
            return;
        }
        if a == b {
            if let Some([c, d]) = self.children(a) {
                next.extend([(c, c), (d, d), (c, d)]);
            }
            return;
        }
        if !meet(at_a, at_b) {
            return;
        }
        match (self.children(a), self.children(b)) {
            (None, None) => {
                let (a, b) = (self.links[a as usize] & !LEAF, self.links[b as usize] & !LEAF);
                found(a.min(b), a.max(b));
            }
            (Some([c, d]), None) => next.extend([(c, b), (d, b)]),
            (Some([c, d]), Some(_)) if size(at_a) >= size(at_b) => next.extend([(c, b), (d, b)]),
            (_, Some([c, d])) => next.extend([(a, c), (a, d)]),
        }
    }

    fn children(&self, node: u32) -> Option<[u32; 2]> {
        let link = self.links[node as usize];
        (link & LEAF == 0).then_some([link, link + 1])
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.links)
    }
}

fn around(corners: [DVec3; 3]) -> Fitted {
    let [a, b, c] = corners;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let below = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
    let above = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
    Fitted { low: low.to_array().map(below), high: high.to_array().map(above), is_looked_at: true }
}

fn union(a: &Fitted, b: &Fitted) -> Fitted {
    Fitted {
        low: std::array::from_fn(|i| a.low[i].min(b.low[i])),
        high: std::array::from_fn(|i| a.high[i].max(b.high[i])),
        is_looked_at: true,
    }
}

fn meet(a: &Fitted, b: &Fitted) -> bool {
    (0..3).all(|i| a.low[i] <= b.high[i] && b.low[i] <= a.high[i])
}

fn size(of: &Fitted) -> f32 {
    (0..3).map(|i| of.high[i] - of.low[i]).sum()
}
