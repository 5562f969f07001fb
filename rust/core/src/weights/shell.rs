//! The voxels of one shell of a surface.
//!
//! A voxel is inside where the generalised winding number of its centre is above one half in size. The winding number is
//! the signed number of crossings of a ray, averaged over rays: on a closed shell all rays agree, on an open one the rays
//! through its openings are outvoted. Six rays along the axes are enough, because they come from scanning the surface
//! once per axis. Counting signed crossings, not their parity, keeps shells solid that pass through themselves; taking
//! each shell on its own and the size only keeps inverted and overlapping shells solid.

use glam::DVec3;
use rayon::prelude::*;

use super::crossings::{Crossing, Crossings, Window, across};

/// Cells of all shells, and so solid voxels: each takes about a hundred bytes.
pub const MOST_CELLS: usize = 1 << 24;
/// Crossings of one shell: each takes forty bytes.
const MOST_CROSSINGS: f64 = 16e6;
/// Rays that vote.
const RAYS: i32 = 6;
/// A surface so near to the border of a cell lies on it.
const BORDER: f64 = 1e-6;
/// Slices per parallel piece.
const SLAB: usize = 16;

/// Cells of the lattice, sorted, that belong to a shell of triangles in voxels: those with their centre inside, and those
/// that the surface passes where the shell is too thin for that. None where there would be more than `MOST_CELLS`, or the
/// surface is folded up so much that lines cross it more often than `MOST_CROSSINGS`.
pub fn shell_cells(dims: [usize; 3], triangles: &[[DVec3; 3]]) -> Option<Vec<u32>> {
    let Some(window) = window_of(dims, triangles) else { return Some(Vec::new()) };
    if triangles.iter().map(crossings_about).sum::<f64>() > MOST_CROSSINGS {
        return None;
    }
    let lines: [Crossings; 3] = std::array::from_fn(|axis| Crossings::new(axis, &window, triangles));
    let inside = Bits::inside(&window, &lines);
    if inside.count() > MOST_CELLS {
        return None;
    }
    let mut cells: Vec<[usize; 3]> = inside.cells();
    cells.extend(thin_cells(&window, &lines, &inside));
    let index = |c: [usize; 3]| {
        let [x, y, z] = [0, 1, 2].map(|i| c[i] + window.low[i]);
        ((z * dims[1] + y) * dims[0] + x) as u32
    };
    let mut cells: Vec<u32> = cells.into_iter().map(index).collect();
    cells.sort_unstable();
    cells.dedup();
    Some(cells)
}

/// About how many lines through voxel centres, along all axes, cross a triangle, and how many rows of them are looked at.
fn crossings_about(corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = *corners;
    let sides = a.max(b).max(c) - a.min(b).min(c);
    0.5 * (b - a).cross(c - a).abs().element_sum() + sides.element_sum()
}

/// The voxels that a shell may touch; None when it lies beside the lattice.
fn window_of(dims: [usize; 3], triangles: &[[DVec3; 3]]) -> Option<Window> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &p in triangles.as_flattened() {
        low = low.min(p);
        high = high.max(p);
    }
    let first = (low.floor() - 1.0).max(DVec3::ZERO);
    let last = (high.floor() + 2.0).min(DVec3::from_array(dims.map(|d| d as f64)));
    let is_empty = first.cmpge(last).any() || !first.is_finite() || !last.is_finite();
    (!is_empty).then(|| {
        let low = first.to_array().map(|x| x as usize);
        let end = last.to_array().map(|x| x as usize);
        Window { low, dims: [0, 1, 2].map(|i| end[i] - low[i]) }
    })
}

/// One bit per cell of a window, slice by slice.
struct Bits {
    dims: [usize; 3],
    words_per_slice: usize,
    words: Vec<u64>,
}

impl Bits {
    fn inside(window: &Window, lines: &[Crossings; 3]) -> Self {
        let dims = window.dims;
        let words_per_slice = (dims[0] * dims[1]).div_ceil(64);
        let mut words = vec![0u64; words_per_slice * dims[2]];
        words.par_chunks_mut(words_per_slice * SLAB).enumerate().for_each(|(slab, words)| {
            let mut votes = vec![0i32; dims[0] * dims[1]];
            for (slice, words) in words.chunks_mut(words_per_slice).enumerate() {
                vote(window, lines, slab * SLAB + slice, &mut votes);
                for (cell, _) in votes.iter().enumerate().filter(|(_, votes)| 2 * votes.abs() > RAYS) {
                    words[cell / 64] |= 1 << (cell % 64);
                }
            }
        });
        Self { dims, words_per_slice, words }
    }

    fn has(&self, [x, y, z]: [usize; 3]) -> bool {
        let cell = y * self.dims[0] + x;
        self.words[z * self.words_per_slice + cell / 64] >> (cell % 64) & 1 == 1
    }

    fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    fn cells(&self) -> Vec<[usize; 3]> {
        let mut cells = Vec::new();
        for (index, &word) in self.words.iter().enumerate() {
            let mut left = word;
            while left != 0 {
                let cell = index % self.words_per_slice * 64 + left.trailing_zeros() as usize;
                cells.push([cell % self.dims[0], cell / self.dims[0], index / self.words_per_slice]);
                left &= left - 1;
            }
        }
        cells
    }
}

/// Sum of six winding numbers per cell of one slice.
fn vote(window: &Window, lines: &[Crossings; 3], slice: usize, votes: &mut [i32]) {
    let [width, height, _] = window.dims;
    for y in 0..height {
        let line = lines[0].line(y, slice);
        if line.is_empty() {
            votes[y * width..(y + 1) * width].fill(0);
        } else {
            let mut walk = Walk::new(line);
            for x in 0..width {
                votes[y * width + x] = walk.to(window.low[0] + x);
            }
        }
    }
    for x in 0..width {
        let line = lines[1].line(slice, x);
        if !line.is_empty() {
            let mut walk = Walk::new(line);
            for y in 0..height {
                votes[y * width + x] += walk.to(window.low[1] + y);
            }
        }
    }
    for y in 0..height {
        for x in 0..width {
            let line = lines[2].line(x, y);
            if !line.is_empty() {
                votes[y * width + x] += Walk::new(line).to(window.low[2] + slice);
            }
        }
    }
}

/// The two rays along a line, from one centre to the next.
struct Walk<'a> {
    ahead: std::slice::Iter<'a, Crossing>,
    sum: i32,
}

impl<'a> Walk<'a> {
    fn new(line: &'a [Crossing]) -> Self {
        Self { ahead: line.iter(), sum: line.iter().map(|c| i32::from(c.sign)).sum() }
    }

    /// Winding number of the centre of `cell` by the ray forwards plus that by the ray backwards.
    fn to(&mut self, cell: usize) -> i32 {
        let centre = cell as f64 + 0.5;
        while let Some(crossing) = self.ahead.as_slice().first().filter(|c| c.depth < centre) {
            self.sum -= 2 * i32::from(crossing.sign);
            self.ahead.next();
        }
        self.sum
    }
}

/// Cells that a line crosses the surface in, where no voxel near is inside; and those next to them, to join what is thin
/// to what is not. Thick parts get none: surfaces two voxels apart stay apart.
fn thin_cells(window: &Window, lines: &[Crossings; 3], inside: &Bits) -> Vec<[usize; 3]> {
    let mut crossed: Vec<[usize; 3]> = Vec::new();
    for (axis, lines) in lines.iter().enumerate() {
        let [u, v] = across(axis);
        for (cell, depth) in lines.cells() {
            // A surface between two cells is of both: the mirror image of either would be the other.
            for depth in [depth - BORDER, depth + BORDER] {
                let along = depth.floor() - window.low[axis] as f64;
                if along >= 0.0 && along < window.dims[axis] as f64 {
                    let mut at = [0; 3];
                    at[u] = cell[0];
                    at[v] = cell[1];
                    at[axis] = along as usize;
                    crossed.push(at);
                }
            }
        }
    }
    crossed.sort_unstable();
    crossed.dedup();
    let around = |c: [usize; 3]| {
        let ranges = [0, 1, 2].map(|i| c[i].saturating_sub(1)..(c[i] + 2).min(window.dims[i]));
        let [xs, ys, zs] = ranges;
        xs.flat_map(move |x| {
            let zs = zs.clone();
            ys.clone().flat_map(move |y| zs.clone().map(move |z| [x, y, z]))
        })
    };
    let thin: Vec<[usize; 3]> = crossed.iter().copied().filter(|&c| !around(c).any(|n| inside.has(n))).collect();
    if thin.is_empty() {
        return thin;
    }
    crossed.into_iter().filter(|&c| around(c).any(|n| thin.binary_search(&n).is_ok())).collect()
}
